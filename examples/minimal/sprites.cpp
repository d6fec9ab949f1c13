// Packs sprites of many sizes onto pages of one size: onto as few pages as hold them, or onto a
// given number, for which all are scaled equally if necessary.
#include <cstdint>
#include <cstdio>
#include <vector>

#include "libatlas/pack/fit.h"
#include "libatlas/pack/pack.h"

namespace {

std::vector<atlas::Extent> sprites() {
  std::vector<atlas::Extent> sizes;
  std::uint32_t random = 1;
  for (int i = 0; i < 5000; ++i) {
    random = random * 1664525u + 1013904223u;
    sizes.push_back({8 + std::int32_t(random >> 16 & 127), 8 + std::int32_t(random >> 24 & 127)});
  }
  return sizes;
}

int complain(const atlas::Status& status) {
  std::fprintf(stderr, "%s\n", status.message().c_str());
  return 1;
}

}  // namespace

int main() {
  const std::vector<atlas::Extent> sizes = sprites();

  atlas::PackOptions options;
  options.page = {1024, 1024};
  options.padding = 2;
  options.allow_rotation = true;
  const auto packed = atlas::pack_rects(sizes, options, {});
  if (!packed.ok()) return complain(packed.status());
  // Sprites that are too large for a page are listed, which is not an error.
  for (const atlas::UnplacedItem& item : packed->unplaced)
    std::fprintf(stderr, "sprite %u does not fit\n", item.item);
  // Of sprite 0; placements are in the order of the sprites.
  const atlas::Placement& first = packed->placements[0];
  std::printf(
      "%zu sprites, %zu pages (no packing needs fewer than %u), %.1f %% used; the first on "
      "page %u at %d, %d%s\n",
      sizes.size(), packed->pages.size(), packed->page_lower_bound, 100 * packed->utilization,
      first.page, first.x, first.y, first.rotated ? ", turned" : "");

  // The same on four pages: sprites are distributed by F(A) = N and shrink until they fit.
  std::vector<atlas::FitItem> items;
  for (const atlas::Extent& size : sizes)
    items.push_back({double(size.width), double(size.height)});
  atlas::FitOptions fit;
  fit.pages = 4;
  fit.page_size = 1024;
  fit.padding = 1;
  fit.alignment = 1;
  fit.minimum_side = 1;
  const auto fitted = atlas::fit_pages(items, fit, {});
  if (!fitted.ok()) return complain(fitted.status());
  std::printf("on %zu pages at %.3f of their size, %.1f %% used\n", fitted->pages.size(),
              fitted->scale, 100 * fitted->utilization);
}
