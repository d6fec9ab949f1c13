#include "libatlas/charts/mesh/pieces.h"

#include <algorithm>

namespace atlas {

PieceCutter::PieceCutter(const Topology& whole)
    : whole_(whole),
      pieces_(whole),
      place_(whole.triangle_count(), kNoIndex),
      vertex_(whole.points.size(), 0) {}

PieceMesh PieceCutter::cut(std::span<const std::uint32_t> pieces) {
  PieceMesh out;
  std::size_t count = 0;
  for (const std::uint32_t piece : pieces) count += triangle_count(piece);
  Topology& t = out.topology;
  t.scale = whole_.scale;
  t.whole_triangles = std::max(whole_.whole_triangles, whole_.triangle_count());
  t.component_count = static_cast<std::uint32_t>(pieces.size());
  out.triangles.reserve(count);
  t.corner_vertex.reserve(3 * count);
  t.opposite.reserve(3 * count);
  t.normals.reserve(count);
  if (!whole_.calm_normals.empty()) t.calm_normals.reserve(count);
  t.areas.reserve(count);
  t.flags.reserve(count);
  t.component.reserve(count);
  for (std::uint32_t k = 0; k < pieces.size(); ++k) {
    add_piece(pieces[k], out);
    t.component.resize(out.triangles.size(), k);
  }
  return out;
}

void PieceCutter::add_piece(std::uint32_t piece, PieceMesh& out) {
  Topology& t = out.topology;
  const auto first_triangle = static_cast<std::uint32_t>(out.triangles.size());
  const auto first_vertex = static_cast<std::uint32_t>(t.points.size());
  for (std::uint32_t i = pieces_.first[piece]; i < pieces_.first[piece + 1]; ++i) {
    const std::uint32_t triangle = pieces_.triangles[i];
    place_[triangle] = static_cast<std::uint32_t>(out.triangles.size());
    out.triangles.push_back(triangle);
    t.normals.push_back(whole_.normals[triangle]);
    if (!whole_.calm_normals.empty()) t.calm_normals.push_back(whole_.calm_normals[triangle]);
    t.areas.push_back(whole_.areas[triangle]);
    t.flags.push_back(whole_.flags[triangle]);
    if (!whole_.polygon.empty()) t.polygon.push_back(whole_.polygon[triangle]);
  }
  add_corners(first_triangle, first_vertex, out);
}

void PieceCutter::add_corners(std::uint32_t first_triangle, std::uint32_t first_vertex,
                              PieceMesh& out) {
  Topology& t = out.topology;
  for (std::size_t i = first_triangle; i < out.triangles.size(); ++i) {
    for (std::uint32_t c = 0; c < 3; ++c) {
      const std::uint32_t h = 3 * out.triangles[i] + c, v = whole_.corner_vertex[h];
      std::uint32_t& name = vertex_[v];
      // An index that an earlier piece left here does not lead back to v.
      if (name < first_vertex || name >= t.points.size() || t.source_vertex[name] != v) {
        name = static_cast<std::uint32_t>(t.points.size());
        t.points.push_back(whole_.points[v]);
        t.source_vertex.push_back(v);
        if (!whole_.seam_weights.empty()) t.seam_weights.push_back(whole_.seam_weights[v]);
      }
      t.corner_vertex.push_back(name);
      const std::uint32_t o = whole_.opposite[h];
      t.opposite.push_back(o == kNoIndex ? kNoIndex : 3 * place_[o / 3] + o % 3);
    }
  }
}

}  // namespace atlas
