#include <gtest/gtest.h>

#include <cstdio>

#include "libatlas/core/clock.h"
#include "tests/simplify/checks.h"
#include "tests/simplify/expect_sound.h"

namespace atlas {
namespace {

using namespace simplify_test;

TEST(SimplifyHeavy, ThreeMillionTrianglesOfWalls) {
  const ChartedMesh mesh = box(500);
  Stopwatch watch(cpu_seconds);
  const SimplifiedMesh coarse = simplify(mesh, 3000);
  std::printf("%.2f CPU s\n", watch.lap());
  EXPECT_EQ(coarse.triangles_in, 3000000U);
  EXPECT_EQ(coarse.triangles_out, 12U);
  EXPECT_EQ(broken_triangles(mesh, coarse), 0U);
}

TEST(SimplifyHeavy, ThreeMillionTrianglesOfASphere) {
  const ChartedMesh mesh = sphere(500);
  Stopwatch watch(cpu_seconds);
  const SimplifiedMesh coarse = simplify(mesh, 500);
  const double seconds = watch.lap();
  // The memory of the whole process, including the mesh, its charts and making them.
  const double bytes = double(peak_memory()) / double(coarse.triangles_in);
  std::printf("%.2f CPU s, %.0f bytes a triangle\n", seconds, bytes);
  EXPECT_LT(bytes, 400);
  expect_sound(mesh, coarse, 500);
  EXPECT_LT(coarse.triangles_out, 30000U);
}

}  // namespace
}  // namespace atlas
