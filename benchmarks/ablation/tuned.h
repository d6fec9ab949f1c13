// Constants that the environment can change, in builds with LIBATLAS_TUNING only: instrument.py
// puts them into the sources in place of `constexpr`.
#pragma once

#include <cmath>
#include <cstdlib>
#include <map>
#include <string>
#include <type_traits>

namespace atlas {

// How LIBATLAS_TUNED changes a constant: "name=value" replaces it, "name*factor" multiplies it.
// Several are separated by semicolons.
struct TunedChange {
  bool replaces = false;
  double number = 1;
};

inline const std::map<std::string, TunedChange>& tuned_changes() {
  static const std::map<std::string, TunedChange> changes = [] {
    std::map<std::string, TunedChange> result;
    const char* asked = std::getenv("LIBATLAS_TUNED");
    std::string text = asked ? asked : "";
    for (std::size_t begin = 0; begin < text.size();) {
      std::size_t end = text.find(';', begin);
      if (end == std::string::npos) end = text.size();
      const std::size_t sign = text.find_first_of("=*", begin);
      if (sign < end)
        result[text.substr(begin, sign - begin)] = {text[sign] == '=',
                                                    std::atof(text.c_str() + sign + 1)};
      begin = end + 1;
    }
    return result;
  }();
  return changes;
}

// Returns `plain`, or what the environment makes of it. Whole numbers are rounded; those above zero
// stay above it.
template <class T>
T tuned(const char* name, T plain) {
  const auto found = tuned_changes().find(name);
  if (found == tuned_changes().end()) return plain;
  const TunedChange& change = found->second;
  const double value = change.replaces ? change.number : double(plain) * change.number;
  if constexpr (std::is_floating_point_v<T> || std::is_same_v<T, bool>) return T(value);
  const double whole = std::round(value);
  return T(!change.replaces && plain > T(0) && whole < 1 ? 1 : whole);
}

// A number within the braces of a constant of several.
class TunedNumber {
 public:
  template <class T>
  TunedNumber(const char* name, T plain) : value_(double(tuned<T>(name, plain))) {}
  template <class T>
  operator T() const {
    return T(value_);
  }

 private:
  double value_;
};

}  // namespace atlas
