// Packs items, and expects that this succeeds and that nothing overlaps.
#pragma once

#include <gtest/gtest.h>

#include <utility>
#include <vector>

#include "tests/support/layout_checks.h"

namespace atlas::test {

inline PackResult packed(const std::vector<Extent>& items, const PackOptions& options) {
  Result<PackResult> r = pack_rects(items, options, {});
  EXPECT_TRUE(r.ok()) << r.status().message();
  if (!r.ok()) return {};
  EXPECT_EQ(check_layout(items, r->placements, r->pages, options), "");
  return std::move(*r);
}

}  // namespace atlas::test
