#pragma once

#include <bit>
#include <concepts>
#include <cstddef>
#include <string>

/// Numbers of one to eight bytes in a stated byte order, whatever the machine's own.
namespace moduli {

/// The number whose bytes begin at `bytes`; at least sizeof(Unsigned) bytes must be there.
template <std::unsigned_integral Unsigned>
Unsigned loadNumber(const char* bytes, std::endian order) {
  Unsigned value = 0;
  for (std::size_t i = 0; i < sizeof(Unsigned); ++i) {
    const std::size_t place = order == std::endian::big ? sizeof(Unsigned) - 1 - i : i;
    value |= static_cast<Unsigned>(Unsigned{static_cast<unsigned char>(bytes[i])} << (8 * place));
  }
  return value;
}

/// Appends the bytes of a number, lowest first.
template <std::unsigned_integral Unsigned>
void appendLittleEndian(std::string& bytes, Unsigned value) {
  for (std::size_t i = 0; i < sizeof(Unsigned); ++i) {
    bytes += static_cast<char>(value >> (8 * i) & 0xFFU);
  }
}

}  // namespace moduli
