// Internal: the reason why a file could not be written, for messages.
#pragma once

#include <cerrno>
#include <cstring>
#include <string>

namespace atlas {

// Returns the system's text for `error` (an errno), with a remedy if there is not enough space.
inline std::string write_error(int error) {
  const bool room = error == ENOSPC || error == EDQUOT || error == EFBIG;
  return std::strerror(error) + std::string(room ? " (make room there, or write elsewhere)" : "");
}

}  // namespace atlas
