#pragma once

#include <cstddef>
#include <cstdint>
#include <string_view>

namespace rubato::io {

/// The cyclic redundancy check of 64 bits that XZ uses (CRC-64/XZ: the polynomial of ECMA-182, bits reversed, all ones
/// before and after). It differs for any two texts of one length that differ within 64 neighbouring bits, and by chance
/// is the same for others once in 2^64. Zeros are no exception: the check of a text of zeros is not zero.
class Checksum {
 public:
  void take(const void* bytes, std::size_t size);
  /// A text with its length, so that two texts in a row are not the same as one.
  void take(std::string_view text);
  void take(std::uint64_t number) { take(&number, sizeof number); }
  void take(double number) { take(&number, sizeof number); }
  std::uint64_t value() const { return ~state_; }

 private:
  std::uint64_t state_ = ~std::uint64_t{0};
};

}  // namespace rubato::io
