// Compares two result files and finds what got worse by more than noise.
#pragma once

#include <string>
#include <vector>

#include "benchmarks/support/results.h"

namespace atlas::bench {

// A figure is worse if it exceeds the base by the relative *and* by the absolute threshold.
struct CompareOptions {
  // Of every value that says how good a result is. Of stretches, the excess over 1 counts.
  double quality_relative = 0.02, quality_absolute = 1e-4;
  double time_relative = 0.15, time_absolute = 0.05;  // CPU seconds
  double instructions_relative = 0.02, instructions_absolute = 1e6;
  double memory_relative = 0.1, memory_absolute = 16;  // MiB
};

struct Regression {
  enum Kind { quality, missing, failed, instructions, time, memory } kind{};
  std::string what;  // one line: row, figure, base, head
};

// Which way a value of Row::values gets better. Neither way: it describes the work, or it is a
// time.
enum class Better { lower, higher, neither, unknown };
Better better_of(const std::string& name);

// Looks at every value that has a better way, and at the numbers of charts, pages and triangles
// that a stage makes. Returns quality first, then rows that vanished or fail now, then instructions
// (if both files count them), time (if both files are of one machine and build) and memory. Checks
// of the stability page that held in the base and do not hold in the head count as quality. New
// rows are no regression.
std::vector<Regression> compare(const Results& base, const Results& head,
                                const CompareOptions& options);

}  // namespace atlas::bench
