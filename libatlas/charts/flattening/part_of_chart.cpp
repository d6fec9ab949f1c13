#include "libatlas/charts/flattening/part_of_chart.h"

#include <algorithm>
#include <array>
#include <utility>
#include <vector>

#include "libatlas/param/descent/flatten_disc.h"
#include "libatlas/param/mesh/halfedges.h"
#include "libatlas/param/orient.h"

namespace atlas {
namespace {

// Relaxes a piece beyond the bound. What was a small part of a chart may be a large part of the
// piece.
void relax(const LocalMesh& mesh, double max_stretch, FlatChart& piece) {
  param::FlattenOptions options;
  options.max_stretch = max_stretch;
  ParamWorkspace workspace;
  ParamResult relaxed = param::resume_flattening(mesh, piece.uvs, options, workspace);
  if (!relaxed.injective || !relaxed.within_bound) return;
  piece.uvs = std::move(relaxed.uvs);
  piece.distortion = relaxed.distortion;
}

}  // namespace

FlatChart take_triangles(const FlatChart& whole, std::span<const std::uint32_t> triangles) {
  FlatChart piece;
  piece.planar = whole.planar;
  piece.fragment = whole.fragment;
  std::vector<std::uint32_t> local(whole.uvs.size(), kNoIndex);
  for (const std::uint32_t i : triangles) {
    piece.triangles.push_back(whole.triangles[i]);
    piece.corners.push_back(whole.corners[i]);
    for (std::uint32_t& c : piece.corners.back()) {
      if (local[c] == kNoIndex) {
        local[c] = std::uint32_t(piece.uvs.size());
        piece.uvs.push_back(whole.uvs[c]);
        piece.vertex.push_back(whole.vertex[c]);
      }
      c = local[c];
    }
  }
  return piece;
}

void keep_to_bound(const LocalMesh& mesh, double max_stretch, FlatChart& piece) {
  piece.distortion = measure_distortion(mesh, piece.uvs);
  if (piece.distortion.stretch_999 > max_stretch) relax(mesh, max_stretch, piece);
}

void turn_for_packing(FlatChart& piece) {
  const auto border = param::border_edges(piece.corners, piece.uvs.size());
  piece.size = orient_for_packing(piece.uvs, border).size;
}

FlatChart part_of_chart(const FlattenInput& input, const FlatChart& whole,
                        std::span<const std::uint32_t> triangles) {
  FlatChart piece = take_triangles(whole, triangles);
  std::vector<Vec3f> positions;
  for (const std::uint32_t v : piece.vertex) positions.push_back(input.topology.points[v]);
  std::vector<double> density;
  if (!input.density.empty()) {
    for (const std::uint32_t t : piece.triangles) density.push_back(input.density[t]);
  }
  keep_to_bound({PositionView(positions, positions[0]), piece.corners, density},
                input.options.max_stretch, piece);
  turn_for_packing(piece);
  piece.cone = part_of_cone(input.topology.normals, piece.triangles, whole.cone);
  return piece;
}

std::vector<std::vector<std::uint32_t>> connected_parts(const FlatChart& whole,
                                                        std::span<const std::uint32_t> triangles) {
  std::vector<std::array<std::uint32_t, 3>> corners;
  for (const std::uint32_t i : triangles) corners.push_back(whole.corners[i]);
  param::HalfEdges half_edges;
  half_edges.build(corners, whole.uvs.size());
  std::vector<std::vector<std::uint32_t>> parts;
  std::vector<std::uint8_t> seen(corners.size(), 0);
  for (std::uint32_t seed = 0; seed < corners.size(); ++seed) {
    if (std::exchange(seen[seed], 1)) continue;
    std::vector<std::uint32_t> part{seed};
    for (std::size_t k = 0; k < part.size(); ++k) {
      for (std::uint32_t h = 3 * part[k]; h < 3 * part[k] + 3; ++h) {
        const std::uint32_t o = half_edges.opposite(h);
        if (o != kNoIndex && !std::exchange(seen[o / 3], 1)) part.push_back(o / 3);
      }
    }
    std::sort(part.begin(), part.end());
    for (std::uint32_t& t : part) t = triangles[t];
    parts.push_back(std::move(part));
  }
  return parts;
}

}  // namespace atlas
