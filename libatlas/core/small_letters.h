// Names where capitals mean nothing.
#pragma once

#include <string>

namespace atlas {

// Whatever the locale: letters beyond a to z stay as they are.
inline char small_letter(char c) {
  return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
}
inline std::string small_letters(std::string text) {
  for (char& c : text) c = small_letter(c);
  return text;
}

}  // namespace atlas
