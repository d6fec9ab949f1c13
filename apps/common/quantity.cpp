#include "apps/common/quantity.h"

#include <array>
#include <charconv>
#include <cmath>
#include <string_view>
#include <utility>

#include "libatlas/core/small_letters.h"

namespace atlas::app {
namespace {

using Units = std::array<std::pair<std::string_view, double>, 6>;

constexpr Units kLengths{
    {{"mm", 1e-3}, {"cm", 1e-2}, {"in", 0.0254}, {"ft", 0.3048}, {"km", 1e3}, {"m", 1.0}}};

// Splits "12.5cm" into the number and the rest.
std::optional<std::pair<double, std::string_view>> leading_number(const std::string& text) {
  double number = 0;
  const char* end = text.data() + text.size();
  const auto [rest, error] = std::from_chars(text.data(), end, number);
  if (error != std::errc() || !std::isfinite(number) || number <= 0) return std::nullopt;
  const char* unit = rest;
  while (unit != end && *unit == ' ') ++unit;
  return std::pair{number, std::string_view(unit, std::size_t(end - unit))};
}

std::optional<double> length_of(std::string_view unit) {
  for (const auto& [name, metres] : kLengths) {
    if (unit == name) return metres;
  }
  return std::nullopt;
}

}  // namespace

std::optional<double> parse_length(const std::string& text) {
  const auto split = leading_number(text);
  if (!split) return std::nullopt;
  if (split->second.empty()) return split->first;
  const auto metres = length_of(split->second);
  return metres ? std::optional(split->first * *metres) : std::nullopt;
}

std::optional<double> parse_unit(const std::string& text) {
  if (const auto metres = length_of(text)) return metres;
  const auto split = leading_number(text);
  if (!split || !split->second.empty()) return std::nullopt;
  // With units far below atoms or beyond galaxies, areas would not be numbers any more.
  constexpr double kShortest = 1e-12, kLongest = 1e24;
  if (split->first < kShortest || split->first > kLongest) return std::nullopt;
  return split->first;
}

std::optional<std::int64_t> parse_bytes(const std::string& text) {
  const auto split = leading_number(text);
  if (!split) return std::nullopt;
  const std::string unit = small_letters(std::string(split->second));
  const bool binary = unit.size() >= 2 && unit[1] == 'i';
  double factor = 1;
  if (!unit.empty() && unit != "b") {
    const auto power = std::string_view("kmgt").find(unit[0]);
    const std::string rest = unit.substr(binary ? 2 : 1);
    if (power == std::string_view::npos || !(rest.empty() || rest == "b")) return std::nullopt;
    factor = std::pow(binary ? 1024.0 : 1000.0, double(power) + 1);
  }
  const double bytes = split->first * factor;
  if (bytes < 1 || bytes > 9e18) return std::nullopt;
  return std::int64_t(bytes);
}

}  // namespace atlas::app
