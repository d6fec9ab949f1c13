// Uvs of an earlier state of a mesh, which its next unwrapping is to keep: charts, their uvs and
// their places on the pages stay wherever triangles are as they were.
#pragma once

#include <cstdint>
#include <span>

#include "libatlas/core/vec.h"
#include "libatlas/pack/pack.h"

namespace atlas {

// The earlier mesh with its uvs; what the spans point at must outlive the call. Numbers and orders
// of triangles, of their corners and of vertices need not be those of the new mesh: triangles are
// found by their positions. What is not usable (an index out of range, a number that is not finite,
// a uv beyond its page, charts that lie on others) is made as new.
struct EarlierUvs {
  std::span<const Vec3f> positions = {};
  std::span<const std::uint32_t> indices = {};  // 3 a triangle
  std::span<const Vec2f> uvs = {};              // 0..1 over their page, origin bottom left
  // 3 a triangle, into uvs; empty: those of `indices`. An index out of range: that corner has none.
  std::span<const std::uint32_t> uv_indices = {};
  std::span<const std::uint32_t> triangle_page = {};  // 1 a triangle; empty: all lie on page 0
  std::span<const Extent> pages = {};                 // texels, sides of 1 .. 16384
  // 1 a position, or empty: as MeshView::objects of the new mesh, and of an Atlas the number of the
  // mesh. Triangles are then found in their own object only, whatever else lies at their place.
  std::span<const std::uint32_t> objects = {};
  // How far a corner may lie from where it lay for its triangle to be unchanged, as a share of the
  // mean edge of the earlier mesh; at least 0, below 1.
  double tolerance = 0.01;
};

// What a chart has of the earlier uvs.
enum class ChartOrigin : std::uint8_t {
  made,      // nothing: it is new, or has been moved
  repaired,  // unchanged triangles lie where they lay; others were lost, or have been laid beside
  kept,      // all that it had: the same triangles at the same place
};

}  // namespace atlas
