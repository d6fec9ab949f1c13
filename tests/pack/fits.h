// Fits of charts to pages that must succeed.
#pragma once

#include <gtest/gtest.h>

#include <cstdint>
#include <utility>
#include <vector>

#include "libatlas/pack/fit.h"

namespace atlas::test {

inline FitResult fit(const std::vector<FitItem>& items, const FitOptions& options) {
  Result<FitResult> r = fit_pages(items, options, {});
  EXPECT_TRUE(r.ok()) << r.status().message();
  return r.ok() ? std::move(*r) : FitResult{};
}

// A texel of padding, boxes of any size, and no restriction on their positions.
inline FitOptions tight(std::int32_t page_size) {
  FitOptions o;
  o.page_size = page_size;
  o.padding = o.alignment = 1;
  o.minimum_side = 0;
  return o;
}

}  // namespace atlas::test
