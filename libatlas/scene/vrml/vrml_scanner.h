// Internal: VrmlScanner, which reads the words, lists of numbers, fields and nodes of a VRML97
// file.
#pragma once

#include <cstddef>
#include <cstdint>
#include <glm/vec4.hpp>
#include <limits>
#include <map>
#include <set>
#include <string>
#include <string_view>
#include <unordered_map>
#include <vector>

#include "libatlas/core/context.h"

namespace atlas {

// All methods below throw this if the file is malformed or the work is cancelled. The scanner then
// says what was wrong and on which line.
class MalformedVrml {};

class VrmlScanner {
 public:
  // `text` must end with a newline, which is not scanned. USE may repeat at most `most` bytes of
  // it.
  VrmlScanner(const std::string& text, double most, const Context& context)
      : begin_(text.data()),
        at_(text.data()),
        end_(text.data() + text.size() - 1),
        most_repeated_(most),
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

  // Reads `[ numbers ]`, whose count must be a multiple of `width`, or one row without brackets.
  std::vector<double> list(std::size_t width);
  // Reads `[ indices ]`, or one without brackets. What is no index of a list becomes kNoIndex.
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
      if (skip_prototype(token)) continue;
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
    for (token = next(); token != "]"; token = next()) {
      if (token.empty()) fail("the file ends inside a list");
      if (!skip_prototype(token)) each(token);
    }
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
    if (counting_) return count_repeated(definition.bytes);
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
  // If `token` is PROTO or EXTERNPROTO, skips what it declares, notes the name and returns true.
  bool skip_prototype(std::string_view token);
  // The names of the PROTO and EXTERNPROTO so far, as types of nodes.
  const std::set<std::string_view>& prototypes() const { return prototypes_; }
  // Until `counting` is false again, read_node() does not follow USE, but counts how much of the
  // text they repeat, and throws if that is more than may be.
  void set_counting(bool counting) { counting_ = counting; }
  bool counting() const { return counting_; }
  bool repeats_too_much() const { return repeated_ > most_repeated_; }
  // Counts all USE from before an opening bracket to after its closing bracket.
  void count_uses();
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
  // Reads `[ numbers ]` by `read`, one of the two above, and calls add(number) for each. A value of
  // `width` numbers may do without the brackets.
  template <class Add>
  void numbers(bool (VrmlScanner::*read)(double&), std::size_t width, const Add& add) {
    double value;
    if (peek() != "[") {
      for (std::size_t i = 0; i < width; ++i) {
        if (!(this->*read)(value)) not_a_number();
        add(value);
      }
      return;
    }
    expect("[");
    for (std::size_t count = 1; (this->*read)(value); ++count) {
      add(value);
      if (count % 65536 == 0) tell();
    }
    end_numbers();
  }
  void end_numbers();
  [[noreturn]] void not_a_number();
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
  const double most_repeated_;
  const Context& context_;
  std::string what_;
  // Where each name is defined, in the order of the file; filled by the first USE.
  std::map<std::string_view, std::vector<Definition>> definitions_;
  bool definitions_found_ = false;
  std::set<std::string_view> prototypes_;
  int uses_ = 0;         // how many USE are being followed, one within the other
  double repeated_ = 0;  // bytes that USE repeats, as far as they are counted
  bool counting_ = false;
  // Where long pairs of brackets end, by what is after the opening one. Groups are passed over
  // before their children are read, so that brackets within brackets would be passed again and
  // again.
  std::unordered_map<const char*, const char*> ends_;
};

}  // namespace atlas
