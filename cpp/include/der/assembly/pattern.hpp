#pragma once

#include <vector>

#include "der/core/types.hpp"
#include "der/model/model.hpp"

namespace der {

/// Rows of a matrix that reach back far beyond its band: those of the last degrees of freedom of a
/// ring, which are coupled with its first ones, too.
struct Border {
  Index first_column = 0;  ///< of the ring
  Index first_row = 0;     ///< of the border; the columns of the ring before it have its rows
  Index end = 0;           ///< of the border and the ring

  [[nodiscard]] Index rows() const { return end - first_row; }
  [[nodiscard]] Index columns() const { return first_row - first_column; }
};

/// The nonzero positions of the lower triangle of the system matrix over the free degrees of
/// freedom, in compressed columns with ascending rows. Built once from the element lists; the
/// diagonal is always present.
struct Pattern {
  Index size = 0;
  Index half_bandwidth = 0;     ///< largest row - column but for the rows of borders
  std::vector<Border> borders;  ///< in ascending order, one for each ring that needs it
  std::vector<Index> outer;     ///< size + 1 column starts
  std::vector<Index> inner;     ///< row of each nonzero

  [[nodiscard]] Index nonzeros() const { return static_cast<Index>(inner.size()); }
};
Pattern build_pattern(const Model& model);
/// The pattern of the mass matrix alone.
Pattern build_mass_pattern(const Model& model);

/// Where the entry (row, column), row >= column, of the lower triangle lies in a solver's array of
/// values. Compressed columns and the columns of a band, from one end or from both or with borders,
/// serve all solvers.
class MatrixLayout {
 public:
  static MatrixLayout compressed(const Pattern& pattern);
  /// Column j holds rows j .. j + half_bandwidth.
  static MatrixLayout band(Index size, Index half_bandwidth);
  /// The same in two lanes, the values of which alternate: columns from the start in the first,
  /// columns of the reversed matrix, which begins at the end, in the second, as far as a middle of
  /// `half_bandwidth` rows. That is the rest of the first; the second has room for it. Where the
  /// number of other rows is odd, the second begins with a column that stays empty.
  static MatrixLayout two_ended(Index size, Index half_bandwidth);
  /// The band, then the rows of each border, column by column: `border_stride(border)` values each.
  static MatrixLayout bordered_band(const Pattern& pattern);
  /// Number of rows of a border, filled up to a multiple of 4 that suits the processor.
  static Index border_stride(const Border& border) { return (border.rows() + 3) / 4 * 4; }

  [[nodiscard]] Index slot(Index row, Index column) const;
  /// The slot of an entry given by its two indices in either order. A negative index is a held
  /// degree of freedom; its slot is `num_values()`, which no solver reads.
  [[nodiscard]] Index slot_or_spare(Index i, Index j) const;
  [[nodiscard]] Index num_values() const { return num_values_; }
  /// Whether every entry of one pattern, which both are for, lies in the same slot.
  [[nodiscard]] bool same_slots(const MatrixLayout& other) const {
    return pattern_ == other.pattern_ && width_ == other.width_ && half_ == other.half_ &&
           num_values_ == other.num_values_;
  }

 private:
  MatrixLayout() = default;
  const Pattern* pattern_ = nullptr;  // null: a band
  Index size_ = 0;
  Index width_ = 0;
  Index half_ = -1;  // columns of a lane but for the middle; -1: one lane
  Index num_values_ = 0;
  std::vector<Border> borders_;
};

}  // namespace der
