// Seams where the light jumps, in the written world.
#include <gtest/gtest.h>

#include "libatlas/pipeline/export_world.h"
#include "tests/support/lit_sheets.h"
#include "tests/support/temp_folder.h"

namespace atlas::test {
namespace {

TEST(LightSeams, KeepTheJumpSharpInTheWorld) {
  const TempFolder folder;
  const LightAt floor = [](Vec3f p) { return 0.8 + 0.1 * p.y; };
  const LightAt wall = [](Vec3f p) { return 0.2 + 0.05 * p.z; };
  const Sheets sheets = corner(16, floor, wall);
  ExportOptions options;
  options.target = folder / "w.obj";
  options.atlases = 1;
  options.atlas_size = 512;
  options.texel_metres = 0.01;
  options.tone.white = 1;
  const auto apart = export_world(sheets.loaded(), options, {}, {});
  options.split_at_light = false;
  const auto together = export_world(sheets.loaded(), options, {}, {});
  ASSERT_TRUE(apart.ok()) << apart.status().message();
  ASSERT_TRUE(together.ok()) << together.status().message();
  EXPECT_EQ(apart->charts.size(), 2u);
  EXPECT_NEAR(apart->light_seam_length, 1, 1e-6);
  EXPECT_EQ(together->charts.size(), 1u);
  EXPECT_EQ(together->light_seam_length, 0);
  EXPECT_GT(apart->fidelity.psnr, together->fidelity.psnr + 10);
  EXPECT_LT(apart->fidelity.maximum, 0.01);
}

}  // namespace
}  // namespace atlas::test
