// Quantities as people type them on a command line: lengths and byte sizes with units.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

namespace atlas::app {

// "5mm", "0.5cm", "1in", "0.002m" or "0.002" (metres) to metres; nothing if it is not a positive
// length.
std::optional<double> parse_length(const std::string& text);

// A unit name (m, cm, mm, in, ft, km) or a positive number of metres, to metres a unit.
std::optional<double> parse_unit(const std::string& text);

// "800MB", "1.5GiB", "64k" or plain bytes to bytes; nothing if it is not a positive size.
std::optional<std::int64_t> parse_bytes(const std::string& text);

}  // namespace atlas::app
