// Writes integers as image files hold them.
#pragma once

#include <cstdint>
#include <string>

namespace atlas::test {

inline std::string big(std::uint32_t value, int count) {
  std::string s;
  for (int i = count - 1; i >= 0; --i) s += char(value >> (8 * i) & 255);
  return s;
}

inline std::string little(std::uint32_t value, int count) {
  const std::string s = big(value, count);
  return {s.rbegin(), s.rend()};
}

}  // namespace atlas::test
