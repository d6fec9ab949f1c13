// What several groups of stability checks share.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "benchmarks/stability/checks.h"
#include "libatlas/charts/charts.h"
#include "libatlas/scene/reader.h"

namespace atlas::bench {

// A path of this process's own in the system's folder for such files; removed at the end.
struct TemporaryFile {
  std::filesystem::path path;
  explicit TemporaryFile(const std::string& name);
  ~TemporaryFile();
};

Result<ChartSet> charts_of(const test::Shape& shape, const ChartOptions& options,
                           const Context& context);

// Triangles that are in no chart, uvs that are not finite, flips.
double broken(const ChartSet& set);

// Largest |uv / scale - uv of the reference| relative to the reference's extent; infinite if the
// charts differ.
double uv_drift(const ChartSet& set, const ChartSet& reference, double scale);

// Two shapes of the suite's own and the models of the options.
std::vector<test::Shape> subjects(const CheckList& list);

// The shape moved far away and read back through an OBJ written in double, as a scene in world
// coordinates comes.
Result<LoadedScene> read_moved(const test::Shape& shape, double offset, const Context& context);

}  // namespace atlas::bench
