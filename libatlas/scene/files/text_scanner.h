// Internal: TextScanner, which reads numbers and words from lines of text, without allocation or
// locale.
#pragma once

#include <cstdint>
#include <limits>
#include <string_view>

#include "libatlas/files/parse_number.h"

namespace atlas {

// Scans text that has a newline at or after `end`. With Lines::joined, a backslash before a line
// break joins the lines, as in OBJ. With never_joined it is an ordinary character.
class TextScanner {
 public:
  enum class Lines { joined, never_joined };

  TextScanner(const char* begin, const char* end, Lines lines = Lines::joined)
      : at_(begin), end_(end), joins_(lines == Lines::joined) {}

  bool at_end() const { return at_ >= end_; }
  const char* position() const { return at_; }
  std::uint32_t line() const { return line_; }  // 0 for the first

  // Skips blanks and continued line ends. Afterwards the scanner is at a word or at a line's end.
  void skip_blanks() {
    for (;;) {
      while (*at_ == ' ' || *at_ == '\t' || *at_ == '\r') ++at_;
      if (!joins_ || *at_ != '\\') return;
      const char* next = at_ + 1;
      if (next < end_ && *next == '\r') ++next;
      if (next >= end_ || *next != '\n') return;
      at_ = next + 1;
      ++line_;
      if (at_ >= end_) {  // a continuation with nothing after it ends the line
        at_ = end_;
        return;
      }
    }
  }

  // Skips blanks. Returns whether the scanner is then at the end of the line; a comment counts as
  // its end.
  bool at_line_end() {
    skip_blanks();
    return at_ >= end_ || *at_ == '\n' || *at_ == '#';
  }

  // Goes to the start of the next line; a comment is not continued by a backslash.
  void next_line() {
    bool comment = at_ < end_ && *at_ == '#';
    while (at_ < end_) {
      const char c = *at_++;
      comment |= c == '#' && at_ - 1 > begin_of_line_ && is_space(at_[-2]);
      if (c != '\n') continue;
      ++line_;
      if (!joins_ || comment) break;
      const char* before = at_ - 2;
      if (before >= begin_of_line_ && *before == '\r') --before;
      if (before < begin_of_line_ || *before != '\\') break;
    }
    begin_of_line_ = at_;
  }

  // Returns the next word, which is empty at the end of the line.
  std::string_view word() {
    skip_blanks();
    const char* start = at_;
    while (at_ < end_ && !is_space(*at_) && !continues(at_)) ++at_;
    return {start, std::size_t(at_ - start)};
  }

  // Returns the rest of the line without blanks at either end, and without a comment after a blank.
  // Stays before it.
  std::string_view rest() { return without_comment(rest_with_comment()); }

  // Returns the same, but with text after " #", which may be a comment or part of a file's name.
  std::string_view rest_with_comment() {
    skip_blanks();
    const char* stop = at_;
    while (stop < end_ && *stop != '\n') ++stop;
    return {at_, std::size_t(trimmed(at_, stop) - at_)};
  }

  // Returns the text before the first '#' that follows a blank.
  static std::string_view without_comment(std::string_view line) {
    for (std::size_t i = 1; i < line.size(); ++i)
      if (line[i] == '#' && is_space(line[i - 1]))
        return {line.data(), std::size_t(trimmed(line.data(), line.data() + i) - line.data())};
    return line;
  }

  // Reads a number that is followed by a blank, a comment or the end of the line. Returns false,
  // and stays before the word, if there is none.
  bool number(double& value) {
    skip_blanks();
    const char* start = at_;
    const char* stop = parse_number(at_, end_, value);
    at_ = stop ? stop : at_;
    if (stop && at_blank()) return true;
    at_ = start;
    return false;
  }

  // Reads a decimal integer at the current position without skipping blanks. Ignores further digits
  // of huge numbers, which stay huge.
  bool integer_here(std::int64_t& value) {
    const char* p = at_;
    const bool negative = *p == '-';
    if (*p == '-' || *p == '+') ++p;
    if (*p < '0' || *p > '9') return false;
    std::int64_t v = 0;
    for (; *p >= '0' && *p <= '9'; ++p) {
      if (v < std::numeric_limits<std::int64_t>::max() / 16) v = v * 10 + (*p - '0');
    }
    value = negative ? -v : v;
    at_ = p;
    return true;
  }

  bool take(char c) {
    if (at_ >= end_ || *at_ != c) return false;
    ++at_;
    return true;
  }
  bool at_blank() const { return at_ >= end_ || is_space(*at_) || *at_ == '#' || *at_ == '\\'; }

 private:
  static bool is_space(char c) { return c == ' ' || c == '\t' || c == '\r' || c == '\n'; }
  static const char* trimmed(const char* start, const char* stop) {
    while (stop > start && is_space(stop[-1])) --stop;
    return stop;
  }
  bool continues(const char* p) const {
    return joins_ && *p == '\\' && p + 1 < end_ && (p[1] == '\n' || (p[1] == '\r' && p[2] == '\n'));
  }

  const char* at_;
  const char* end_;
  const char* begin_of_line_ = at_;
  std::uint32_t line_ = 0;
  bool joins_;
};

}  // namespace atlas
