// Internal: progress of work that is done in several parts.
#pragma once

#include <algorithm>
#include <memory>
#include <string>
#include <string_view>
#include <utility>

#include "libatlas/core/context.h"

namespace atlas {

// Returns the context for a part of a stage. Whatever stage the part names, its fractions are
// reported as those of `stage`, scaled to the range from `from` to `to`. They never fall, even if
// the part tries several methods in turn.
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
