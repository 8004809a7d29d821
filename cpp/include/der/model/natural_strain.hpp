#pragma once

#include <vector>

#include "der/core/types.hpp"

namespace der {

/// How the entries of the controls that shift the rest shape of elements follow from the tables of
/// the actuations: each is a sum of tables with weights. They stand behind the frames and before
/// the tables.
class NaturalStrain {
 public:
  /// `weight` times a control, added to an entry.
  struct Term {
    Index entry = 0;
    Index control = 0;
    double weight = 0.0;
  };

  NaturalStrain() = default;
  /// `first`: number of entries before these; `size`: how many there are.
  NaturalStrain(Index first, Index size) : first_(first), size_(size) {}

  [[nodiscard]] Index end() const { return first_ + size_; }
  /// Whether any actuation acts.
  [[nodiscard]] bool is_actuated() const { return size_ > 0; }
  /// Adds terms, in any order.
  void add(const std::vector<Term>& terms);
  /// Those of one entry.
  [[nodiscard]] std::vector<Term> terms_of(Index entry) const;
  /// Sets the entries by the tables.
  void enter(Vector& controls) const;
  /// Replaces the entries by those of other controls.
  void copy(const Vector& from, Vector& to) const {
    to.segment(first_, size_) = from.segment(first_, size_);
  }

 private:
  Index first_ = 0;
  Index size_ = 0;
  std::vector<Term> terms_;  // in the order of the entries
};

}  // namespace der
