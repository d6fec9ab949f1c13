// The sample cabin as a page of HTML: how much it weighs, and how it looks beside the scene.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <string>

#include "tests/support/fidelity.h"
#include "tests/support/program_output.h"
#include "tests/support/temp_folder.h"

namespace atlas::test {
namespace {

// With default options. Positions in steps of a tenth of a millimetre lose a decibel, and libwebp's
// own settings a seventh of the bytes.
TEST(PageWeight, ACabinOfAHundredThousandTrianglesIsSmallAndFaithful) {
  const TempFolder folder;
  const std::string scene = folder / "cabin.obj", page = folder / "cabin.html";
  const std::string made =
      output_of(fmt::format("'{}' -n 100000 -q -o '{}' && '{}' '{}' -o '{}' --up z -q && echo done",
                            ATLAS_MAKE_CABIN, scene, ATLAS_EXPORT, scene, page));
  ASSERT_EQ(made, "done\n");
  EXPECT_LT(std::filesystem::file_size(page), 5'000'000u);
  const auto lit = read_world(scene), world = read_world(page);
  ASSERT_TRUE(lit.ok() && world.ok());
  const Fidelity f = compare_views(*lit, *world, {});
  EXPECT_GE(f.psnr, 45.5);
  EXPECT_LE(f.miss, 5e-6);
}

}  // namespace
}  // namespace atlas::test
