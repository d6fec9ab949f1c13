#include "libatlas/charts/flattening/uv_folds.h"

#include <algorithm>
#include <array>
#include <limits>

#include "libatlas/core/predicates.h"

namespace atlas {
namespace {

// The least share of the area in a part.
constexpr double kSmallestPart = 0.05;

// Returns the orientation of the triangle's given uvs; 0 also if it has none.
int turn(const GivenMesh& given, std::uint32_t t) {
  if (given.mesh.texcoord_indices.empty()) return 0;
  std::array<Vec2d, 3> uv;
  for (std::uint32_t c = 0; c < 3; ++c) {
    const std::uint32_t corner = given.topology.input_corner(3 * t + c);
    const std::uint32_t index = given.mesh.texcoord_indices[corner];
    if (index == kNoIndex) return 0;
    uv[c] = {given.mesh.texcoords[index].x, given.mesh.texcoords[index].y};
  }
  return orientation(uv[0], uv[1], uv[2]);
}

// Assigns `name` to the part around `seed`. Returns its area.
double flood(const GivenMesh& given, std::uint32_t seed, std::uint32_t name, UvFolds& folds) {
  const Topology& topology = given.topology;
  const int sense = turn(given, seed);
  double area = 0;
  std::vector<std::uint32_t> queue(1, seed);
  folds.part[seed] = name;
  while (!queue.empty()) {
    const std::uint32_t t = queue.back();
    queue.pop_back();
    area += topology.areas[t];
    for (std::uint32_t h = 3 * t; h < 3 * t + 3; ++h) {
      const std::uint32_t o = topology.opposite[h];
      if (o == kNoIndex || folds.part[o / 3] != kNoIndex) continue;
      if (turn(given, o / 3) != sense) continue;
      folds.part[o / 3] = name;
      queue.push_back(o / 3);
    }
  }
  return area;
}

}  // namespace

void divide_at_folds(const GivenMesh& given, std::uint32_t component,
                     std::span<const std::uint32_t> triangles, UvFolds& folds) {
  folds.part.resize(given.topology.triangle_count(), kNoIndex);
  const std::size_t before = folds.owner.size();
  double total = 0, least = std::numeric_limits<double>::infinity();
  bool flat = false;
  for (const std::uint32_t t : triangles) {
    total += given.topology.areas[t];
    if (folds.part[t] != kNoIndex) continue;
    flat = flat || turn(given, t) == 0;
    least = std::min(least, flood(given, t, static_cast<std::uint32_t>(folds.owner.size()), folds));
    folds.owner.push_back(component);
  }
  if (!flat && folds.owner.size() > before + 1 && least >= kSmallestPart * total) return;
  for (const std::uint32_t t : triangles) folds.part[t] = kNoIndex;
  folds.owner.resize(before);
}

}  // namespace atlas
