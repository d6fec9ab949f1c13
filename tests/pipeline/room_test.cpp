// The test room of LIBATLAS_DATA, exported as a user would and measured by the independent
// evaluator.
#include <gtest/gtest.h>

#include <filesystem>

#include "libatlas/pipeline/export_world.h"
#include "tests/support/fidelity.h"
#include "tests/support/shared_data.h"
#include "tests/support/temp_folder.h"

namespace atlas::test {
namespace {

namespace fs = std::filesystem;

class Room : public ::testing::Test {
 protected:
  void SetUp() override {
    const auto data = shared_data("room");
    if (!data) GTEST_SKIP() << lacks("room");
    path_ = *data / "scene.obj";
    auto scene = read_scene(path_, {}, {});
    ASSERT_TRUE(scene.ok()) << scene.status().message();
    scene_ = std::move(*scene);
  }

  // Uses the defaults: eight pages of 2048² and linear tone mapping.
  Fidelity judge(const TempFolder& folder, bool simplify) const {
    ExportOptions options;
    options.target = folder / (simplify ? "coarse.wrl" : "fine.wrl");
    options.simplify = simplify;
    options.up = Up::z;
    const auto report = export_world(scene_, options, {}, {});
    EXPECT_TRUE(report.ok()) << report.status().message();
    EXPECT_LE(report->pages.size(), 8u);
    EXPECT_EQ(report->distortion.flips, 0u);
    const auto lit = read_world(path_), world = read_world(options.target);
    EXPECT_TRUE(lit.ok() && world.ok());
    return compare_views(*lit, *world, {});
  }

  fs::path path_;
  LoadedScene scene_;
};

TEST_F(Room, LooksLikeTheSceneAndTheCoarserMeshToo) {
  const TempFolder folder;
  const Fidelity fine = judge(folder, false), coarse = judge(folder, true);
  EXPECT_GE(fine.psnr, 50);
  EXPECT_GE(coarse.psnr, fine.psnr - 2);
  EXPECT_LE(coarse.triangles_out, 120000u);
  for (const Fidelity& f : {fine, coarse}) {
    // The hot spot over the lamp burns out, so the 99th percentile of what is seen is beyond white.
    EXPECT_GE(f.white, 0.8);
    EXPECT_LE(f.white, 3);
    // Rays that pass between two triangles of either mesh; there is no crack.
    EXPECT_LE(f.miss, 5e-6);
  }
}

}  // namespace
}  // namespace atlas::test
