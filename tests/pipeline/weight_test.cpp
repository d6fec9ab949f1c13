// Exports with images of WebP and packed meshes.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <string>
#include <vector>

#include "libatlas/files/file_extension.h"
#include "libatlas/pipeline/export_world.h"
#include "libatlas/scene/reader.h"
#include "tests/pipeline/lit_scene.h"
#include "tests/support/program_output.h"
#include "tests/support/temp_folder.h"

namespace atlas::test {
namespace {

namespace fs = std::filesystem;

ExportOptions small(const fs::path& target) {
  ExportOptions options;
  options.target = target;
  options.atlases = 1;
  options.atlas_size = 512;
  options.packing = PackPreset::fast;
  options.up = Up::z;
  return options;
}

ExportReport exported(const ExportOptions& options) {
  const auto report = export_world(lit_room(10), options, {}, {});
  EXPECT_TRUE(report.ok()) << report.status().message();
  return *report;
}

Image8 page_of(const fs::path& world) {
  const auto loaded = read_scene(world, {}, {});
  EXPECT_TRUE(loaded.ok()) << loaded.status().message();
  EXPECT_TRUE(loaded->defects.empty()) << loaded->defects.lines().front();
  EXPECT_EQ(loaded->scene.textures.size(), 1u);
  return loaded->scene.textures.at(0).image;
}

TEST(Weight, LosslessWebpHoldsThePage) {
  const TempFolder folder;
  for (const char* ending : {".glb", ".gltf"}) {
    ExportOptions options = small(folder / (std::string("png") + ending));
    const ExportReport png = exported(options);
    EXPECT_FALSE(png.pages[0].compression_psnr);
    options.target = folder / (std::string("webp") + ending);
    options.texture_format = TextureFormat::webp;
    const ExportReport webp = exported(options);
    EXPECT_FALSE(webp.pages[0].compression_psnr);
    EXPECT_EQ(webp.fidelity.psnr, png.fidelity.psnr);
    EXPECT_LT(webp.pages[0].image_bytes, png.pages[0].image_bytes);
    EXPECT_EQ(page_of(folder / (std::string("webp") + ending)).texels,
              page_of(folder / (std::string("png") + ending)).texels);
  }
}

TEST(Weight, TheReportSaysWhatLossyWebpCosts) {
  const TempFolder folder;
  ExportOptions options = small(folder / "png.glb");
  const ExportReport lossless = exported(options);
  const Image8 page = page_of(options.target);
  options.target = folder / "webp.glb";
  options.texture_format = TextureFormat::webp;
  options.webp_quality = 60;
  const ExportReport lossy = exported(options);
  const Image8 shown = page_of(options.target);
  double sum = 0;
  for (std::size_t i = 0; i < page.texels.size(); ++i)
    sum += std::pow(double(page.texels[i]) - shown.texels[i], 2);
  const double psnr = 10 * std::log10(255.0 * 255.0 * double(page.texels.size()) / sum);
  ASSERT_TRUE(lossy.pages[0].compression_psnr);
  EXPECT_NEAR(*lossy.pages[0].compression_psnr, psnr, 0.01);
  // The error is that of what the file shows.
  EXPECT_LT(lossy.fidelity.psnr, lossless.fidelity.psnr);
  EXPECT_LT(lossy.pages[0].image_bytes, lossless.pages[0].image_bytes / 4);
}

TEST(Weight, BytesDoNotDependOnThreads) {
  const TempFolder folder;
  ExportOptions options = small(folder / "a.glb");
  options.texture_format = TextureFormat::webp;
  options.compress = true;
  std::string first;
  for (const int threads : {1, 3}) {
    Context context;
    context.threads = threads;
    ASSERT_TRUE(export_world(lit_room(10), options, {}, context).ok());
    const std::string bytes = TempFolder::read(options.target);
    if (first.empty()) first = bytes;
    EXPECT_TRUE(bytes == first) << threads;
  }
}

TEST(Weight, AKeptScenesLightmapIsReadAgain) {
  const TempFolder folder;
  const LoadedScene room = lit_room(10);
  std::vector<Vec3f> light[2];
  for (const bool packed : {false, true}) {
    ExportOptions options = small(folder / (packed ? "packed.glb" : "plain.glb"));
    options.keep_scene = true;
    options.up = Up::y;
    options.compress = packed;
    if (packed) options.texture_format = TextureFormat::webp;
    ASSERT_TRUE(export_world(room, options, {}, {}).ok());
    EXPECT_TRUE(fs::exists(folder / (packed ? "packed_0.webp" : "plain_0.png")));
    const auto again = read_scene(options.target, {.lightmap = true}, {});
    ASSERT_TRUE(again.ok()) << again.status().message();
    ASSERT_TRUE(again->scene.lightmap);
    light[packed] = std::vector<Vec3f>(again->scene.positions);
    const ImageF& page = again->scene.lightmap->pages.at(0);
    EXPECT_EQ(page.width, 256);
  }
  // Positions are not rounded: a kept scene stays as it is.
  EXPECT_EQ(light[0], light[1]);
}

TEST(Weight, OtherFormatsAreRefused) {
  for (const char* name : {"a.wrl", "a.wrz", "a.obj"}) {
    ExportOptions options;
    options.target = name;
    options.compress = true;
    EXPECT_EQ(check_options(options).code(), ErrorCode::bad_option) << name;
    options.compress = false;
    options.texture_format = TextureFormat::webp;
    EXPECT_EQ(check_options(options).code(), ErrorCode::bad_option) << name;
  }
  ExportOptions options;
  options.target = "a.glb";
  options.webp_quality = 80;
  EXPECT_EQ(check_options(options).code(), ErrorCode::bad_option) << "PNG has no quality";
  options.texture_format = TextureFormat::webp;
  EXPECT_TRUE(check_options(options).ok());
  options.atlas_size = 16384;
  EXPECT_EQ(check_options(options).code(), ErrorCode::bad_option);
}

// Installs Khronos' validator as its lock file says, once for all tests. Returns how to run it, or
// why it cannot be run.
std::string validator(std::string& why_not) {
  const fs::path here = fs::path(LIBATLAS_TEST_VALIDATOR) / "installed";
  if (output_of("node --version") == "") {
    why_not = "there is no node to run gltf-validator";
    return {};
  }
  if (!fs::exists(here / "node_modules" / "gltf-validator")) {
    fs::create_directories(here);
    for (const char* file : {"package.json", "package-lock.json", "validate.cjs"})
      fs::copy_file(fs::path(LIBATLAS_TEST_VALIDATOR_SOURCE) / file, here / file,
                    fs::copy_options::overwrite_existing);
    const std::string install =
        fmt::format("cd '{}' && npm ci --ignore-scripts >npm.log 2>&1 && echo done", here.string());
    if (output_of(install).empty()) {
      why_not = "npm cannot install gltf-validator (see " + (here / "npm.log").string() + ")";
      return {};
    }
  }
  return fmt::format("node '{}'", (here / "validate.cjs").string());
}

TEST(Weight, KhronosValidatorFindsNoErrorAndNoWarning) {
  std::string why_not;
  const std::string run = validator(why_not);
  if (run.empty()) GTEST_SKIP() << why_not;
  const TempFolder folder;
  for (const char* ending : {".glb", ".gltf"})
    for (const TextureFormat format : {TextureFormat::png, TextureFormat::webp})
      for (const bool compress : {false, true})
        for (const bool keep : {false, true}) {
          const std::string name =
              fmt::format("w{}{}{}", page_extension(format) + 1, compress, keep);
          ExportOptions options = small(folder / (name + ending));
          options.texture_format = format;
          options.compress = compress;
          options.keep_scene = keep;
          ASSERT_TRUE(export_world(lit_room(6), options, {}, {}).ok());
          EXPECT_EQ(output_of(fmt::format("{} '{}'", run, options.target.string())),
                    options.target.string() + ": valid\n");
        }
}

}  // namespace
}  // namespace atlas::test
