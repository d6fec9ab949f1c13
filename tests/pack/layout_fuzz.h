// Random sequences of operations, inputs and options, checked by brute force.
#pragma once

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include "libatlas/pack/fit.h"
#include "libatlas/pack/layout.h"
#include "tests/support/layout_checks.h"

namespace atlas::test {

// Waking other threads takes longer than these small tasks do.
inline Context one_thread() {
  Context context;
  context.threads = 1;
  return context;
}

// Returns "" or what went wrong. The seed determines the whole sequence.
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
    } else {
      std::vector<Placement> before;
      for (const std::uint32_t id : present) before.push_back(layout->placement(id));
      const Status s = layout->repack({});
      if (!s.ok() && s.code() != ErrorCode::no_solution) return s.message();
      for (std::size_t k = 0; k < present.size(); ++k)
        if (!s.ok() && !(layout->placement(present[k]) == before[k]))
          return "a layout changed that could not be packed anew";
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

// Calls pack_rects with random options and rectangles, some of them degenerate.
inline std::string fuzz_rects(std::uint64_t seed) {
  Noise noise{seed * 91 + 3};
  PackOptions o;
  o.page = {noise.in(6, 40), noise.in(6, 40)};
  if (noise.in(0, 5) == 0) o.page.height = 0;
  if (noise.in(0, 11) == 0) o.page = {0, 0};
  o.max_pages = static_cast<std::uint32_t>(noise.in(0, 3));
  o.allow_rotation = noise.in(0, 1);
  o.padding = noise.in(0, 3) / 2;
  o.border = noise.in(0, 3) / 3;
  o.alignment = noise.in(0, 4) ? 1 : noise.in(2, 4);
  o.preset = static_cast<PackPreset>(noise.in(0, 2));
  o.effort = 20;
  o.engine = noise.in(0, 2) ? PackEngine::automatic : static_cast<PackEngine>(noise.in(1, 3));
  o.crop = noise.in(0, 1);
  o.square = noise.in(0, 3) == 0;
  if (o.square && o.page.height > 0) o.page.height = o.page.width;
  std::vector<Extent> items;
  for (int n = noise.in(0, 14); n > 0; --n)
    items.push_back({noise.in(0, 19) ? noise.in(0, 14) : 1000000000, noise.in(0, 14)});
  const Result<PackResult> r = pack_rects(items, o, one_thread());
  if (!r.ok()) return r.status().message();
  std::size_t missing = 0;
  for (const Placement& p : r->placements) missing += !p.placed();
  if (missing != r->unplaced.size()) return "the unplaced are not those without a place";
  for (const UnplacedItem& u : r->unplaced) {
    const bool huge = items[u.item].width == 1000000000 && items[u.item].height > 0;
    if (huge && o.page.area() > 0 && u.reason != UnplacedReason::too_large)
      return "an enormous item is not called too large";
    if (o.max_pages == 0 && o.page.area() > 0 && u.reason == UnplacedReason::no_room)
      return "no room on pages without number";
  }
  return check_layout(items, r->placements, r->pages, o);
}

// Calls pack_outlines with random options and checks gutters, border, cells and what is left out.
inline std::string fuzz_pack_outlines(const ChartItems& charts, Noise& noise) {
  OutlineOptions o;
  o.page = {noise.in(20, 300), noise.in(0, 4) ? noise.in(20, 300) : 0};
  o.max_pages = static_cast<std::uint32_t>(noise.in(0, 3));
  o.scale = 0.2 + 2 * noise.unit();
  o.padding = noise.in(0, 3);
  o.border = noise.in(0, 5);
  o.alignment = 1 << noise.in(0, 2);
  o.rotations = 1u << noise.in(0, 4);
  o.preset = noise.in(0, 4) ? PackPreset::standard : PackPreset::best;
  o.effort = 40;
  const Result<OutlineResult> r = pack_outlines(charts.shapes, o, one_thread());
  if (!r.ok()) return r.status().message();
  if (o.max_pages > 0 && r->pages.size() > o.max_pages) return "outlines: too many pages";
  std::vector<PlacedShape> placed;
  std::vector<std::uint32_t> left_out;
  for (std::uint32_t i = 0; i < charts.shapes.size(); ++i) {
    const OutlinePlacement& p = r->placements[i];
    if (p.page == kNoPage) {
      left_out.push_back(i);
      continue;
    }
    const double turns = p.angle / (2 * std::numbers::pi) * o.rotations;
    if (std::abs(turns - std::round(turns)) > 1e-9) return "outlines: a direction not asked for";
    if (p.box.x % o.alignment || p.box.y % o.alignment) return "outlines: a box off its cells";
    if (p.box.area() == 0) continue;  // the chart meets no cell, so it is at the corner
    const Extent page = r->pages.at(p.page);
    if (std::min(p.box.x, p.box.y) < o.border || p.box.right() > page.width - o.border ||
        p.box.top() > page.height - o.border)
      return "outlines: a box on the border";
    placed.push_back({charts.shapes[i], p.page, o.scale, p.angle, p.offset});
  }
  if (left_out != r->unplaced) return "outlines: the unplaced are not those without a page";
  return check_outlines(placed, r->pages, o.padding);
}

// Calls fit_pages on one or two pages, and pack_outlines, and checks the gutters.
inline std::string fuzz_outlines(std::uint64_t seed) {
  Noise noise{seed * 131 + 17};
  std::vector<std::vector<Vec2d>> blobs;
  for (int n = noise.in(1, 9); n > 0; --n) {
    const int corners = noise.in(3, 9);
    const double radius = noise.in(0, 9) ? 4 + 30 * noise.unit() : 0;
    blobs.push_back(blob(noise, radius, corners));
    if (noise.in(0, 9) == 0)  // without width
      for (Vec2d& p : blobs.back()) p.y = 0;
  }
  const ChartItems charts(std::move(blobs));
  FitOptions o;
  o.pages = static_cast<std::uint32_t>(noise.in(1, 4)) / 4 + 1;
  o.page_size = 256;
  o.padding = noise.in(1, 2);
  o.alignment = noise.in(0, 2) ? 1 : 4;
  o.minimum_side = 0;
  o.max_scale = noise.in(0, 3) ? 8 : 1;
  o.free_aspect = noise.in(0, 1);
  o.power_of_two = noise.in(0, 1);
  o.preset = noise.in(0, 4) ? PackPreset::standard : PackPreset::fast;
  o.shapes = charts.shapes;
  const Result<FitResult> r = fit_pages(charts.items, o, one_thread());
  if (!r.ok()) return r.status().message();
  if (!(r->scale > 0) || r->scale > o.max_scale) return "scale out of range";
  if (r->pages.size() > o.pages) return "too many pages";
  for (const Extent& page : r->pages)
    if (page.width > o.page_size || page.height > o.page_size) return "page too large";
  if (std::string wrong = check_outlines(placed_shapes(charts, *r), r->pages, o.padding);
      !wrong.empty())
    return wrong;
  return fuzz_pack_outlines(charts, noise);
}

}  // namespace atlas::test
