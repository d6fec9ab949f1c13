// What people see from where they stand, compared with a room whose walls are known.
#include "libatlas/texture/visibility.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <random>
#include <vector>

namespace atlas {
namespace {

using Size = std::array<double, 3>;

double uniform(std::mt19937_64& random) {
  return static_cast<double>(random() >> 11) * 0x1p-53;
}

// Samples the walls of a room from 0 to `size` evenly.
std::vector<Vec3f> room(const Size& size, std::size_t samples, double& area) {
  std::mt19937_64 random(3);
  std::array<double, 3> pair{};
  for (int k = 0; k < 3; ++k) pair[k] = 2 * size[(k + 1) % 3] * size[(k + 2) % 3];
  area = pair[0] + pair[1] + pair[2];
  std::vector<Vec3f> out;
  for (int k = 0; k < 3; ++k) {
    for (std::size_t i = 0; i < std::size_t(double(samples) * pair[k] / area); ++i) {
      double p[3];
      for (int c = 0; c < 3; ++c) p[c] = size[c] * uniform(random);
      p[k] = i % 2 ? size[k] : 0;
      out.push_back({float(p[0]), float(p[1]), float(p[2])});
    }
  }
  return out;
}

std::array<double, 3> direction(std::mt19937_64& random) {
  const double z = 2 * uniform(random) - 1, phi = 2 * M_PI * uniform(random);
  const double s = std::sqrt(1 - z * z);
  return {s * std::cos(phi), s * std::sin(phi), z};
}

// Returns the distance at which a ray leaves the room, and sets `wall` to the pair of walls there.
double leaves(const Size& size, const Size& from, const Size& d, int& wall) {
  double nearest = 1e30;
  for (int k = 0; k < 3; ++k) {
    const double t = d[k] > 0 ? (size[k] - from[k]) / d[k] : from[k] / -d[k];
    if (t < nearest) nearest = t, wall = k;
  }
  return nearest;
}

struct Sight {
  Size from, gaze{};
  double far = -1;
};

// Returns the share of sight lines that end on the walls across x, computed by rays and planes.
// Only the half of the people who see farthest count.
double share_by_planes(const Size& size) {
  std::mt19937_64 random(11);
  std::vector<Sight> people(40000);
  int wall = 0;
  for (Sight& sight : people) {
    for (int k = 0; k < 3; ++k) sight.from[k] = size[k] * uniform(random);
    for (int r = 0; r < 16; ++r) {
      const Size d = direction(random);
      const double distance = leaves(size, sight.from, d, wall);
      if (distance > sight.far) sight.far = distance, sight.gaze = d;
    }
  }
  std::sort(people.begin(), people.end(),
            [](const Sight& a, const Sight& b) { return a.far > b.far; });
  people.resize(people.size() / 2);
  std::size_t across = 0, all = 0;
  for (const Sight& sight : people) {
    for (int r = 0; r < 4;) {
      const Size d = direction(random);
      if (d[0] * sight.gaze[0] + d[1] * sight.gaze[1] + d[2] * sight.gaze[2] < 0.64) continue;
      leaves(size, sight.from, d, wall);
      across += wall == 0;
      ++all;
      ++r;
    }
  }
  return double(across) / double(all);
}

TEST(Visibility, WhoSeesFarLooksAlongTheLongestLineOfSight) {
  for (const Size& size : {Size{16, 3, 3}, Size{4, 4, 4}, Size{2, 9, 9}}) {
    double area = 0;
    const auto samples = room(size, 1 << 17, area);
    const std::vector<std::uint32_t> seen = seen_samples(samples, area, 0);
    const auto across = std::count_if(seen.begin(), seen.end(), [&](std::uint32_t i) {
      return samples[i].x == 0 || samples[i].x == float(size[0]);
    });
    EXPECT_NEAR(double(across) / double(seen.size()), share_by_planes(size), 0.03) << size[0];
    // The walls are closed: hardly any point is mistaken for one outside, and hardly any ray passes
    // through.
    EXPECT_GT(seen.size(), 50'000u);
    EXPECT_EQ(seen_samples(samples, area, 4096), seen);
  }
}

// Two walls far from each other enclose no space, although rays meet both.
TEST(Visibility, WhoSeesLittleStandsOutside) {
  std::mt19937_64 random(5);
  std::vector<Vec3f> samples;
  for (int i = 0; i < 20000; ++i) {
    samples.push_back(
        {i % 2 ? 10.0f : 0.0f, float(3 * uniform(random)), float(3 * uniform(random))});
  }
  EXPECT_LT(seen_samples(samples, 18, 0).size(), 4096u);
  EXPECT_TRUE(seen_samples({}, 1, 0).empty());
  for (Vec3f& p : samples) p.x = 0;
  EXPECT_TRUE(seen_samples(samples, 9, 4096).empty());
  EXPECT_TRUE(seen_samples(samples, 0, 0).empty());
}

}  // namespace
}  // namespace atlas
