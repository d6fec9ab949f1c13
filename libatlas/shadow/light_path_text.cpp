// The text form of light paths, for command lines.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <string_view>

#include "libatlas/files/parse_number.h"
#include "libatlas/shadow/light_path.h"

namespace atlas {
namespace {

Status malformed(const std::string& text, std::string_view why) {
  return {ErrorCode::bad_option,
          fmt::format("light path '{}': {} (examples: sun:172,50.45,9  fixed:1,2,1  "
                      "arc:1,1,0;-1,1,0)",
                      text, why)};
}

// Appends the numbers of a comma-separated list, which may have blanks before each of them, to
// `out`. Returns false if the text contains anything else.
bool numbers(std::string_view text, std::vector<double>& out) {
  const std::string copy(text);  // ends with 0, which is no digit
  const char *p = copy.data(), *const end = p + copy.size();
  while (true) {
    while (*p == ' ') ++p;
    p = parse_number(p, end, out.emplace_back());
    if (p == nullptr) return false;
    if (p == end) return true;
    if (*p++ != ',') return false;
  }
}

}  // namespace

Result<LightPathOptions> parse_light_path(const std::string& text, LightPathOptions options) {
  const std::size_t colon = text.find(':');
  const std::string kind = text.substr(0, colon);
  const std::string_view rest =
      colon == std::string::npos ? std::string_view() : std::string_view(text).substr(colon + 1);
  if (kind == "sun") {
    options.kind = PathKind::sun;
    std::vector<double> v;
    if (rest.empty()) return options;
    if (!numbers(rest, v) || v.size() != 3)
      return malformed(text, "the sun takes day of the year, latitude, hour");
    if (!(v[0] >= 1 && v[0] <= 366) || v[0] != std::floor(v[0]))
      return malformed(text, "the day is not a whole number in 1..366");
    options.sun.day_of_year = int(v[0]);
    options.sun.latitude = v[1];
    options.sun.start_hour = v[2];
    return options;
  }
  if (kind == "fixed")
    options.kind = PathKind::fixed;
  else if (kind == "line")
    options.kind = PathKind::line;
  else if (kind == "arc")
    options.kind = PathKind::arc;
  else if (kind == "keys")
    options.kind = PathKind::keys;
  else
    return malformed(text, "the kinds are fixed, line, arc, sun, keys");
  options.directions.clear();
  for (std::size_t at = 0; at <= rest.size();) {
    const std::size_t stop = std::min(rest.find(';', at), rest.size());
    std::vector<double> v;
    if (!numbers(rest.substr(at, stop - at), v) || v.size() != 3)
      return malformed(text, "a direction is three numbers x,y,z");
    options.directions.push_back({v[0], v[1], v[2]});
    at = stop + 1;
  }
  return options;
}

}  // namespace atlas
