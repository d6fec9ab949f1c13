// Names where capitals mean nothing.
#pragma once

#include <string>

namespace atlas {

// Whatever the locale: letters beyond a to z stay as they are.
inline std::string small_letters(std::string text) {
  for (char& c : text) c = c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
  return text;
}

}  // namespace atlas
