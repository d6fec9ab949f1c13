#include "libatlas/charts/assemble_charts.h"

#include <algorithm>
#include <array>
#include <unordered_map>
#include <utility>

#include "libatlas/core/degrees.h"
#include "libatlas/core/no_index.h"

namespace atlas {
namespace {

// Gathers the flat charts into one ChartSet.
class Assembler {
 public:
  Assembler(const ChartedTopology& charted, ChartSet& set)
      : mesh_(charted.mesh),
        topology_(charted.topology),
        set_(set),
        unscale_(charted.density / charted.topology.scale) {}

  void run(std::vector<FlatChart>& charts) {
    const std::size_t n = topology_.triangle_count();
    set_.triangle_chart.assign(n, kNoIndex);
    set_.triangle_uv.assign(3 * n, kNoIndex);
    set_.chart_triangles.reserve(n);
    std::size_t uvs = 0;
    for (const FlatChart& chart : charts) uvs += chart.uvs.size();
    set_.charts.reserve(charts.size());
    set_.uvs.reserve(uvs);
    set_.uv_vertex.reserve(uvs);
    for (FlatChart& chart : charts) {
      if (has_area(chart)) append(chart);
    }
    place_degenerate();
    number_triangles();
    for (std::uint32_t t = 0; t < n; ++t) {
      if (topology_.flags[t] & Topology::kFlipped) set_.flipped_triangles.push_back(t);
    }
  }

 private:
  std::uint32_t material(std::uint32_t t) const {
    return mesh_.materials.empty() ? 0 : mesh_.materials[t];
  }

  bool has_area(const FlatChart& chart) const {
    return std::any_of(chart.triangles.begin(), chart.triangles.end(),
                       [&](std::uint32_t t) { return !topology_.thin(t); });
  }

  bool placed(std::uint32_t t) const { return set_.triangle_chart[t] != kNoIndex; }

  void append(FlatChart& flat) {
    const auto id = static_cast<std::uint32_t>(set_.charts.size());
    const auto base = static_cast<std::uint32_t>(set_.uvs.size());
    Chart chart;
    chart.first_uv = base;
    chart.uv_count = static_cast<std::uint32_t>(flat.uvs.size());
    chart.material = material(flat.triangles.front());
    chart.size = {flat.size.x * unscale_, flat.size.y * unscale_};
    chart.axis = flat.cone.axis;
    chart.cone_degrees = degrees(flat.cone.angle);
    chart.planar_projection = flat.planar;
    chart.kept = flat.kept;
    chart.distortion = flat.distortion;
    chart.distortion.surface_area *= unscale_ * unscale_;
    chart.distortion.uv_area *= unscale_ * unscale_;
    for (const Vec2d uv : flat.uvs) set_.uvs.push_back({uv.x * unscale_, uv.y * unscale_});
    for (const std::uint32_t v : flat.vertex) {
      set_.uv_vertex.push_back(topology_.source_vertex[v]);
    }
    for (std::size_t i = 0; i < flat.triangles.size(); ++i) {
      const std::uint32_t t = flat.triangles[i];
      set_.triangle_chart[t] = id;
      for (std::uint32_t c = 0; c < 3; ++c) {
        set_.triangle_uv[topology_.input_corner(3 * t + c)] = base + flat.corners[i][c];
      }
    }
    set_.charts.push_back(chart);
    flat = FlatChart{};  // its memory is needed no more
  }

  // A triangle without area that no chart holds is drawn nowhere: it joins the chart of a
  // neighbour, one that shares an edge if there is one, and lies on that edge or on a vertex; else
  // any chart of its object and material.
  void place_degenerate() {
    if (topology_.defects.degenerate_triangles == 0) return;
    std::vector<std::uint8_t> wanted(topology_.points.size(), 0);
    for (std::uint32_t t = 0; t < topology_.triangle_count(); ++t) {
      if (placed(t)) continue;
      for (std::uint32_t h = 3 * t; h < 3 * t + 3; ++h) wanted[topology_.corner_vertex[h]] = 1;
    }
    std::unordered_map<std::uint64_t, std::uint32_t> around;  // vertex or edge -> a half-edge
    for (std::uint32_t h = 0; h < topology_.corner_vertex.size(); ++h) {
      const std::uint32_t a = topology_.corner_vertex[h];
      const std::uint32_t b = topology_.corner_vertex[next_half_edge(h)];
      if (!placed(h / 3) || !wanted[a]) continue;
      around.emplace(key(a, a), h);
      if (wanted[b]) around.emplace(key(std::min(a, b), std::max(a, b)), h);
    }
    std::vector<std::uint32_t> left;
    for (std::uint32_t t = 0; t < topology_.triangle_count(); ++t) {
      if (!placed(t)) left.push_back(t);
    }
    std::erase_if(left, [&](std::uint32_t t) { return place_with_polygon(t); });
    for (const std::uint32_t t : left) place_degenerate(t, around);
  }

  // Lays a triangle without area on an edge of another triangle of its polygon, or else on a
  // vertex. Returns false if no triangle of the polygon has one.
  bool place_with_polygon(std::uint32_t t) {
    if (topology_.polygon.empty()) return false;
    if (by_polygon_.empty()) list_polygons();
    const auto mates = std::equal_range(by_polygon_.begin(), by_polygon_.end(),
                                        std::pair(topology_.polygon[t], kNoIndex), by_first);
    for (const bool edge : {true, false}) {
      for (auto mate = mates.first; mate != mates.second; ++mate) {
        if (!placed(mate->second) || material(mate->second) != material(t)) continue;
        for (std::uint32_t h = 3 * mate->second; h < 3 * mate->second + 3; ++h) {
          const std::uint32_t a = topology_.corner_vertex[h];
          const std::uint32_t b = edge ? topology_.corner_vertex[next_half_edge(h)] : a;
          if ((edge && a == b) || !has_vertex(t, a) || !has_vertex(t, b)) continue;
          lay_on(t, h, edge);
          return true;
        }
      }
    }
    return false;
  }

  bool has_vertex(std::uint32_t t, std::uint32_t vertex) const {
    const std::uint32_t* const v = &topology_.corner_vertex[3 * std::size_t{t}];
    return v[0] == vertex || v[1] == vertex || v[2] == vertex;
  }

  // Gives the triangle the chart of half-edge h, and places on that edge or at its start.
  void lay_on(std::uint32_t t, std::uint32_t h, bool edge) {
    const std::uint32_t at_h = uv_at(h), at_next = uv_at(next_half_edge(h));
    set_.triangle_chart[t] = set_.triangle_chart[h / 3];
    for (std::uint32_t i = 3 * t; i < 3 * t + 3; ++i) {
      const bool other =
          edge && topology_.corner_vertex[i] == topology_.corner_vertex[next_half_edge(h)];
      set_.triangle_uv[topology_.input_corner(i)] = other ? at_next : at_h;
    }
  }

  using PolygonTriangle = std::pair<std::uint32_t, std::uint32_t>;
  static bool by_first(const PolygonTriangle& a, const PolygonTriangle& b) {
    return a.first < b.first;
  }

  void list_polygons() {
    for (std::uint32_t t = 0; t < topology_.triangle_count(); ++t)
      by_polygon_.emplace_back(topology_.polygon[t], t);
    std::sort(by_polygon_.begin(), by_polygon_.end());
  }

  std::uint32_t uv_at(std::uint32_t h) const { return set_.triangle_uv[topology_.input_corner(h)]; }

  static std::uint64_t key(std::uint64_t a, std::uint64_t b) { return a << 32 | b; }

  void place_degenerate(std::uint32_t t,
                        const std::unordered_map<std::uint64_t, std::uint32_t>& around) {
    std::array<std::uint32_t, 3> v;
    for (std::uint32_t c = 0; c < 3; ++c) v[c] = topology_.corner_vertex[3 * t + c];
    for (const bool edge : {true, false}) {
      for (std::uint32_t c = 0; c < 3; ++c) {
        const std::uint32_t a = v[c], b = edge ? v[(c + 1) % 3] : a;
        if (edge && a == b) continue;
        const auto found = around.find(key(std::min(a, b), std::max(a, b)));
        if (found == around.end() || material(found->second / 3) != material(t)) continue;
        lay_on(t, found->second, edge);
        return;
      }
    }
    const std::uint32_t chart = first_chart_like(t);
    set_.triangle_chart[t] = chart;
    for (std::uint32_t c = 0; c < 3; ++c) {
      set_.triangle_uv[3 * t + c] = set_.charts[chart].first_uv;
    }
  }

  std::uint64_t object_and_material(std::uint32_t vertex, std::uint32_t material) const {
    return key(mesh_.objects.empty() ? 0 : mesh_.objects[vertex], material);
  }

  std::uint32_t first_chart_like(std::uint32_t t) {
    if (first_alike_.empty()) {
      for (std::uint32_t k = 0; k < set_.charts.size(); ++k) {
        const Chart& chart = set_.charts[k];
        first_alike_.emplace(object_and_material(set_.uv_vertex[chart.first_uv], chart.material),
                             k);
      }
    }
    const auto id = static_cast<std::uint32_t>(set_.charts.size());
    const std::uint32_t vertex =
        topology_.source_vertex[topology_.corner_vertex[3 * std::size_t{t}]];
    const auto [known, added] = first_alike_.emplace(object_and_material(vertex, material(t)), id);
    if (!added) return known->second;
    Chart chart;  // a single point
    chart.first_uv = static_cast<std::uint32_t>(set_.uvs.size());
    chart.uv_count = 1;
    chart.material = material(t);
    chart.axis = {0, 0, 1};
    chart.planar_projection = true;
    set_.uvs.push_back({});
    set_.uv_vertex.push_back(vertex);
    set_.charts.push_back(chart);
    return id;
  }

  void number_triangles() {
    for (const std::uint32_t chart : set_.triangle_chart) ++set_.charts[chart].triangle_count;
    std::uint32_t first = 0;
    std::vector<std::uint32_t> next;
    next.reserve(set_.charts.size());
    for (Chart& chart : set_.charts) {
      chart.first_triangle = first;
      next.push_back(first);
      first += chart.triangle_count;
    }
    set_.chart_triangles.resize(first);
    for (std::uint32_t t = 0; t < set_.triangle_chart.size(); ++t) {
      set_.chart_triangles[next[set_.triangle_chart[t]]++] = t;
    }
    for (Chart& chart : set_.charts)
      chart.material = material(set_.chart_triangles[chart.first_triangle]);
  }

  const MeshView& mesh_;
  const Topology& topology_;
  ChartSet& set_;
  double unscale_;
  // By object and material, filled when asked for.
  std::unordered_map<std::uint64_t, std::uint32_t> first_alike_;
  std::vector<PolygonTriangle> by_polygon_;  // sorted; filled when asked for
};

}  // namespace

void assemble_charts(const ChartedTopology& charted, std::vector<FlatChart>& charts,
                     ChartSet& set) {
  Assembler(charted, set).run(charts);
}

}  // namespace atlas
