#include "libatlas/files/parse_number.h"

#include <algorithm>
#include <charconv>
#include <limits>
#include <string_view>
#include <system_error>

namespace atlas {
namespace {

// Returns whether a number out of the range of double is too small and not too large. The exponent
// alone does not tell: 0.001e2 is a tenth. What tells is the power of ten of the first digit that
// is not 0.
bool is_tiny(std::string_view digits) {
  const std::size_t e = std::min(digits.find_first_of("eE"), digits.size());
  const std::size_t point = std::min(digits.find('.'), e);
  const std::size_t first = digits.find_first_not_of("0.");
  double power = first < point ? double(point - first) - 1 : -double(first - point);
  if (e < digits.size()) {
    // An exponent of many digits becomes infinite here.
    double exponent = 0;
    const bool negative = digits[e + 1] == '-';
    for (const char c : digits.substr(e + 1))
      if (c >= '0' && c <= '9') exponent = exponent * 10 + (c - '0');
    power += negative ? -exponent : exponent;
  }
  return power < 0;
}

const char* after_digits(const char* at, const char* end) {
  while (at < end && *at >= '0' && *at <= '9') ++at;
  return at;
}

// Reads a value that is not finite as Microsoft's runtime wrote it until 2015: "-1.#IND00",
// "1.#QNAN", "1.#INF00e+000". Exporters of that time wrote it, for example for normals of length 0.
// Returns null if the text is something else.
const char* parse_special(const char* at, const char* end, double& value) {
  const bool signed_ = *at == '-' || *at == '+';
  const std::string_view text(at + signed_, std::size_t(end - at) - signed_);
  for (const std::string_view name : {"1.#INF", "1.#IND", "1.#QNAN", "1.#SNAN"}) {
    if (!text.starts_with(name)) continue;
    using Limits = std::numeric_limits<double>;
    value = name == "1.#INF" ? Limits::infinity() : Limits::quiet_NaN();
    if (*at == '-') value = -value;
    const char* stop = after_digits(text.data() + name.size(), end);
    if (stop + 2 < end && *stop == 'e' && (stop[1] == '+' || stop[1] == '-'))
      stop = after_digits(stop + 2, end);
    return stop;
  }
  return nullptr;
}

}  // namespace

const char* parse_number_slow(const char* at, const char* end, double& value) {
  if (const char* stop = at < end ? parse_special(at, end, value) : nullptr) return stop;
  const char* start = *at == '+' ? at + 1 : at;
  if (start > at && *start == '-') return nullptr;
  const auto [stop, error] = std::from_chars(start, end, value);
  if (error == std::errc::result_out_of_range) {
    // from_chars does not say whether the number is too small or too large.
    std::string_view digits(start, std::size_t(stop - start));
    if (digits.front() == '-') digits.remove_prefix(1);
    value = is_tiny(digits) ? 0 : std::numeric_limits<double>::infinity();
    if (*start == '-') value = -value;
  } else if (error != std::errc{}) {
    return nullptr;
  }
  return stop;
}

}  // namespace atlas
