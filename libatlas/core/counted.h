// Internal: numbers of things in messages.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

namespace atlas {

// Returns "1 page", "2 pages" or "0 pages" for the noun "page".
inline std::string counted(std::uint64_t n, std::string_view noun) {
  return (std::to_string(n) + ' ').append(noun) + (n == 1 ? "" : "s");
}

}  // namespace atlas
