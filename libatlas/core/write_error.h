// Internal: why a file could not be written, for messages.
#pragma once

#include <cerrno>
#include <cstring>
#include <string>

namespace atlas {

// What the system calls the error (an errno), and the remedy where it is want of room.
inline std::string write_error(int error) {
  const bool room = error == ENOSPC || error == EDQUOT || error == EFBIG;
  return std::strerror(error) + std::string(room ? " (make room there, or write elsewhere)" : "");
}

}  // namespace atlas
