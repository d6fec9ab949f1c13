// Chart sets that contradict themselves, for calls that take one together with its mesh.
#pragma once

#include <cmath>
#include <functional>
#include <vector>

#include "libatlas/charts/charts.h"

namespace atlas::test {

struct BrokenCharts {
  const char* what;
  std::function<void(ChartSet&)> damage;  // of a set with several triangles in its first chart
};

// Breaks what every call checks: the ranges of charts, their uvs, and the lists of triangles.
inline std::vector<BrokenCharts> broken_charts() {
  return {{"no uvs", [](ChartSet& set) { set.uvs.clear(); }},
          {"a uv too few", [](ChartSet& set) { set.uvs.pop_back(); }},
          {"no triangle_uv", [](ChartSet& set) { set.triangle_uv.clear(); }},
          {"triangle_uv of one triangle less", [](ChartSet& set) { set.triangle_uv.resize(3); }},
          {"a uv beyond the set", [](ChartSet& set) { set.triangle_uv[7] = 1000000; }},
          {"a triangle too few", [](ChartSet& set) { set.chart_triangles.pop_back(); }},
          {"a triangle beyond the set", [](ChartSet& set) { set.chart_triangles[1] = 1000000; }},
          {"a range beyond the set", [](ChartSet& set) { set.charts[0].triangle_count = 100000; }},
          {"ranges whose sum wraps around",
           [](ChartSet& set) { set.charts[0].first_triangle = 0xffffffff; }},
          {"uvs beyond the set", [](ChartSet& set) { set.charts[0].first_uv = 1000000; }},
          {"more uvs than there are", [](ChartSet& set) { set.charts[0].uv_count = 1000000; }},
          {"a uv that is not finite", [](ChartSet& set) { set.uvs[2].y = INFINITY; }},
          {"a size that is no number", [](ChartSet& set) { set.charts[0].size.x = NAN; }},
          {"a size below 0", [](ChartSet& set) { set.charts[0].size.y = -1; }},
          {"a chart beyond the set", [](ChartSet& set) { set.triangle_chart[1] = 1000000; }},
          {"a flipped triangle beyond the set",
           [](ChartSet& set) { set.flipped_triangles.push_back(1000000); }}};
}

// Breaks what only calls read that need the vertices of uvs.
inline std::vector<BrokenCharts> charts_with_broken_vertices() {
  return {
      {"no uv_vertex", [](ChartSet& set) { set.uv_vertex.clear(); }},
      {"a vertex too few", [](ChartSet& set) { set.uv_vertex.pop_back(); }},
      {"a vertex beyond the mesh", [](ChartSet& set) { set.uv_vertex[3] = 1000000; }},
      {"triangles listed twice", [](ChartSet& set) { set.charts.push_back(set.charts.front()); }}};
}

}  // namespace atlas::test
