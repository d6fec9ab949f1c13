// Internal: decodes file names in URIs.
#pragma once

#include <charconv>
#include <cstddef>
#include <string>

namespace atlas {

// Returns the name with each percent sign and the two hexadecimal digits after it replaced by the
// byte that they stand for.
inline std::string decode_uri(const std::string& uri) {
  std::string name;
  for (std::size_t i = 0; i < uri.size(); ++i) {
    unsigned code = 0;  // a sign is no digit
    if (uri[i] == '%' && i + 2 < uri.size() &&
        std::from_chars(&uri[i + 1], &uri[i + 1] + 2, code, 16).ptr == &uri[i + 1] + 2) {
      name += static_cast<char>(code);
      i += 2;
    } else {
      name += uri[i];
    }
  }
  return name;
}

}  // namespace atlas
