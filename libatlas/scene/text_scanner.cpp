#include "libatlas/scene/text_scanner.h"

#include <charconv>
#include <system_error>

namespace atlas {

const char* parse_number_slow(const char* at, const char* end, double& value) {
  const char* start = *at == '+' ? at + 1 : at;
  if (start > at && *start == '-') return nullptr;
  const auto [stop, error] = std::from_chars(start, end, value);
  if (error == std::errc::result_out_of_range) {
    // Too small or too large: from_chars says only that it is one of them.
    std::string_view digits(start, std::size_t(stop - start));
    if (digits.front() == '-') digits.remove_prefix(1);
    const std::size_t e = digits.find_first_of("eE");
    const bool tiny =
        e != digits.npos ? digits[e + 1] == '-' : digits.find_first_not_of('0') == digits.find('.');
    value = tiny ? 0 : std::numeric_limits<double>::infinity();
    if (*start == '-') value = -value;
  } else if (error != std::errc{}) {
    return nullptr;
  }
  return stop;
}

}  // namespace atlas
