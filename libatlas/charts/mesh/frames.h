// Internal: the maps from space to the plane that the flattening of each triangle starts from.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "libatlas/charts/mesh/topology.h"

namespace atlas {

// One map from space to the plane for each triangle, in the form that IsometricStart::frames takes.
// The triangles of a cell share a map, which is turned to the normal of each only when it is asked
// for. That happens once, whereas a stored map would take 24 bytes per triangle.
class Frames {
 public:
  using Frame = std::array<Vec3f, 2>;
  struct Shared {
    Vec3d normal;
    std::array<Vec3d, 2> rows;
  };

  // Returns `rows` turned by the shortest rotation that takes normal `from` to `to`. Where these
  // are opposite, the rows are not turned.
  static Frame turned(const std::array<Vec3d, 2>& rows, const Vec3d& from, const Vec3d& to);

  bool empty() const { return source_.empty(); }
  void resize(std::size_t triangles) { source_.resize(triangles, kNoIndex); }
  std::uint32_t add(const Shared& map);  // returns its number
  void share(std::uint32_t t, std::uint32_t map) { source_[t] = map; }
  void put(std::uint32_t t, const Frame& frame);  // gives the triangle its own map
  // Returns zero for a triangle that has no map.
  Frame at(const Topology& topology, std::uint32_t t) const;

 private:
  static constexpr std::uint32_t kOwn = 0x80000000u;

  // One per triangle: an index into shared_ or, if the bit kOwn is set, into own_.
  std::vector<std::uint32_t> source_;
  std::vector<Shared> shared_;
  std::vector<Frame> own_;
};

}  // namespace atlas
