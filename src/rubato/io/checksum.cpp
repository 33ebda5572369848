#include <rubato/io/checksum.hpp>

#include <array>

namespace rubato::io {
namespace {

using Table = std::array<std::uint64_t, 256>;

/// What each byte does to the remainder.
constexpr Table make_table() {
  constexpr std::uint64_t polynomial = 0xc96c5795d7870f42u;
  Table table{};
  for (std::uint64_t byte = 0; byte < table.size(); ++byte) {
    std::uint64_t remainder = byte;
    for (int bit = 0; bit < 8; ++bit) remainder = (remainder >> 1) ^ ((remainder & 1u) != 0 ? polynomial : 0u);
    table[byte] = remainder;
  }
  return table;
}

constexpr Table table = make_table();

}  // namespace

void Checksum::take(const void* bytes, std::size_t size) {
  const auto* const first = static_cast<const unsigned char*>(bytes);
  for (std::size_t i = 0; i < size; ++i) state_ = table[(state_ ^ first[i]) & 0xffu] ^ (state_ >> 8);
}

void Checksum::take(std::string_view text) {
  take(static_cast<std::uint64_t>(text.size()));
  take(text.data(), text.size());
}

}  // namespace rubato::io
