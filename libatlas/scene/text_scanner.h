// Internal: numbers and words out of lines of text, without allocation or locale.
#pragma once

#include <charconv>
#include <cstdint>
#include <limits>
#include <string_view>
#include <system_error>

namespace atlas {

// Walks over text that ends with a newline at or after `end`. A backslash before a line break joins
// the lines, as OBJ has it.
class TextScanner {
 public:
  TextScanner(const char* begin, const char* end) : at_(begin), end_(end) {}

  bool at_end() const { return at_ >= end_; }
  const char* position() const { return at_; }
  std::uint32_t line() const { return line_; }  // 0 for the first

  // Skips blanks and continued line ends. Afterwards the scanner is at a word or a line's end.
  void skip_blanks() {
    for (;;) {
      while (*at_ == ' ' || *at_ == '\t' || *at_ == '\r') ++at_;
      if (*at_ != '\\') return;
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

  // At the end of the line, where a comment counts as its end.
  bool at_line_end() {
    skip_blanks();
    return at_ >= end_ || *at_ == '\n' || *at_ == '#';
  }

  // Goes to the start of the next line; a comment is not continued by a backslash.
  void next_line() {
    if (at_ < end_ && *at_ == '#') return next_line_after_comment();
    while (at_ < end_) {
      const char c = *at_++;
      if (c != '\n') continue;
      ++line_;
      const char* before = at_ - 2;
      if (before >= begin_of_line_ && *before == '\r') --before;
      if (before < begin_of_line_ || *before != '\\') break;
    }
    begin_of_line_ = at_;
  }

  // The next word, empty at the end of the line.
  std::string_view word() {
    skip_blanks();
    const char* start = at_;
    while (at_ < end_ && !is_space(*at_) && !continues(at_)) ++at_;
    return {start, std::size_t(at_ - start)};
  }

  // The rest of the line without blanks at either end; a comment set off by a blank is cut.
  std::string_view rest() {
    skip_blanks();
    const char* start = at_;
    while (at_ < end_ && *at_ != '\n' && !(*at_ == '#' && at_ > start && is_space(at_[-1]))) ++at_;
    const char* stop = at_;
    while (stop > start && is_space(stop[-1])) --stop;
    return {start, std::size_t(stop - start)};
  }

  // Reads a decimal number, "nan" or "inf"; what is beyond double becomes infinite or 0. False
  // (and no move) where there is none.
  bool number(double& value) {
    skip_blanks();
    const char* start = at_;
    if (number_here(value) && at_blank()) return true;
    at_ = start;
    return false;
  }

  // Reads a decimal integer here, without skipping blanks; saturates.
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
  bool continues(const char* p) const {
    return *p == '\\' && p + 1 < end_ && (p[1] == '\n' || (p[1] == '\r' && p[2] == '\n'));
  }

  void next_line_after_comment() {
    while (at_ < end_) {
      if (*at_++ != '\n') continue;
      ++line_;
      break;
    }
    begin_of_line_ = at_;
  }

  // Up to 15 digits and a power of ten up to 22 are both exact doubles, so one multiplication or
  // division rounds correctly (Clinger 1990); the rest goes to the library.
  bool number_here(double& value) {
    const char* p = at_;
    const bool negative = *p == '-';
    if (*p == '-' || *p == '+') ++p;
    std::uint64_t mantissa = 0;
    int digits = 0, exponent = 0;
    for (; *p >= '0' && *p <= '9'; ++p, ++digits) mantissa = mantissa * 10 + (*p - '0');
    if (*p == '.') {
      const char* point = ++p;
      for (; *p >= '0' && *p <= '9'; ++p, ++digits) mantissa = mantissa * 10 + (*p - '0');
      exponent = -int(p - point);
    }
    if (digits == 0 || digits > 15 || *p == 'e' || *p == 'E' || exponent < -22) {
      return number_slow(value);
    }
    const double magnitude =
        exponent < 0 ? double(mantissa) / kPowers[-exponent] : double(mantissa);
    value = negative ? -magnitude : magnitude;
    at_ = p;
    return true;
  }

  bool number_slow(double& value) {
    const char* start = *at_ == '+' ? at_ + 1 : at_;
    if (start > at_ && *start == '-') return false;
    const auto [stop, error] = std::from_chars(start, end_, value);
    if (error == std::errc::result_out_of_range) {
      // Too small or too large: from_chars says only that it is one of them.
      std::string_view digits(start, std::size_t(stop - start));
      if (digits.front() == '-') digits.remove_prefix(1);
      const std::size_t e = digits.find_first_of("eE");
      const bool tiny = e != digits.npos ? digits[e + 1] == '-'
                                         : digits.find_first_not_of('0') == digits.find('.');
      value = tiny ? 0 : std::numeric_limits<double>::infinity();
      if (*start == '-') value = -value;
    } else if (error != std::errc{}) {
      return false;
    }
    at_ = stop;
    return true;
  }

  static constexpr double kPowers[] = {1e0,  1e1,  1e2,  1e3,  1e4,  1e5,  1e6,  1e7,
                                       1e8,  1e9,  1e10, 1e11, 1e12, 1e13, 1e14, 1e15,
                                       1e16, 1e17, 1e18, 1e19, 1e20, 1e21, 1e22};

  const char* at_;
  const char* end_;
  const char* begin_of_line_ = at_;
  std::uint32_t line_ = 0;
};

}  // namespace atlas
