#include "libatlas/pack/fit_result.h"

#include <fmt/format.h>

#include <algorithm>

namespace atlas::pack {

void write_outline(const OutlinePlace& at, const FitOptions& options, FitPlacement& out) {
  out.box = at.box;
  out.content_width = at.box.width - 2 * options.padding;
  out.content_height = at.box.height - 2 * options.padding;
  out.angle = at.angle;
  out.offset = at.offset;
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
  return {ErrorCode::no_solution,
          fmt::format("fit: {} charts do not fit {} pages of {} x {} even at their minimum sides "
                      "(allow more or larger pages, or a smaller minimum_side)",
                      charts, options.pages, options.page_size, options.page_size)};
}

}  // namespace atlas::pack
