#pragma once

#include <cstddef>
#include <cstdint>
#include <cstring>

namespace der {

/// Checksum of a row of 64-bit words: the sum modulo 2^64 of each, its upper half folded onto its
/// lower, times a power of an odd number. A word that changes changes the sum, always; more than
/// one do but by an accident of 1 in 2^32 or less. In numpy it is one line (docs/results.md).
/// HDF5's own checksums cover whole chunks, which would have to be rewritten with every frame: a
/// process killed meanwhile would lose the frames before it too.
class Checksum {
 public:
  void add(std::uint64_t word) {
    sum_ += (word ^ (word >> 32U)) * factor_;
    factor_ *= kBase;
  }
  void add(std::int64_t number) { add(static_cast<std::uint64_t>(number)); }
  void add(double number) {
    std::uint64_t word = 0;
    std::memcpy(&word, &number, sizeof word);
    add(word);
  }
  template <class T>
  void add(const T* numbers, std::size_t count) {
    for (std::size_t i = 0; i < count; ++i) add(numbers[i]);
  }
  /// Bytes as words, the last one filled up with zeros.
  void add_bytes(const void* data, std::size_t size) {
    const auto* bytes = static_cast<const unsigned char*>(data);
    for (std::size_t i = 0; i < size; i += sizeof(std::uint64_t)) {
      std::uint64_t word = 0;
      std::memcpy(&word, bytes + i, size - i < sizeof word ? size - i : sizeof word);
      add(word);
    }
  }
  [[nodiscard]] std::uint64_t value() const { return sum_; }

 private:
  static constexpr std::uint64_t kBase = 0x9E3779B97F4A7C15U;
  std::uint64_t factor_ = kBase;
  std::uint64_t sum_ = 0;
};

}  // namespace der
