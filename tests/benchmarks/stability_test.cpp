// Runs the small cases of the stability page. None may exceed its bound.
#include <gtest/gtest.h>

#include <limits>

#include "benchmarks/stability/checks.h"
#include "tests/support/leaks.h"

namespace atlas::bench {
namespace {

void expect_all_hold(void (*check)(CheckList&), StabilityOptions options = {}) {
  const Context context;
  CheckList list(options, context);
  check(list);
  EXPECT_FALSE(list.checks.empty());
  for (const Check& c : list.checks)
    EXPECT_TRUE(c.holds()) << c.group << ", " << c.stress << ": " << c.quantity << " is " << c.value
                           << ", beyond " << c.bound << " (" << c.note << ")";
}

TEST(Stability, Degradation) {
  expect_all_hold(check_degradation);
}
TEST(Stability, Conditioning) {
  expect_all_hold(check_conditioning);
}
TEST(Stability, ScaleAndPlace) {
  expect_all_hold(check_scale_and_place);
}
TEST(Stability, BadTriangles) {
  expect_all_hold(check_bad_triangles);
}
TEST(Stability, Cones) {
  expect_all_hold(check_cones);
}
TEST(Stability, ClosedForms) {
  expect_all_hold(check_closed_forms);
}
TEST(Stability, Light) {
  expect_all_hold(check_light);
}
TEST(Stability, Downsizing) {
  expect_all_hold(check_downsizing);
}
TEST(Stability, Blend) {
  expect_all_hold(check_blend);
}
#ifdef ATLAS_BENCH_VIEW
TEST(Stability, ShadowMaps) {
  const test::IgnoreLeaks driver;
  expect_all_hold(check_shadow_maps);
}
#endif
TEST(Stability, Grouping) {
  expect_all_hold(check_grouping);
}
TEST(Stability, Packing) {
  expect_all_hold(check_packing);
}

TEST(Stability, NanNeverHolds) {
  EXPECT_FALSE((Check{"", "", "", std::numeric_limits<double>::quiet_NaN(), 1, ""}.holds()));
}

}  // namespace
}  // namespace atlas::bench
