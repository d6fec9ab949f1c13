// Tests the same properties on public models. It is skipped if they are not available.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>

#include "libatlas/scene/reader.h"
#include "tests/charts/chart_checks.h"
#include "tests/charts/invariance.h"
#include "tests/support/shared_data.h"
#include "tests/support/temp_folder.h"

namespace atlas::test {
namespace {

WideMesh read_wide(const std::filesystem::path& path) {
  const Result<LoadedScene> read = read_scene(path, {}, {});
  EXPECT_TRUE(read.ok()) << read.status().message();
  return read.ok() ? widened({path.stem().string(), read->scene.positions, read->scene.indices})
                   : WideMesh{};
}

class ModelInvariance : public ::testing::Test {
 protected:
  void SetUp() override {
    if (shared_models().empty()) GTEST_SKIP() << lacks("models");
  }
};

TEST_F(ModelInvariance, PowersOfTwoChangeNoBit) {
  for (const auto& path : shared_models()) {
    const Shape shape = narrowed(read_wide(path));
    const ChartSet reference = charts_of(shape);
    for (const int exponent : {-20, 20}) {
      const ChartSet set = charts_of(moved(shape, std::ldexp(1, exponent)));
      ASSERT_EQ(set.triangle_chart, reference.triangle_chart) << path << " 2^" << exponent;
      for (std::size_t i = 0; i < set.uvs.size(); ++i) {
        ASSERT_EQ(set.uvs[i].x, std::ldexp(reference.uvs[i].x, exponent)) << path;
        ASSERT_EQ(set.uvs[i].y, std::ldexp(reference.uvs[i].y, exponent)) << path;
      }
    }
  }
}

TEST_F(ModelInvariance, AnyUnitAndDirectionGivesTheSameCharts) {
  Comparison comparison;
  for (const auto& path : shared_models()) {
    const WideMesh mesh = read_wide(path);
    const ChartSet reference = charts_of(narrowed(mesh));
    for (const double factor : {1e-6, 0.01, 1e6}) {
      const ChartSet set = charts_of(narrowed(scaled(mesh, factor)));
      comparison.add(fmt::format("{} x {}", mesh.name, factor), set, reference, factor);
    }
    for (int i = 1; i <= 3; ++i) {
      const ChartSet set = charts_of(narrowed(turned(mesh, random_turn(i))));
      comparison.add(fmt::format("{} turn {}", mesh.name, i), set, reference, 1);
    }
  }
}

TEST_F(ModelInvariance, AnOffsetOfAMillionTimesTheSizeChangesNothing) {
  const TempFolder folder;
  Comparison comparison;
  for (const auto& path : shared_models()) {
    const WideMesh mesh = read_wide(path);
    const ChartSet reference = charts_of(narrowed(mesh));
    const double far = 1e6 * std::sqrt(reference.surface_area);
    if (!(far > 0)) continue;  // a model of one triangle without area
    std::string text;
    for (const Vec3d& p : shifted(mesh, {far, -0.7 * far, 0.31 * far}).positions) {
      text += fmt::format("v {} {} {}\n", p.x, p.y, p.z);
    }
    for (std::size_t i = 0; i < mesh.indices.size(); i += 3) {
      text += fmt::format("f {} {} {}\n", mesh.indices[i] + 1, mesh.indices[i + 1] + 1,
                          mesh.indices[i + 2] + 1);
    }
    const WideMesh moved_mesh = read_wide(folder.write("far.obj", text));
    ASSERT_EQ(moved_mesh.indices.size(), mesh.indices.size()) << path;
    comparison.add(mesh.name, charts_of(narrowed(moved_mesh)), reference, 1);
  }
}

TEST_F(ModelInvariance, SameBytesWithOneTwoAndEightThreads) {
  for (const auto& path : shared_models()) {
    const Shape shape = narrowed(read_wide(path));
    const std::string one = bytes(charts_of(shape, 1));
    EXPECT_EQ(one, bytes(charts_of(shape, 2))) << path;
    EXPECT_EQ(one, bytes(charts_of(shape, 8))) << path;
  }
}

}  // namespace
}  // namespace atlas::test
