// Internal: where the flattening of each triangle starts.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "libatlas/charts/mesh/topology.h"

namespace atlas {

// One map from space to the plane a triangle, as IsometricStart::frames wants them. The triangles
// of a cell share its map, turned to the normal of each only when it is asked for: that happens
// once, and a map of its own would be 24 bytes a triangle.
class Frames {
 public:
  using Frame = std::array<Vec3f, 2>;
  struct Shared {
    Vec3d normal;
    std::array<Vec3d, 2> rows;
  };

  // Turned by the shortest rotation that takes normal `from` to `to`; as they are where these are
  // opposite.
  static Frame turned(const std::array<Vec3d, 2>& rows, const Vec3d& from, const Vec3d& to);

  bool empty() const { return source_.empty(); }
  void resize(std::size_t triangles) { source_.resize(triangles, kNoIndex); }
  std::uint32_t add(const Shared& map);  // returns its number
  void share(std::uint32_t t, std::uint32_t map) { source_[t] = map; }
  void put(std::uint32_t t, const Frame& frame);  // one of its own
  // Zero for a triangle that has none.
  Frame at(const Topology& topology, std::uint32_t t) const;

 private:
  static constexpr std::uint32_t kOwn = 0x80000000u;

  std::vector<std::uint32_t> source_;  // 1 a triangle: in shared_, or, with that bit, in own_
  std::vector<Shared> shared_;
  std::vector<Frame> own_;
};

}  // namespace atlas
