#include "libatlas/texture/visibility.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>

#include "libatlas/core/bounds.h"
#include "libatlas/core/counting_sort.h"
#include "libatlas/core/glm_bridge.h"
#include "libatlas/core/no_index.h"
#include "libatlas/core/percentile.h"
#include "libatlas/core/random.h"

namespace atlas {
namespace {

constexpr int kPoints = 8192, kRays = 16, kNeeded = 10;
// The share of the observers that stand where nobody looks around: under seats, between furniture.
constexpr double kShortSighted = 0.5;
// The size of a voxel in spacings of the samples. Samples lie about one spacing apart. A wall has
// no holes for rays if voxels are larger than that.
constexpr double kVoxelSpacings = 2.5;
// The cosine of a half-angle of 50 degrees, which is about what a viewer's camera shows.
constexpr double kViewCosine = 0.64;
constexpr double kMaxVoxels = 1 << 24;

// Sets d to a random direction within the cone about `axis` whose half-angle has the given cosine.
// Directions are uniform by solid angle. With the cosine -1, any direction may result.
void direction_in_cone(std::mt19937_64& random, const double axis[3], double cosine, double d[3]) {
  const double z = 1 - (1 - cosine) * uniform(random), phi = 2 * std::numbers::pi * uniform(random);
  const double s = std::sqrt(std::max(0.0, 1 - z * z)), x = s * std::cos(phi),
               y = s * std::sin(phi);
  // An orthonormal frame about the axis without a branch on which component is small (Duff et al.
  // 2017).
  const double sign = axis[2] < 0 ? -1 : 1, a = -1 / (sign + axis[2]), b = axis[0] * axis[1] * a;
  const double u[3] = {1 + sign * axis[0] * axis[0] * a, sign * b, -sign * axis[0]};
  const double v[3] = {b, sign + axis[1] * axis[1] * a, -axis[1]};
  for (int k = 0; k < 3; ++k) d[k] = x * u[k] + y * v[k] + z * axis[k];
}

class VoxelGrid {
 public:
  VoxelGrid(std::span<const Vec3f> samples, double area) {
    Bounds<glm::dvec3> box;
    for (const Vec3f& p : samples) box.add(to_dvec(p));
    low_ = box.low;
    voxel_ = kVoxelSpacings * std::sqrt(area / static_cast<double>(samples.size()));
    const auto cells = [&] {
      double n = 1;
      for (int k = 0; k < 3; ++k) n *= std::floor(box.size()[k] / voxel_) + 1;
      return n;
    };
    while (cells() > kMaxVoxels) voxel_ *= 1.25;
    for (int k = 0; k < 3; ++k) size_[k] = static_cast<int>(std::floor(box.size()[k] / voxel_)) + 1;
    sort(samples);
  }

  double size(int k) const { return size_[k]; }

  // Follows a ray from `from` (in voxels) along `direction`. Returns a sample in the first
  // voxel with samples, chosen by `pick`, and sets `distance`. Returns kNoIndex if there is none.
  std::uint32_t cast(const double from[3], const double direction[3], std::uint64_t pick,
                     double& distance) const {
    distance = 0;
    int cell[3], step[3];
    double next[3], delta[3];
    for (int k = 0; k < 3; ++k) {
      cell[k] = static_cast<int>(from[k]);
      step[k] = direction[k] < 0 ? -1 : 1;
      delta[k] = direction[k] != 0 ? 1 / std::fabs(direction[k]) : 1e30;
      next[k] = delta[k] * (step[k] > 0 ? cell[k] + 1 - from[k] : from[k] - cell[k]);
    }
    for (;;) {
      const std::size_t at = index(cell);
      const std::uint32_t n = first_[at + 1] - first_[at];
      if (n > 0) return sorted_[first_[at] + pick % n];
      int k = next[0] < next[1] ? 0 : 1;
      if (next[2] < next[k]) k = 2;
      distance = next[k];
      cell[k] += step[k];
      if (cell[k] < 0 || cell[k] >= size_[k]) return kNoIndex;
      next[k] += delta[k];
    }
  }

  bool empty(const double at[3]) const {
    const int cell[3] = {static_cast<int>(at[0]), static_cast<int>(at[1]), static_cast<int>(at[2])};
    const std::size_t i = index(cell);
    return first_[i] == first_[i + 1];
  }

 private:
  std::size_t index(const int cell[3]) const {
    return (std::size_t(cell[2]) * size_[1] + cell[1]) * size_[0] + cell[0];
  }

  void sort(std::span<const Vec3f> samples) {
    std::vector<std::size_t> where(samples.size());
    for (std::size_t i = 0; i < samples.size(); ++i) {
      const glm::dvec3 p = to_dvec(samples[i]);
      int cell[3];
      for (int k = 0; k < 3; ++k)
        cell[k] = std::clamp(static_cast<int>((p[k] - low_[k]) / voxel_), 0, size_[k] - 1);
      where[i] = index(cell);
    }
    sorted_.resize(samples.size());
    first_ = counting_sort(
        samples.size(), std::size_t(size_[0]) * size_[1] * size_[2],
        [&](std::size_t i) { return where[i]; },
        [&](std::size_t i, std::uint32_t at) { sorted_[at] = std::uint32_t(i); });
  }

  glm::dvec3 low_{};
  double voxel_ = 1;
  int size_[3];
  std::vector<std::uint32_t> first_;   // index of each voxel's first sample; one more at the end
  std::vector<std::uint32_t> sorted_;  // the samples, voxel by voxel
};

struct Observer {
  double at[3] = {0, 0, 0}, gaze[3] = {0, 0, 1};  // in voxels
  double reach = -1;                              // of the longest line of sight
};

// Sets where an observer looks. Returns false for one who stands outside.
bool look_around(const VoxelGrid& grid, std::mt19937_64& random, Observer& observer) {
  int met = 0;
  for (int r = 0; r < kRays; ++r) {
    constexpr double kUp[3] = {0, 0, 1};
    double direction[3], distance;
    direction_in_cone(random, kUp, -1, direction);
    if (grid.cast(observer.at, direction, 0, distance) == kNoIndex) continue;
    ++met;
    if (distance <= observer.reach) continue;
    observer.reach = distance;
    std::copy_n(direction, 3, observer.gaze);
  }
  return met >= kNeeded;
}

}  // namespace

std::vector<std::uint32_t> seen_samples(std::span<const Vec3f> positions, double area,
                                        std::size_t needed) {
  std::vector<std::uint32_t> seen;
  if (positions.empty() || !(area > 0)) return seen;
  const VoxelGrid grid(positions, area);
  std::mt19937_64 random(1);
  std::vector<Observer> observers;
  std::vector<double> reach;
  for (int i = 0; i < kPoints; ++i) {
    if (i == kPoints / 8 && 4 * 8 * kRays * observers.size() < needed) return seen;
    Observer observer;
    for (int k = 0; k < 3; ++k) observer.at[k] = uniform(random) * grid.size(k);
    if (!grid.empty(observer.at) || !look_around(grid, random, observer)) continue;
    observers.push_back(observer);
    reach.push_back(observer.reach);
  }
  if (observers.empty()) return seen;
  const double least = percentile(reach, kShortSighted);
  for (const Observer& observer : observers) {
    if (observer.reach < least) continue;
    for (int r = 0; r < kRays; ++r) {
      double direction[3], distance;
      direction_in_cone(random, observer.gaze, kViewCosine, direction);
      const std::uint32_t hit = grid.cast(observer.at, direction, random(), distance);
      if (hit != kNoIndex) seen.push_back(hit);
    }
  }
  return seen;
}

}  // namespace atlas
