// The results of a benchmark run as plain rows, and the JSON file that holds them.
#pragma once

#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "libatlas/core/status.h"

namespace atlas::bench {

// The origin of the numbers, to which a page can be traced.
struct Machine {
  std::string processor, system, compiler, build, date, command;
  int cores = 0;
};

// One stage on one mesh with one setting.
struct Row {
  std::string stage, mesh, setting;
  bool preset = false;          // whether the setting is a named preset of the library
  std::uint64_t triangles = 0;  // of the mesh
  std::uint64_t size_in = 0, size_out = 0;
  std::string unit;  // "triangles -> charts"
  // Measured qualities by name. The first is the stage's error: smaller is better, 0 is perfect.
  std::vector<std::pair<std::string, double>> values;
  double cpu_seconds = 0;   // user + system, all threads; the least of the repeats
  double cpu_spread = 0;    // largest / least of the repeats - 1; 0 for one
  double wall_seconds = 0;  // of the repeat with the least CPU time
  double memory_mib = 0;    // largest resident set while it ran, including the input
  double input_mib = 0;     // part that was resident at the start: the program and the input
  double instructions = 0;  // executed, counted by callgrind on one thread; 0: not counted
  int threads = 0;          // number used; 0: as many as there are cores
  std::string failure;      // reason why there are no figures; empty if it worked
  std::string source;       // "file.json:line" after load(), not stored

  std::string key() const;  // names the row within a file
  // Returns the value of that name, or `missing`.
  double value(const std::string& name, double missing = 0) const;
};

// cost = factor * triangles^exponent, fitted to the logarithms by least squares.
struct Fit {
  std::string stage, work, quantity;  // quantity: "cpu_seconds" or "memory_mib"
  double exponent = 0, factor = 0;
  std::uint64_t smallest = 0, largest = 0;  // triangles
  std::uint32_t points = 0;
};

// One line of the stability page: `value` must not exceed `bound`.
struct Check {
  std::string group, stress, quantity;
  double value = 0, bound = 0;
  std::string note;                              // reference, or where the method degrades
  bool holds() const { return value <= bound; }  // false for NaN
  std::string source = {};                       // as in Row
};

struct Results {
  Machine machine;
  std::vector<Row> rows;
  std::vector<Fit> fits;
  std::vector<Check> checks;
};

// Counts different machines and builds, by processor, number of cores, compiler and kind of build:
// times of one cannot be compared with times of another.
std::size_t machine_count(std::span<const Results> files);

// Returns the joined argv; the other members come from the system and the build.
Machine describe_machine(int argc, const char* const* argv);

// Checks whether save() could write there, to be called before a run of an hour. An empty path
// means no file. Errors: io.
Status check_target(const std::filesystem::path& path);

// The file has one row, fit or check per line, so that a figure can be cited as file:line. Errors:
// io; not_found; bad_input, which names what is wrong with the file.
Status save(const Results& results, const std::filesystem::path& path);
Result<Results> load(const std::filesystem::path& path);

// Returns one row as a line of such a file, or parses it. Errors: bad_input.
std::string to_json_line(const Row& row);
Result<Row> row_from_line(const std::string& line);

// "charts  sphere:20480  standard  20480 triangles -> 12 charts  seam 5.1  820 ms  41 MiB"
std::string line(const Row& row);

// Returns one fit for every stage, kind of work and preset setting that has at least two sizes of
// at least `smallest` triangles.
std::vector<Fit> fit_exponents(const std::vector<Row>& rows, std::uint64_t smallest);

}  // namespace atlas::bench
