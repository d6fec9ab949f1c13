// Internal: TextBuffer, which formats numbers for text files.
#pragma once

#include <cassert>
#include <charconv>
#include <cstddef>
#include <string>
#include <string_view>
#include <system_error>

#include "libatlas/core/vec.h"

namespace atlas {

// Appends numbers independent of the locale. Values must be finite.
class TextBuffer {
 public:
  void text(std::string_view s) { bytes_.append(s); }
  void character(char c) { bytes_.push_back(c); }
  template <class T>
  void number(T value) {
    if (value == 0) value = 0;  // -0 and 0 are equal and must print alike
    char digits[40];
    const auto [stop, error] = std::to_chars(digits, digits + sizeof digits, value);
    assert(error == std::errc{});
    bytes_.append(digits, stop);
  }
  // Appends a coordinate of the file, origin + offset. If the origin is 0, that is the float
  // itself.
  void coordinate(double origin, float offset) {
    origin == 0 ? number(offset) : number(origin + static_cast<double>(offset));
  }
  void position(const Vec3d& origin, const Vec3f& p) {
    coordinate(origin.x, p.x);
    character(' ');
    coordinate(origin.y, p.y);
    character(' ');
    coordinate(origin.z, p.z);
  }
  void uv(const Vec2f& uv) {
    number(uv.x);
    character(' ');
    number(uv.y);
  }
  void reserve(std::size_t bytes) { bytes_.reserve(bytes); }
  const std::string& bytes() const { return bytes_; }

 private:
  std::string bytes_;
};

}  // namespace atlas
