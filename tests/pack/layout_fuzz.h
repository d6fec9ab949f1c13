// A random sequence of operations on an AtlasLayout, checked by brute force after each.
#pragma once

#include <string>
#include <vector>

#include "libatlas/pack/layout.h"
#include "tests/pack/checks.h"

namespace atlas::test {

// "" or what went wrong; the whole sequence follows from the seed.
inline std::string fuzz_layout(std::uint64_t seed) {
  Noise noise{seed * 77 + 5};
  PackOptions o;
  o.page = {noise.in(8, 24), noise.in(8, 24)};
  o.max_pages = static_cast<std::uint32_t>(noise.in(0, 3));
  o.allow_rotation = noise.in(0, 1);
  o.padding = noise.in(0, 3) / 3;
  o.border = noise.in(0, 3) / 3;
  o.alignment = noise.in(0, 4) ? 1 : 2;
  o.preset = noise.in(0, 3) ? PackPreset::fast : PackPreset::standard;
  std::vector<PinnedRect> pins;
  if (noise.in(0, 4) == 0)
    pins.push_back({0, {noise.in(0, 10), noise.in(0, 10), noise.in(0, 8), noise.in(0, 8)}});
  o.pinned = pins;
  Result<AtlasLayout> layout = AtlasLayout::create(o);
  if (!layout.ok()) return layout.status().message();
  std::vector<std::uint32_t> present;
  for (int step = noise.in(4, 14); step > 0; --step) {
    const int what = noise.in(0, 9);
    if (what < 6) {
      const Extent size{noise.in(0, 9) ? noise.in(0, 12) : 1000000000, noise.in(0, 12)};
      const Result<std::uint32_t> id = layout->insert(size);
      if (id.ok()) present.push_back(*id);
      if (!id.ok() && id.status().code() != ErrorCode::no_solution) return id.status().message();
    } else if (what < 9 && !present.empty()) {
      const std::size_t at = static_cast<std::size_t>(noise.in(0, int(present.size()) - 1));
      if (!layout->remove(present[at])) return "an item present was not removed";
      present.erase(present.begin() + static_cast<std::ptrdiff_t>(at));
    } else if (const Status s = layout->repack({}); !s.ok() && s.code() != ErrorCode::no_solution) {
      return s.message();
    }
    if (layout->size() != present.size()) return "items were lost";
    std::vector<Extent> items;
    std::vector<Placement> placements;
    for (std::uint32_t id : present) {
      items.push_back(layout->extent(id));
      placements.push_back(layout->placement(id));
    }
    const std::vector<Extent> pages(layout->page_count(), o.page);
    if (o.max_pages && pages.size() > o.max_pages) return "too many pages";
    if (std::string wrong = check_layout(items, placements, pages, o); !wrong.empty()) return wrong;
  }
  return {};
}

}  // namespace atlas::test
