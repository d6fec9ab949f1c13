// Internal: VrmlScanner, which reads the words, lists of numbers, fields and nodes of a VRML97
// file.
#pragma once

#include <cstddef>
#include <cstdint>
#include <glm/vec4.hpp>
#include <limits>
#include <map>
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
  std::ptrdiff_t line() const { return line_of(at_); }
  std::ptrdiff_t line_of(const char* place) const;
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
  // Reads `[ indices ]`. What is no index of a list becomes kNoIndex.
  std::vector<std::int32_t> indices();
  static constexpr double kScanned = 0.8;  // share of the time until faces are added
  static constexpr std::int32_t kNoIndex = std::numeric_limits<std::int32_t>::min();
  glm::dvec4 row(int width);
  // Reads an integer, which may be hexadecimal.
  double integer();

  // Calls field(name) for each field up to the closing bracket. If it returns false, the field's
  // value is skipped.
  template <class Field>
  void fields(const Field& field) {
    expect("{");
    for (std::string_view token = next(); token != "}"; token = next()) {
      if (token == "ROUTE") {
        skip_route();
        continue;
      }
      check_field(token);
      if (!field(token)) skip_value();
    }
  }
  // Calls each(first token) for each node or string of a field's value: one, or several in
  // brackets.
  template <class Each>
  void nodes(const Each& each) {
    std::string_view token = next();
    if (token != "[") return each(token);
    for (token = next(); token != "]"; token = next()) each(token);
  }
  // Reads the node that begins with `token`, or the one that `USE NAME` stands for: calls
  // read(type, name) before its opening bracket, where `name` is empty unless DEF gives one. Does
  // nothing for NULL.
  template <class Read>
  void read_node(std::string_view token, const Read& read) {
    if (token == "NULL") return;
    if (token != "USE") {
      std::string_view name;
      token = type_of(token, name);
      return read(token, name);
    }
    const std::string_view name = next();
    const Definition& definition = definition_of(name, token.data());
    if (uses_ == 0) count_repeated(definition.bytes);  // those of the USE within are part of it
    const char* after = at_;
    at_ = definition.place;
    ++uses_;
    read_node(next(), read);
    --uses_;
    at_ = after;
  }
  void skip_node(std::string_view token);
  // Skips `NODE.eventOut TO NODE.eventIn` after ROUTE.
  void skip_route();
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
  // Reads the same, or a hexadecimal integer.
  bool integer(double& value);
  // Reads `[ numbers ]` by `read`, one of the two above, and calls add(number) for each.
  template <class Add>
  void numbers(bool (VrmlScanner::*read)(double&), const Add& add) {
    expect("[");
    double value;
    for (std::size_t count = 1; (this->*read)(value); ++count) {
      add(value);
      if (count % 65536 == 0) tell();
    }
    end_numbers();
  }
  void end_numbers();
  // Reports how much of the text is read, unless a USE leads back in it. Throws if the work is
  // cancelled.
  void tell() const;
  // Returns the type of the node that begins with `token`, and the name that DEF gives it.
  std::string_view type_of(std::string_view token, std::string_view& name);
  struct Definition {
    const char* place;  // after DEF
    double bytes;       // of its node's text, with all that USE repeats within
  };
  // Returns the last DEF of the name before `use`.
  const Definition& definition_of(std::string_view name, const char* use);
  void find_definitions();
  void count_repeated(double bytes);

  const char *begin_, *at_, *end_;
  const Context& context_;
  std::string what_;
  // Where each name is defined, in the order of the file; filled by the first USE.
  std::map<std::string_view, std::vector<Definition>> definitions_;
  bool definitions_found_ = false;
  int uses_ = 0;         // how many USE are being followed, one within the other
  double repeated_ = 0;  // bytes that USE makes the scanner pass once more
};

}  // namespace atlas
