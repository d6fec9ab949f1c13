// What atlas-export --depfile lists, which textures are decoded, and that an export ends early
// without the module for images.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>

#include "libatlas/image/image_io.h"
#include "tests/apps/atlas_export/run_export.h"

namespace atlas::test {
namespace {

constexpr const char* kTextured =
    "mtllib a b.mtl\nmtllib none.mtl\nv 0 0 0 1 1 1\nv 1 0 0 1 1 1\nv 0 1 0 2 1 1\nvt 0 0\nvt 1 0\n"
    "vt 0 1\nusemtl wood\nf 1/1 2/2 3/3\n";

TEST_F(AtlasExport, DepfileListsAllThatWasRead) {
  write("scene.obj", kTextured);
  write("a b.mtl", "newmtl wood\nmap_Kd wood.png\nnewmtl unused\nmap_Kd gone.png\n");
  write("light.txt", "1 1 1\n1 1 2\n1 2 1\n");
  ASSERT_TRUE(write_png(dir_ / "wood.png", Image8(2, 2, 3, 77), {}).ok());
  const std::string in = dir_.string() + "/";
  const RunResult r =
      run(fmt::format("{0}scene.obj -o '{0}my w.wrl' --illumination {0}light.txt "
                      "--depfile {0}w.d --report {0}r.json",
                      in));
  ASSERT_EQ(r.exit_code, 0) << r.output;
  EXPECT_EQ(slurp(dir_ / "w.d"), fmt::format("{0}my\\ w.wrl: \\\n  {0}scene.obj \\\n  {0}light.txt "
                                             "\\\n  {0}a\\ b.mtl \\\n  {0}wood.png\n",
                                             in));
  // It is no file of the world.
  const auto files = nlohmann::json::parse(slurp(dir_ / "r.json"))["files"];
  EXPECT_FALSE(files.empty());
  EXPECT_EQ(files.dump().find("w.d"), std::string::npos);
}

TEST_F(AtlasExport, DepfileIsAbsentIfTheExportFails) {
  const fs::path scene = write("box.obj", lit_box(2));
  const std::string depfile = fmt::format("--depfile {}/w.d", dir_.string());
  expect_refusal(scene, "--texel", "-q --texel 100km " + depfile);
  expect_refusal(scene, "would overwrite", "--depfile " + scene.string());
  expect_refusal(scene, "would overwrite", fmt::format("--depfile {}/world.wrl", dir_.string()));
  expect_refusal(scene, "is the name of an image",
                 fmt::format("--depfile {}/world_0.png", dir_.string()));
  expect_refusal(scene, "does not exist", fmt::format("--depfile {}/no/w.d", dir_.string()));
  write("a;b.obj", lit_box(2));
  expect_refusal(fmt::format("'{}/a;b.obj'", dir_.string()), "no dependency file can hold",
                 depfile + " -q");
}

// Luminance includes the reflectance. A file that is cut short shows whether it is decoded.
TEST_F(AtlasExport, LuminanceNeedsNoTexelButReplacesNoTexture) {
  write("scene.obj", kTextured);
  write("a b.mtl", "newmtl wood\nmap_Kd w_0.png\n");
  ASSERT_TRUE(write_png(dir_ / "whole.png", Image8(64, 64, 3, 77), {}).ok());
  const std::string cut = slurp(dir_ / "whole.png").substr(0, 60);
  write("w_0.png", cut);
  const auto exported = [&](const std::string& world, const std::string& quantity) {
    return run(
        fmt::format("{0}/scene.obj -o {0}/{1} --quantity {2}", dir_.string(), world, quantity));
  };
  EXPECT_NE(exported("v.wrl", "illuminance").output.find("textures that cannot be decoded"),
            std::string::npos);
  for (const char* quantity : {"luminance", "colour"}) {
    const RunResult r = exported("v.wrl", quantity);
    EXPECT_EQ(r.exit_code, 0) << r.output;
    EXPECT_EQ(r.output.find("textures that cannot be decoded"), std::string::npos) << r.output;
    EXPECT_NE(exported("w.wrl", quantity).output.find("would overwrite"), std::string::npos);
    EXPECT_EQ(slurp(dir_ / "w_0.png"), cut);
  }
}

// It is read for its path only.
TEST_F(AtlasExport, DepfileListsNoTextureThatLuminanceNeedsNot) {
  write("scene.obj", kTextured);
  write("a b.mtl", "newmtl wood\nmap_Kd wood.png\n");
  ASSERT_TRUE(write_png(dir_ / "wood.png", Image8(2, 2, 3, 77), {}).ok());
  for (const char* quantity : {"luminance", "colour", "illuminance"}) {
    const RunResult r = run(fmt::format(
        "{0}/scene.obj -o {0}/v.wrl --depfile {0}/v.d --quantity {1}", dir_.string(), quantity));
    ASSERT_EQ(r.exit_code, 0) << r.output;
    const std::string rule = slurp(dir_ / "v.d");
    EXPECT_NE(rule.find("b.mtl"), std::string::npos) << rule;
    EXPECT_EQ(rule.find("wood.png") != std::string::npos, std::string(quantity) == "illuminance")
        << rule;
  }
}

// Otherwise it would be noticed only when the first page is written.
TEST_F(AtlasExport, AMissingModuleIsToldBeforeTheFirstStage) {
  const fs::path scene = write("box.obj", lit_box(2));
  const fs::path program = dir_ / "copy";
  fs::copy_file(ATLAS_EXPORT, program);
  write(IMAGE_MODULE, "");  // is found first, beside the program, and cannot be loaded
  FILE* pipe = ::popen(
      fmt::format("{} {} -o {}/w.wrl --exr 2>&1", program.string(), scene.string(), dir_.string())
          .c_str(),
      "r");
  std::string output(4096, ' ');
  output.resize(std::fread(output.data(), 1, output.size(), pipe));
  if (::pclose(pipe) == 0) GTEST_SKIP() << "the library is shared, its module lies elsewhere";
  EXPECT_NE(output.find("w.wrl: image files other than PNG and JPEG need"), std::string::npos)
      << output;
  EXPECT_NE(output.find("reading "), std::string::npos) << output;
  for (const char* stage : {"exposure", "charts"})
    EXPECT_EQ(output.find(fmt::format("\n{} ", stage)), std::string::npos) << output;
  // PNG pages need no module.
  EXPECT_EQ(std::system(
                fmt::format("{} {} -q -o {}/w.obj", program.string(), scene.string(), dir_.string())
                    .c_str()),
            0);
}

}  // namespace
}  // namespace atlas::test
