// Conversion to lower case, for names whose case does not matter.
#pragma once

#include <string>

namespace atlas {

// Both change only A to Z, independent of the locale.
inline char small_letter(char c) {
  return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
}
inline std::string small_letters(std::string text) {
  for (char& c : text) c = small_letter(c);
  return text;
}

}  // namespace atlas
