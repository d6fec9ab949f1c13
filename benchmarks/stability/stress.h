// Functions that several groups of stability checks share.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "benchmarks/stability/checks.h"
#include "libatlas/charts/charts.h"
#include "libatlas/scene/reader.h"

namespace atlas::bench {

// A path in the system's temporary folder that only this process uses. The file is removed at the
// end.
struct TemporaryFile {
  std::filesystem::path path;
  explicit TemporaryFile(const std::string& name);
  ~TemporaryFile();
};

Result<ChartSet> charts_of(const test::Shape& shape, const ChartOptions& options,
                           const Context& context);

// Counts triangles that are in no chart, uvs that are not finite, and flips.
double broken(const ChartSet& set);

// Returns the largest |uv / scale - uv of the reference| relative to the reference's extent, or
// infinity if the charts differ.
double uv_drift(const ChartSet& set, const ChartSet& reference, double scale);

// Returns two generated shapes and the models of the options.
std::vector<test::Shape> subjects(const CheckList& list);

// Returns the shape after moving it far away and reading it from an OBJ in double, as scenes in
// world coordinates are stored.
Result<LoadedScene> read_moved(const test::Shape& shape, double offset, const Context& context);

}  // namespace atlas::bench
