// Internal: VrmlScanner, which reads the words, lists of numbers and fields of a VRML97 file.
#pragma once

#include <cstddef>
#include <glm/vec4.hpp>
#include <string>
#include <string_view>
#include <vector>

#include "libatlas/core/context.h"

namespace atlas {

// All methods below throw this if the file is malformed or the work is cancelled. The scanner then
// says what was wrong and on which line.
class MalformedVrml {};

class VrmlScanner {
 public:
  // `text` must end with a newline, which is not scanned.
  VrmlScanner(const std::string& text, const Context& context)
      : begin_(text.data()),
        at_(text.data()),
        end_(text.data() + text.size() - 1),
        context_(context) {}

  std::string_view text() const { return {begin_, std::size_t(end_ - begin_)}; }
  std::ptrdiff_t line() const;
  const std::string& what() const { return what_; }
  [[noreturn]] void fail(std::string what);

  // Returns a bracket, a string with its quotes, or a word; empty at the end of the file.
  std::string_view next();
  std::string_view peek();
  void expect(std::string_view token);
  // The beginning of a token, for messages: at most 40 bytes of its first line.
  static std::string_view start_of(std::string_view token);

  // Reads `[ numbers ]`, whose count must be a multiple of `width`.
  std::vector<double> list(std::size_t width);
  glm::dvec4 row(int width);

  // Calls field(name) for each field up to the closing bracket. If it returns false, the field's
  // value is skipped.
  template <class Field>
  void fields(const Field& field) {
    expect("{");
    for (std::string_view token = next(); token != "}"; token = next()) {
      check_field(token);
      if (!field(token)) skip_value();
    }
  }
  // Skips from after an opening bracket to after its closing bracket.
  void skip_brackets();

  // Returns the current position, for go_to().
  const char* place() const { return at_; }
  void go_to(const char* place) { at_ = place; }

 private:
  static bool breaks(char c);
  static bool is_field(std::string_view token);
  void skip_blanks();
  void check_field(std::string_view token);
  void skip_value();
  bool number(double& value);

  const char *begin_, *at_, *end_;
  const Context& context_;
  std::string what_;
};

}  // namespace atlas
