// Internal: one chart cut out of the mesh, with vertices of its own.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "libatlas/charts/mesh/topology.h"
#include "libatlas/param/local_mesh.h"

namespace atlas {

// Which triangles belong together. Written between parallel phases only, but for the seam bits and
// local indices of a chart's own triangles.
struct Partition {
  std::vector<std::uint32_t> chart;  // 1 a triangle; kNoIndex: none
  std::vector<std::uint8_t> seams;   // 1 a triangle: bit c set where half-edge c is cut although
                                     // both sides belong to the same chart
  std::vector<std::uint32_t> local;  // 1 a triangle: scratch, its place in its chart's list

  bool seam(std::uint32_t h) const { return seams[h / 3] >> (h % 3) & 1; }
  // Of one side; the other half-edge wants the same.
  void cut(std::uint32_t h) { seams[h / 3] |= static_cast<std::uint8_t>(1u << (h % 3)); }
  void close(std::uint32_t h) { seams[h / 3] &= static_cast<std::uint8_t>(~(1u << (h % 3))); }
};

// Half-edge 3 i + c belongs to the chart's i-th triangle.
class LocalChart {
 public:
  LocalChart() = default;
  LocalChart(LocalChart&&) = default;  // no copies: `opposite` may point into the chart
  LocalChart& operator=(LocalChart&&) = default;

  // Relative to the first one, scaled as the topology; kept in single precision, as they are there.
  class Positions {
   public:
    void clear() { points_.clear(); }
    void push_back(const Vec3f& point) { points_.push_back(point); }
    std::size_t size() const { return points_.size(); }
    Vec3d operator[](std::size_t v) const { return view()[v]; }
    PositionView view() const { return {points_, points_.empty() ? Vec3f{} : points_[0]}; }

   private:
    std::vector<Vec3f> points_;
  };

  // `triangles` is the whole chart, ascending; its triangles carry the same Partition::chart.
  void build(const Topology& topology, Partition& partition,
             std::span<const std::uint32_t> triangles);

  std::span<const std::uint32_t> triangles() const { return triangles_; }
  LocalMesh mesh() const { return {positions.view(), corners, density, opposite}; }

  Positions positions;
  std::vector<std::array<std::uint32_t, 3>> corners;
  std::vector<double> density;              // filled by the caller, or empty
  std::vector<std::uint32_t> vertex;        // 1 a position: of the topology
  std::span<const std::uint32_t> opposite;  // 1 a half-edge; kNoIndex at the border
  std::vector<std::uint32_t> loops;         // one half-edge of each border loop
  std::uint32_t border_count = 0;           // half-edges on the border
  std::uint32_t component_count = 0;
  std::vector<std::uint32_t> component;  // 1 a triangle; may be empty where there is but one

  int euler() const {
    const auto v = static_cast<std::int64_t>(positions.size());
    const auto f = static_cast<std::int64_t>(corners.size());
    return static_cast<int>(v - (3 * f + border_count) / 2 + f);
  }
  std::uint32_t next_border(std::uint32_t h) const {
    h = next_half_edge(h);
    while (opposite[h] != kNoIndex) h = next_half_edge(opposite[h]);
    return h;
  }

 private:
  void link(const Topology& topology, const Partition& partition);
  void number_vertices(const Topology& topology);
  void find_loops();
  void find_components();

  std::span<const std::uint32_t> triangles_;
  std::vector<std::uint32_t> linked_;  // `opposite`, unless that is the topology's
  std::vector<std::uint8_t> seen_;
  std::vector<std::uint32_t> queue_;  // its triangles, breadth-first
};

}  // namespace atlas
