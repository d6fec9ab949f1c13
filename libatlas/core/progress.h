// Internal: progress of work that is done in several parts.
#pragma once

#include <algorithm>
#include <memory>
#include <string>
#include <string_view>
#include <utility>

#include "libatlas/core/context.h"

namespace atlas {

// The context of a part of a stage: whatever the part calls its fractions, they are reported as
// those of `stage` from `from` to `to`, and never fall, should the part try several ways.
inline Context part_of_stage(const Context& outer, std::string stage, double from = 0,
                             double to = 1) {
  Context part = outer;
  if (!outer.progress) return part;
  part.progress = [report = outer.progress, stage = std::move(stage), from, to,
                   last = std::make_shared<double>(-1)](std::string_view, double fraction) {
    if (!(fraction > *last)) return;
    *last = fraction;
    report(stage, from + (to - from) * std::min(1.0, fraction));
  };
  return part;
}

}  // namespace atlas
