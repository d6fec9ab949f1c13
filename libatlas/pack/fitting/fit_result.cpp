#include "libatlas/pack/fitting/fit_result.h"

#include <fmt/format.h>

#include <algorithm>

#include "libatlas/core/counted.h"

namespace atlas::pack {

void write_outline(const OutlinePlace& at, const FitOptions& options, FitPlacement& out) {
  out.box = at.box;
  out.content_width = at.box.width - 2 * options.padding;
  out.content_height = at.box.height - 2 * options.padding;
  out.angle = at.angle;
  out.offset = at.offset;
}

void write_at_corner(const ChartOutline& outline, FitPlacement& out) {
  const Vec2d low = low_corner_of(outline);
  out.offset = {-out.scale * low.x, -out.scale * low.y};
}

FitResult result_of(const PressedPage& page, std::span<const ChartOutline> outlines,
                    const FitOptions& options) {
  FitResult result;
  result.scale = page.scale;
  result.packings = 1;
  result.layouts = page.layouts;
  Extent size{options.page_size, options.page_size};
  if (options.free_aspect) {
    size = page.page;
  } else if (!options.power_of_two) {
    size = squared(page.page, options);
  }
  result.pages = {size};
  result.placements.resize(outlines.size());
  double shapes = 0;
  for (std::size_t i = 0; i < outlines.size(); ++i) {
    FitPlacement& out = result.placements[i];
    out.scale = page.scale;
    const PressedPlace& at = page.places[i];
    if (!at.placed) {
      write_at_corner(outlines[i], out);
      continue;
    }
    write_outline({at.box, at.angle, at.offset}, options, out);
    shapes += outlines[i].area * out.scale * out.scale;
  }
  result.utilization = share_of_pages(shapes, result);
  return result;
}

void drop_empty_pages(FitResult& result) {
  constexpr std::uint32_t kEmpty = 0xffffffffu;
  std::vector<std::uint32_t> now(result.pages.size(), kEmpty);
  for (const FitPlacement& p : result.placements) now[p.page] = 0;
  std::uint32_t used = 0;
  for (std::size_t p = 0; p < now.size(); ++p) {
    if (now[p] == kEmpty) continue;
    result.pages[used] = result.pages[p];
    now[p] = used++;
  }
  result.pages.resize(used);
  for (FitPlacement& p : result.placements) p.page = now[p.page];
}

void enclose(const Rect& box, const FitOptions& options, Extent& page) {
  page.width = std::max(page.width, box.right());
  page.height = std::max(page.height, box.top());
  page = squared(page, options);
}

Extent squared(Extent page, const FitOptions& options) {
  if (options.square) page.width = page.height = std::max(page.width, page.height);
  return page;
}

double share_of_pages(double content, const FitResult& result) {
  double area = 0;
  for (const Extent& page : result.pages) area += static_cast<double>(page.area());
  return area > 0 ? content / area : 0;
}

Status no_room(std::size_t charts, const FitOptions& options) {
  return {
      ErrorCode::no_solution,
      fmt::format("fit: {} charts do not fit {} of {} x {} even at their minimum sides "
                  "(allow more or larger pages, or a smaller minimum_side or padding)",
                  charts, counted(options.pages, "page"), options.page_size, options.page_size)};
}

}  // namespace atlas::pack
