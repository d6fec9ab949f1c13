#include "libatlas/charts/mesh/noise.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "libatlas/core/glm_bridge.h"
#include "libatlas/core/portable_math.h"

namespace atlas {
namespace {

// A piece is noisy if it has more than 600 edges (some 400 triangles), of which more than
// kFoldShare fold by more than nine degrees. Smooth meshes of that size fold by three to five
// degrees at most edges. Rough meshes of few triangles, with noise or not, also come out in fewer
// charts when they count as noisy.
constexpr double kFoldCosine = 0.988, kFoldShare = 0.6;
constexpr std::size_t kManyNoisyTriangles = 800;
constexpr int kRounds = 4;

std::vector<std::uint8_t> noisy_pieces(const Topology& topology) {
  struct Count {
    std::uint32_t edges = 0, folds = 0;
  };
  std::vector<Count> counts(topology.component_count);
  for (std::uint32_t h = 0; h < topology.opposite.size(); ++h) {
    const std::uint32_t o = topology.opposite[h];
    if (o == kNoIndex || o < h) continue;
    Count& count = counts[topology.component[h / 3]];
    ++count.edges;
    count.folds +=
        glm::dot(to_dvec(topology.normals[h / 3]), to_dvec(topology.normals[o / 3])) < kFoldCosine;
  }
  std::vector<std::uint8_t> noisy(counts.size());
  for (std::size_t i = 0; i < counts.size(); ++i) {
    noisy[i] = counts[i].folds > kFoldShare * counts[i].edges &&
               2 * std::size_t{counts[i].edges} > 3 * kManyNoisyTriangles / 2;
  }
  return noisy;
}

Vec3f averaged(const Topology& topology, const std::vector<Vec3f>& normals, std::uint32_t t) {
  const glm::dvec3 own = to_dvec(normals[t]);
  glm::dvec3 sum = double(topology.areas[t]) * own;
  for (std::uint32_t h = 3 * t; h < 3 * t + 3; ++h) {
    const std::uint32_t o = topology.opposite[h];
    if (o == kNoIndex) continue;
    const glm::dvec3 other = to_dvec(normals[o / 3]);
    sum += double(topology.areas[o / 3]) * std::max(0.0, glm::dot(own, other)) * other;
  }
  const double length = glm::length(sum);
  return length > 0 ? from_glm(glm::vec3(sum / length)) : normals[t];
}

// Returns the angle of a triangle at the corner where the half-edge starts, radians.
double angle(const Topology& topology, std::uint32_t half_edge) {
  const auto point = [&](std::uint32_t h) {
    return to_dvec(topology.points[topology.corner_vertex[h]]);
  };
  const glm::dvec3 from = point(half_edge);
  const glm::dvec3 a = point(next_half_edge(half_edge)) - from,
                   b = point(previous_half_edge(half_edge)) - from;
  return portable::atan2(glm::length(glm::cross(a, b)), glm::dot(a, b));
}

}  // namespace

void calm_noise(Topology& topology, const Context& context) {
  if (topology.triangle_count() < kManyNoisyTriangles) return;
  const std::vector<std::uint8_t> noisy = noisy_pieces(topology);
  if (std::find(noisy.begin(), noisy.end(), 1) == noisy.end()) return;
  std::vector<Vec3f> now = topology.normals, next = now;
  for (int round = 0; round < kRounds && !context.cancelled(); ++round) {
    for (std::uint32_t t = 0; t < now.size(); ++t) {
      if (topology.component[t] == kNoIndex || !noisy[topology.component[t]]) continue;
      next[t] = averaged(topology, now, t);
    }
    now.swap(next);
  }
  topology.calm_normals = std::move(now);
}

ChartSet::Noise measure_noise(const Topology& topology, double max_stretch) {
  ChartSet::Noise noise;
  if (topology.calm_normals.empty()) return noise;
  const std::vector<std::uint8_t> noisy = noisy_pieces(topology);
  constexpr double kOpen = std::numeric_limits<double>::infinity();  // at a border
  std::vector<double> angles(topology.points.size(), 0);
  for (std::uint32_t h = 0; h < topology.opposite.size(); ++h) {
    if (topology.component[h / 3] == kNoIndex || !noisy[topology.component[h / 3]]) continue;
    const auto at = [&](std::uint32_t k) { return topology.corner_vertex[k]; };
    const std::uint32_t next = next_half_edge(h);
    angles[at(h)] += angle(topology, h);
    if (topology.opposite[h] == kNoIndex) angles[at(h)] = angles[at(next)] = kOpen;
  }
  const double least = 2 * std::numbers::pi / (max_stretch * max_stretch);
  for (const double sum : angles) {
    noise.vertices += sum > 0;
    noise.peaks += sum > 0 && sum < least;
  }
  return noise;
}

}  // namespace atlas
