// Internal: flattens one chart, or says how to divide it.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "libatlas/charts/flattening/flatten.h"
#include "libatlas/param/parameterize.h"

namespace atlas {

// The memory that one thread needs at a time.
struct ChartScratch {
  LocalChart chart;
  ParamWorkspace workspace;
  std::vector<std::array<std::uint32_t, 2>> border;
  double cuts_cpu = 0;      // CPU seconds spent on cutting charts open
  std::size_t largest = 0;  // number of triangles of the largest chart so far
};

// The outcome for one chart: it is flat, or is to be divided.
struct ChartOutcome {
  FlatChart flat;
  std::vector<std::uint8_t> parts;  // one per triangle: its part, if the chart is to be divided
  bool failed = false;              // the chart could not be flattened as it was
};

// A chart, how to begin with it, and how much to try.
struct ChartTask {
  std::span<const std::uint32_t> triangles = {};
  int cuts = 3;      // rounds of cutting the chart open before it is divided
  int closings = 1;  // how many of these may close cuts whose banks cross
  // Three per triangle, or empty: uvs of the flat parts to be joined (param::FlatParts).
  std::span<const Vec2d> joined = {};
  // The joined uvs are one large part and little else, so only the places beyond the
  // bound are relaxed.
  bool little = false;
  bool whole = false;  // a failure needs no division: `parts` is then one entry
};

// Flattens one chart, and cuts it open where that helps (only seams of its own triangles are
// changed).
ChartOutcome flatten_chart(const FlattenInput& input, Partition& partition, const ChartTask& task,
                           ChartScratch& scratch);

}  // namespace atlas
