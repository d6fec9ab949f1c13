// The range of every option of an export: its ends are taken, and what is beyond them is refused by
// name.
#include "libatlas/pipeline/export_options.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <functional>
#include <limits>
#include <string>
#include <vector>

namespace atlas::test {
namespace {

using Change = std::function<void(ExportOptions&)>;

Status check(const Change& change) {
  ExportOptions options;
  options.target = "world.gltf";
  change(options);
  return check_options(options);
}

struct Range {
  std::string field;
  std::vector<double> taken, refused;
  std::function<void(ExportOptions&, double)> set;
};

std::vector<Range> ranges() {
  constexpr double kLow = std::numeric_limits<std::int32_t>::min(),
                   kHigh = std::numeric_limits<std::int32_t>::max();
  const double nan = std::nan(""), infinity = std::numeric_limits<double>::infinity();
  using O = ExportOptions;
  return {
      {"atlases", {1, 1e6}, {0}, [](O& o, double v) { o.atlases = std::uint32_t(v); }},
      {"plain_pages", {1, 64}, {0}, [](O& o, double v) { o.plain_pages = std::uint32_t(v); }},
      {"atlas_size",
       {64, 16384},
       {kLow, -64, 0, 32, 63, 65, 96, 16383, 32768, kHigh},
       [](O& o, double v) { o.atlas_size = std::int32_t(v); }},
      {"texel_metres",
       {0, 1e-3},
       {-1e-9, nan, infinity},
       [](O& o, double v) { o.texel_metres = v; }},
      {"threshold", {0, 1}, {-0.01, 1.01, nan}, [](O& o, double v) { o.threshold = v; }},
      {"mip_levels", {0, 5}, {kLow, -1, 6, kHigh}, [](O& o, double v) { o.mip_levels = int(v); }},
      {"plain_mip_levels",
       {0, 5},
       {kLow, -1, 6, kHigh},
       [](O& o, double v) { o.plain_mip_levels = int(v); }},
      {"shifts", {1, 64}, {kLow, 0, 65, kHigh}, [](O& o, double v) { o.shifts = int(v); }},
      {"min_side",
       {1, 256},
       {kLow, -1, 0, 257, kHigh},
       [](O& o, double v) { o.min_side = int(v); }},
      {"simplify_slip",
       {1e-6, 10},
       {-1, 0, nan, infinity},
       [](O& o, double v) { o.simplify_slip = v; }},
      {"png_compression",
       {0, 9},
       {kLow, -1, 10, kHigh},
       [](O& o, double v) { o.png_compression = int(v); }},
  };
}

TEST(ExportOptions, EndsOfRangesAreTakenAndNothingBeyond) {
  EXPECT_TRUE(check([](ExportOptions&) {}).ok());
  for (const Range& range : ranges()) {
    for (const double value : range.taken) {
      const Status status = check([&](ExportOptions& o) { range.set(o, value); });
      EXPECT_TRUE(status.ok()) << value << ": " << status.message();
    }
    for (const double value : range.refused) {
      const Status status = check([&](ExportOptions& o) { range.set(o, value); });
      EXPECT_EQ(status.code(), ErrorCode::bad_option) << range.field << ' ' << value;
      EXPECT_TRUE(status.message().starts_with("ExportOptions::" + range.field + " must be"))
          << range.field << ' ' << value << ": " << status.message();
    }
  }
}

// The shortest side and its gutters must fit a page.
TEST(ExportOptions, TheShortestSideFitsAPageWithItsGutters) {
  const auto code = [](std::int32_t min_side, std::int32_t mip_levels) {
    const Status status = check([&](ExportOptions& o) {
      o.atlas_size = 64;
      o.min_side = min_side;
      o.mip_levels = mip_levels;
    });
    return status.code();
  };
  EXPECT_EQ(code(62, 0), ErrorCode::ok);
  EXPECT_EQ(code(63, 0), ErrorCode::bad_option);
  EXPECT_EQ(code(32, 5), ErrorCode::ok);  // gutters of 16 texels
  EXPECT_EQ(code(33, 5), ErrorCode::bad_option);
}

TEST(ExportOptions, AKeptSceneNeedsAFormatWithRoomForIt) {
  const auto code = [](const char* target) {
    const Status status = check([&](ExportOptions& o) {
      o.target = target;
      o.keep_scene = true;
    });
    return status.code();
  };
  EXPECT_EQ(code("w.gltf"), ErrorCode::ok);
  EXPECT_EQ(code("w.obj"), ErrorCode::ok);
  EXPECT_EQ(code("w.wrl"), ErrorCode::bad_option);
}

TEST(ExportOptions, OnlyAKeptSceneOfGltfHasSeveralSetsOfUvs) {
  const auto code = [](const char* target, int uv_set, bool keep_scene) {
    const Status status = check([&](ExportOptions& o) {
      o.target = target;
      o.uv_set = uv_set;
      o.keep_scene = keep_scene;
    });
    return status.code();
  };
  for (const int set : {0, 1, 7}) EXPECT_EQ(code("w.glb", set, true), ErrorCode::ok);
  for (const int set : {-1, 8}) EXPECT_EQ(code("w.glb", set, true), ErrorCode::bad_option);
  EXPECT_EQ(code("w.glb", 1, false), ErrorCode::bad_option);
  EXPECT_EQ(code("w.obj", 1, true), ErrorCode::bad_option);
  EXPECT_EQ(code("w.obj", 0, true), ErrorCode::ok);
}

}  // namespace
}  // namespace atlas::test
