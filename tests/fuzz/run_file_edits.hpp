#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "der/model/state.hpp"

/// What an input says about a run file: a base run, and edits of it. So that fuzzing gets past the
/// checksums of HDF5 and of der, a run file is not guessed byte by byte but written with edited
/// values, by der, and edited, by HDF5.
namespace der::fuzz {

/// Twelve bytes of an input.
struct Edit {
  std::uint8_t what;    ///< the kind of edit
  std::uint8_t object;  ///< number of a dataset, group or field
  std::uint8_t part;    ///< number of an attribute, entry or other object
  std::uint8_t kind;    ///< of a type, an extent or a layout
  std::uint64_t value;
};

struct Edits {
  std::size_t base = 0;       ///< number of the base run
  std::size_t successor = 0;  ///< number of the base whose scene goes on from the file
  std::vector<Edit> all;
};
/// Any bytes are edits; what does not fill an edit is left out.
Edits parse_edits(const std::uint8_t* data, std::size_t size);

/// True for an edit of numbers that der writes itself, with the right checksums.
bool is_of_state(const Edit& edit);
/// Changes one number of a state, appends a ramp, or lets the stepper remember something else.
void edit_state(State& state, const Edit& edit);
/// Makes the other edits of a file: first those of its objects, then those of its bytes.
void edit_file(const std::string& path, const std::vector<Edit>& edits);

}  // namespace der::fuzz
