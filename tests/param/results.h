// Internal: charts flattened for tests.
#pragma once

#include <gtest/gtest.h>

#include <cmath>
#include <span>
#include <utility>

#include "libatlas/param/descent/flatten_disc.h"
#include "tests/param/shapes.h"

namespace atlas::testing {

inline ParamResult run(const Disc& d, const ParamOptions& options = {}) {
  ParamWorkspace workspace;
  Result<ParamResult> made = parameterize(d.view(), options, workspace);
  EXPECT_TRUE(made.ok()) << made.status().message();
  return made.ok() ? std::move(*made) : ParamResult{};
}

inline ParamResult run_with(const Disc& d, const param::FlattenOptions& options) {
  ParamWorkspace workspace;
  return param::flatten_disc(d.view(), options, workspace);
}

inline ParamResult resumed(const Disc& d, std::span<const Vec2d> uvs,
                           const param::FlattenOptions& options = {}) {
  ParamWorkspace workspace;
  return param::resume_flattening(d.view(), uvs, options, workspace);
}

inline ParamResult joined(const Disc& d, const param::FlatParts& parts,
                          const param::FlattenOptions& options = {}) {
  ParamWorkspace workspace;
  return param::join_flat_parts(d.view(), parts, options, workspace);
}

// Expects what must hold for every result, whatever the input.
inline void expect_consistent(const Disc& d, const ParamResult& r, double max_stretch) {
  ASSERT_EQ(r.uvs.size(), d.positions.size());
  for (const Vec2d p : r.uvs) ASSERT_TRUE(std::isfinite(p.x) && std::isfinite(p.y));
  const Distortion m = measure_distortion(d.view(), r.uvs);
  EXPECT_NEAR(m.stretch_999, r.distortion.stretch_999, 1e-4 * m.stretch_999);
  EXPECT_EQ(r.within_bound,
            r.distortion.stretch_999 <= max_stretch && r.distortion.stretch_l2 <= max_stretch);
  if (m.surface_area > 0) {
    EXPECT_NEAR(m.uv_area, m.surface_area, 1e-6 * m.surface_area);
  }
  EXPECT_EQ(check_injectivity(d.view(), r.uvs).injective, r.injective);
  EXPECT_TRUE(!r.injective || m.flips == 0);
  EXPECT_EQ(r.offenders.empty(), r.injective && r.within_bound);
}

}  // namespace atlas::testing
