// Quantities as people type them on a command line: lengths and byte sizes with units.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

namespace atlas::app {

// Converts "5mm", "0.5cm", "1in", "0.002m" or "0.002" (metres) to metres; returns nothing if it is
// not a positive length.
std::optional<double> parse_length(const std::string& text);

// Converts a unit name (m, cm, mm, in, ft, km), or a number of metres from 1e-12 to 1e24, to metres
// per unit; returns nothing if it is neither.
std::optional<double> parse_unit(const std::string& text);

// Converts "800MB", "1.5GiB", "64k" or a number of bytes to bytes; returns nothing if it is less
// than 1 byte or more than 9e18.
std::optional<std::int64_t> parse_bytes(const std::string& text);

}  // namespace atlas::app
