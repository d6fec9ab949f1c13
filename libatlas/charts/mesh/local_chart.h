// Internal: LocalChart, one chart cut out of the mesh, with its own vertices.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "libatlas/charts/mesh/topology.h"
#include "libatlas/param/local_mesh.h"

namespace atlas {

// Assigns triangles to charts. It is written between parallel phases only, except for the seam bits
// and local indices of a chart's own triangles.
struct Partition {
  std::vector<std::uint32_t> chart;  // one per triangle; kNoIndex: none
  // One per triangle: bit c is set where half-edge c is cut although both sides belong to the same
  // chart.
  std::vector<std::uint8_t> seams;
  // One per triangle: scratch, its index in its chart's list.
  std::vector<std::uint32_t> local;

  bool seam(std::uint32_t h) const { return seams[h / 3] >> (h % 3) & 1; }
  // cut() and close() change one side; the opposite half-edge must be changed likewise.
  void cut(std::uint32_t h) { seams[h / 3] |= static_cast<std::uint8_t>(1u << (h % 3)); }
  void close(std::uint32_t h) { seams[h / 3] &= static_cast<std::uint8_t>(~(1u << (h % 3))); }
};

// Half-edge 3 i + c belongs to the chart's i-th triangle.
class LocalChart {
 public:
  LocalChart() = default;
  LocalChart(LocalChart&&) = default;  // no copies: `opposite` may point into the chart
  LocalChart& operator=(LocalChart&&) = default;

  // Positions relative to the first one, scaled as in the topology, and kept in single precision as
  // there.
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

  // Cuts out a chart. `triangles` are all triangles with one value of Partition::chart, ascending,
  // and must outlive this object.
  void build(const Topology& topology, Partition& partition,
             std::span<const std::uint32_t> triangles);
  // Takes the density of its triangles from `all`: one per triangle of the topology, or empty.
  void take_density(std::span<const float> all);
  // The area of the chart's surface in the topology's scaled units, and the area that its uvs are
  // to have: each triangle's times its density squared.
  double surface_area(const Topology& topology) const;
  double target_area(const Topology& topology) const;

  std::span<const std::uint32_t> triangles() const { return triangles_; }
  LocalMesh mesh() const { return {positions.view(), corners, density, opposite}; }

  Positions positions;
  std::vector<std::array<std::uint32_t, 3>> corners;
  std::vector<double> density;              // see take_density()
  std::vector<std::uint32_t> vertex;        // one per position: its vertex in the topology
  std::span<const std::uint32_t> opposite;  // one per half-edge; kNoIndex on the boundary
  std::vector<std::uint32_t> loops;         // one half-edge of each boundary loop
  std::uint32_t border_count = 0;           // half-edges on the boundary
  std::uint32_t component_count = 0;
  std::vector<std::uint32_t> component;  // one per triangle; may be empty if there is only one

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
  std::vector<std::uint32_t> linked_;  // storage of `opposite`, unless that is the topology's
  std::vector<std::uint8_t> seen_;
  std::vector<std::uint32_t> queue_;  // the chart's triangles, breadth-first
};

}  // namespace atlas
