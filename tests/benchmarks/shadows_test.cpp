// Runs the benchmark of the shadow methods on a small scene, if OpenGL is available.
#include <gtest/gtest.h>

#include "benchmarks/shadows/shadow_rows.h"
#include "benchmarks/support/work.h"
#include "tests/support/leaks.h"

namespace atlas::bench {
namespace {

TEST(Shadows, GiveErrorsAndTimes) {
  const test::IgnoreLeaks driver;
  const Result<LoadedScene> scene = make_work("assembly:3000", {});
  ASSERT_TRUE(scene.ok());
  ShadowRunOptions options;
  options.width = 64;
  options.height = 40;
  options.map_resolution = 256;
  options.intervals = {4, 8};
  options.frames = 2;
  const Result<std::vector<Row>> rows = measure_shadows(scene->scene, "assembly:3000", options);
  if (!rows.ok() && rows.status().code() == ErrorCode::unsupported)
    GTEST_SKIP() << rows.status().message();
  ASSERT_TRUE(rows.ok()) << rows.status().message();
  std::size_t classic = 0;
  for (const Row& row : *rows) {
    EXPECT_GT(row.cpu_seconds, 0) << row.key();
    ASSERT_FALSE(row.values.empty());
    EXPECT_EQ(row.values[0].first, "mean");
    EXPECT_GE(row.values[0].second, 0);
    EXPECT_LT(row.values[0].second, 0.5) << row.key();
    if (row.setting != "classic") continue;
    ++classic;
    EXPECT_EQ(row.values[0].second, 0) << "the reference itself";
  }
  EXPECT_LE(classic, 1u);
  EXPECT_GE(rows->size(), 8u);
}

}  // namespace
}  // namespace atlas::bench
