#include "libatlas/pipeline/report_pictures.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <string_view>
#include <utility>
#include <vector>

#include "libatlas/core/parallel.h"
#include "libatlas/image/image_io.h"
#include "libatlas/raster/scan.h"
#include "libatlas/scene/files/file_bytes.h"

namespace atlas {
namespace {

constexpr int kThumbnailSide = 512;  // at most
constexpr int kWorstSide = 48;       // texels around a worst place

// Halves an image by averages until its longer side is at most kThumbnailSide.
Image8 thumbnail(Image8 image) {
  while (std::max(image.width, image.height) > kThumbnailSide) {
    Image8 half(std::max(1, image.width / 2), std::max(1, image.height / 2), image.channels);
    for (int y = 0; y < half.height; ++y)
      for (int x = 0; x < half.width; ++x)
        for (int k = 0; k < image.channels; ++k) {
          int sum = 2;
          for (const int dy : {0, 1})
            for (const int dx : {0, 1})
              sum += image.at(std::min(2 * x + dx, image.width - 1),
                              std::min(2 * y + dy, image.height - 1))[k];
          half.at(x, y)[k] = std::uint8_t(sum / 4);
        }
    image = std::move(half);
  }
  return image;
}

Extent thumbnail_size(Extent page) {
  while (std::max(page.width, page.height) > kThumbnailSide)
    page = {std::max(1, page.width / 2), std::max(1, page.height / 2)};
  return page;
}

// Returns the texels around a place; beyond the page, its border goes on.
Image8 around(const Image8& page, Vec2f texel) {
  Image8 out(kWorstSide, kWorstSide, 3);
  const int x0 = int(std::floor(texel.x)) - kWorstSide / 2,
            y0 = int(std::floor(texel.y)) - kWorstSide / 2;
  for (int y = 0; y < kWorstSide; ++y)
    for (int x = 0; x < kWorstSide; ++x)
      std::copy_n(
          page.at(std::clamp(x0 + x, 0, page.width - 1), std::clamp(y0 + y, 0, page.height - 1)), 3,
          out.at(x, y));
  return out;
}

// Returns for each page the chart at each pixel: its number plus 1 as a colour, 0 without a chart.
std::vector<Image8> chart_maps(const ChartSet& charts, const PageLayout& layout) {
  std::vector<Image8> maps;
  for (const Extent& page : layout.pages) {
    const Extent size = thumbnail_size(page);
    maps.emplace_back(size.width, size.height, 3);
  }
  for (const ChartPlacement& placement : layout.placements) {
    const auto page = std::size_t(placement.page);
    Image8& map = maps[page];
    const double sx = double(map.width) / layout.pages[page].width,
                 sy = double(map.height) / layout.pages[page].height;
    const std::uint32_t colour = placement.chart + 1;
    const Chart& chart = charts.charts[placement.chart];
    for (std::uint32_t i = 0; i < chart.triangle_count; ++i) {
      const std::size_t t = charts.chart_triangles[chart.first_triangle + i];
      TexelTriangle corners;
      for (std::size_t k = 0; k < 3; ++k) {
        const Vec2d at = page_texel(placement, charts.uvs[charts.triangle_uv[3 * t + k]]);
        corners[k] = {sx * at.x, sy * at.y};
      }
      scan_triangle(corners, {0, 0, map.width, map.height}, {0.5, 0.5}, [&](int y, int x0, int x1) {
        for (int x = x0; x < x1; ++x)
          for (int k = 0; k < 3; ++k) map.at(x, y)[k] = std::uint8_t(colour >> (16 - 8 * k));
      });
    }
  }
  return maps;
}

}  // namespace

Result<ReportPictures> report_pictures(const PagesToShow& pages, const Context& context) {
  ReportPictures out;
  out.worst.resize(pages.worst.size());
  for (Image8& map : chart_maps(pages.charts, pages.layout))
    out.pages.push_back({{}, std::move(map)});
  for (std::size_t p = 0; p < pages.images.size(); ++p) {
    if (context.cancelled()) return Status::cancelled();
    const auto bytes = read_file_bytes(pages.images[p]);
    if (!bytes.ok()) return bytes.status();
    const std::string_view text = bytes->text();
    auto image = decode_image8({reinterpret_cast<const std::uint8_t*>(text.data()), text.size()},
                               pages.images[p].string());
    if (!image.ok()) return image.status();
    for (std::size_t i = 0; i < pages.worst.size(); ++i)
      if (std::size_t(pages.worst[i].page) == p)
        out.worst[i] = around(*image, pages.worst[i].texel);
    out.pages[p].thumbnail = thumbnail(std::move(*image));
  }
  return out;
}

}  // namespace atlas
