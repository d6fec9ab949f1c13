#include <gtest/gtest.h>

#include <cmath>

#include "libatlas/charts/mesh/frames.h"
#include "libatlas/core/glm_bridge.h"

namespace atlas {
namespace {

constexpr double kTolerance = 1e-6;

// Frames need only the normals of a topology.
Topology with_normals(std::vector<Vec3f> normals) {
  Topology topology;
  topology.normals = std::move(normals);
  return topology;
}

void expect_frame(const Topology& topology, std::uint32_t t, const Frames::Frame& frame) {
  const glm::dvec3 u = to_dvec(frame[0]), v = to_dvec(frame[1]), n = to_dvec(topology.normals[t]);
  EXPECT_NEAR(glm::length(u), 1, kTolerance);
  EXPECT_NEAR(glm::length(v), 1, kTolerance);
  EXPECT_NEAR(glm::dot(u, v), 0, kTolerance);
  EXPECT_NEAR(glm::dot(glm::cross(u, v), n), 1, kTolerance);
}

TEST(Frames, ASharedMapIsTurnedToEachNormal) {
  const float s = static_cast<float>(std::sqrt(0.5));
  const Topology topology = with_normals({{0, 0, 1}, {s, 0, s}, {0, -1, 0}});
  Frames frames;
  frames.resize(3);
  const std::uint32_t map = frames.add({{0, 0, 1}, {Vec3d{1, 0, 0}, Vec3d{0, 1, 0}}});
  for (std::uint32_t t = 0; t < 3; ++t) {
    frames.share(t, map);
    expect_frame(topology, t, frames.at(topology, t));
  }
  EXPECT_EQ(frames.at(topology, 0), (Frames::Frame{Vec3f{1, 0, 0}, Vec3f{0, 1, 0}}));
  // The rotation is about the y axis, which stays.
  EXPECT_NEAR(frames.at(topology, 1)[1].y, 1, kTolerance);
}

TEST(Frames, TowardsTheOppositeNormalAMapIsNotTurned) {
  const Topology topology = with_normals({{0, 0, -1}, {0, 0.001f, -0.9999995f}});
  Frames frames;
  frames.resize(2);
  const std::uint32_t map = frames.add({{0, 0, 1}, {Vec3d{1, 0, 0}, Vec3d{0, 1, 0}}});
  for (std::uint32_t t = 0; t < 2; ++t) {
    frames.share(t, map);
    EXPECT_EQ(frames.at(topology, t), (Frames::Frame{Vec3f{1, 0, 0}, Vec3f{0, 1, 0}}));
  }
}

TEST(Frames, TrianglesMayHaveMapsOfTheirOwn) {
  const Topology topology = with_normals({{0, 0, 1}, {0, 0, 1}, {0, 0, 1}});
  const Frames::Frame turned = {Vec3f{0, 1, 0}, Vec3f{-1, 0, 0}};
  const Frames::Frame back = {Vec3f{-1, 0, 0}, Vec3f{0, -1, 0}};
  Frames frames;
  EXPECT_TRUE(frames.empty());
  frames.resize(3);
  frames.share(1, frames.add({{0, 0, 1}, {Vec3d{1, 0, 0}, Vec3d{0, 1, 0}}}));
  frames.put(0, turned);
  frames.put(1, turned);
  EXPECT_EQ(frames.at(topology, 0), turned);
  EXPECT_EQ(frames.at(topology, 1), turned);
  frames.put(1, back);
  EXPECT_EQ(frames.at(topology, 0), turned);
  EXPECT_EQ(frames.at(topology, 1), back);
  EXPECT_EQ(frames.at(topology, 2), Frames::Frame{});  // none was set
}

}  // namespace
}  // namespace atlas
