// Internal: one chart on its way to flat coordinates.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "libatlas/charts/flattening/flatten.h"
#include "libatlas/param/parameterize.h"

namespace atlas {

// Memory that one thread needs at a time.
struct ChartScratch {
  LocalChart chart;
  ParamWorkspace workspace;
  std::vector<std::array<std::uint32_t, 2>> border;
  double cuts_cpu = 0;      // seconds spent on cutting charts open
  std::size_t largest = 0;  // triangles of the largest chart so far
};

// What became of a chart: flat; or to be divided; or to lose a few triangles to its neighbours.
struct ChartOutcome {
  FlatChart flat;
  std::vector<std::uint8_t> parts;    // 1 a triangle: the part it goes to, if not empty
  std::vector<std::uint32_t> remove;  // triangles whose going would help; parts is set as well, for
                                      // when no neighbour takes them
  std::size_t crossings = 0;          // of its border, that remove is to undo
  std::vector<Vec2d> uvs;             // with remove, 3 a triangle: what to go on from
  bool failed = false;                // could not be flattened as it was
};

struct ChartEffort {
  int rings = 1;     // of triangles around a crossing of the border, that are listed for removal
  int cuts = 3;      // rounds of cutting it open, before it is divided
  int closings = 1;  // rounds, among these, of closing cuts whose banks cross
  // 3 a triangle, or empty: of flat parts that are to be joined (see ParamOptions::joined).
  std::span<const Vec2d> joined = {};
  // 3 a triangle, or empty: where an earlier attempt came to that was within the bound; unplaced()
  // (newcomers.h) for triangles that the chart got since.
  std::span<const Vec2d> resumed = {};
  // What is joined or resumed is one large part and little else: only the places beyond the bound
  // are relaxed.
  bool little = false;
  bool whole = false;  // what fails needs no division: its parts are a single one
};

// Flattens one chart, cutting it open where that helps (seams of its own triangles only).
ChartOutcome flatten_chart(const FlattenInput& input, Partition& partition,
                           std::span<const std::uint32_t> triangles, const ChartEffort& effort,
                           ChartScratch& scratch);

}  // namespace atlas
