#include "libatlas/unwrap/transfer.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <utility>
#include <vector>

#include "libatlas/charts/chart_triangles.h"
#include "libatlas/core/parallel.h"
#include "libatlas/raster/coverage.h"
#include "libatlas/raster/splat_triangle.h"
#include "libatlas/raster/texel_grid.h"

namespace atlas {
namespace {

struct ValueRange {
  float low, high;
};

// What a chart's texels are made of.
struct PageValues {
  const UnwrappedAtlas& unwrapped;
  std::span<const Vec3f> values;
  Extent page;
  ValueRange bounds;
  const SampleGrid& grid;
  const std::vector<GridSplat>& splats;
};

// Texels of a page, and the lower left one of them.
struct PlacedTexels {
  int left, bottom;
  TexelGrid texels;
};

// Values over one triangle, as splat_triangle reads them.
class TriangleValues {
 public:
  TriangleValues(const TexelTriangle& p, const std::array<Lanes, 3>& corners)
      : corner_(corners), origin_(p[0]) {
    const double ax = p[1].x - p[0].x, ay = p[1].y - p[0].y;
    const double bx = p[2].x - p[0].x, by = p[2].y - p[0].y;
    const double inverse = 1 / (ax * by - ay * bx);
    const Lanes to_second = corner_[1] - corner_[0], to_third = corner_[2] - corner_[0];
    step_x_ = float(by * inverse) * to_second - float(ay * inverse) * to_third;
    step_y_ = float(ax * inverse) * to_third - float(bx * inverse) * to_second;
  }

  Lanes at(const float* b) const {
    Lanes value = b[0] * corner_[0] + b[1] * corner_[1] + b[2] * corner_[2];
    value[3] = 1;
    return value;
  }

  template <class Take>
  void row(Vec2d at, int n, const Take& take) const {
    constexpr int kStretch = 32;
    const Lanes begin =
        corner_[0] + float(at.x - origin_.x) * step_x_ + float(at.y - origin_.y) * step_y_;
    Lanes values[kStretch];
    for (int first = 0; first < n; first += kStretch) {
      const int count = std::min(kStretch, n - first);
      for (int i = 0; i < count; ++i) values[i] = begin + float(first + i) * step_x_;
      take(first, static_cast<const Lanes*>(values), count);
    }
  }

 private:
  std::array<Lanes, 3> corner_;
  Vec2d origin_;
  Lanes step_x_{}, step_y_{};
};

// The triangles of a chart on its page, with the values of their corners.
class ChartOnPage {
 public:
  ChartOnPage(const PageValues& from, std::size_t chart)
      : from_(from), mesh_(from.unwrapped.mesh(from.unwrapped.mesh_of_chart(chart))) {
    const UnwrappedMesh& all = from.unwrapped.all();
    triangles_ = triangles_of(all.charts, all.charts.charts[chart]);
    first_triangle_ = std::size_t(mesh_.indices.data() - all.indices.data()) / 3;
    first_vertex_ = std::size_t(mesh_.vertices.data() - all.vertices.data());
  }

  std::span<const std::uint32_t> triangles() const { return triangles_; }

  TexelTriangle texels(std::uint32_t triangle) const {
    TexelTriangle corners;
    for (std::size_t k = 0; k < 3; ++k) {
      const Vec2f uv = mesh_.uvs[vertex(triangle, k)];
      corners[k] = {double(uv.x) * from_.page.width, double(uv.y) * from_.page.height};
    }
    return corners;
  }

  std::array<Lanes, 3> values(std::uint32_t triangle) const {
    std::array<Lanes, 3> corners;
    for (std::size_t k = 0; k < 3; ++k) {
      const Vec3f v = from_.values[first_vertex_ + vertex(triangle, k)];
      corners[k] = Lanes{v.x, v.y, v.z, 1};
    }
    return corners;
  }

 private:
  std::uint32_t vertex(std::uint32_t triangle, std::size_t corner) const {
    return mesh_.indices[3 * (triangle - first_triangle_) + corner];
  }

  const PageValues& from_;
  UnwrappedAtlas::Mesh mesh_;
  std::span<const std::uint32_t> triangles_ = {};
  std::size_t first_triangle_ = 0, first_vertex_ = 0;
};

// Where the chart lies, with room for what bilinear lookups at its border read.
Rect texels_around(const ChartOnPage& chart) {
  constexpr double kRoom = 2;
  Vec2d low{1e9, 1e9}, high{-1e9, -1e9};
  for (const std::uint32_t t : chart.triangles())
    for (const Vec2d p : chart.texels(t)) {
      low = {std::min(low.x, p.x), std::min(low.y, p.y)};
      high = {std::max(high.x, p.x), std::max(high.y, p.y)};
    }
  const auto left = int(std::floor(low.x - kRoom)), bottom = int(std::floor(low.y - kRoom));
  return {left, bottom, int(std::ceil(high.x + kRoom)) - left,
          int(std::ceil(high.y + kRoom)) - bottom};
}

// Marks the texels that bilinear lookups from inside the triangle read: those around each square
// between four centres of texels that it shares area with.
void mark_read(TexelTriangle p, std::vector<unsigned char>& read, int width, int height) {
  for (Vec2d& corner : p) corner = {corner.x - 0.5, corner.y - 0.5};
  cover_triangle(p, {0, 0, width - 1, height - 1}, [&](int x, int y, double, Vec2d) {
    unsigned char* const at = &read[std::size_t(y) * std::size_t(width) + std::size_t(x)];
    at[0] = at[1] = at[width] = at[width + 1] = 1;
  });
}

// Makes those texels known that lookups read, and no others. Samples touch most of them; the rest
// is filled from these. If a chart is so thin that none is read, the one in the middle takes the
// mean of its first triangle.
void keep_read(const ChartOnPage& chart, std::vector<unsigned char>&& read, TexelGrid& texels) {
  const auto any = [](const std::vector<unsigned char>& set) {
    return std::find(set.begin(), set.end(), 1) != set.end();
  };
  const std::size_t middle =
      std::size_t(texels.height / 2) * std::size_t(texels.width) + std::size_t(texels.width / 2);
  if (!any(texels.known)) {
    const auto corners = chart.values(chart.triangles().front());
    texels.rgb[middle] = (corners[0] + corners[1] + corners[2]) / 3.0f;
    texels.known[middle] = 1;
  }
  if (!any(read)) read[middle] = 1;
  fill_unknown(texels);
  texels.known = std::move(read);
}

PlacedTexels fit_chart(const PageValues& from, std::size_t number) {
  const ChartOnPage chart(from, number);
  const Rect box = texels_around(chart);
  LeastSquares fit(box.width, box.height);
  std::vector<unsigned char> read(std::size_t(box.width) * std::size_t(box.height));
  for (const std::uint32_t t : chart.triangles()) {
    TexelTriangle p = chart.texels(t);
    for (Vec2d& corner : p) corner = {corner.x - box.x, corner.y - box.y};
    if (sample_kind(p, from.grid) == SampleKind::none) continue;
    mark_read(p, read, box.width, box.height);
    splat_triangle(p, TriangleValues(p, chart.values(t)), {from.grid, from.splats, fit});
  }
  PlacedTexels placed{box.x, box.y, std::move(fit).solve(from.bounds.low, from.bounds.high)};
  keep_read(chart, std::move(read), placed.texels);
  return placed;
}

void copy_known(const PlacedTexels& from, TexelGrid& page) {
  const TexelGrid& in = from.texels;
  for (int y = std::max(0, -from.bottom); y < std::min(in.height, page.height - from.bottom); ++y)
    for (int x = std::max(0, -from.left); x < std::min(in.width, page.width - from.left); ++x) {
      const std::size_t at = std::size_t(y) * in.width + x;
      const std::size_t to = std::size_t(y + from.bottom) * page.width + (x + from.left);
      if (!in.known[at] || page.known[to]) continue;
      page.rgb[to] = in.rgb[at];
      page.known[to] = 1;
    }
}

std::vector<std::size_t> charts_on(const UnwrappedMesh& all, std::uint32_t page) {
  std::vector<std::size_t> charts;
  for (const ChartPlacement& placement : all.placements)
    if (std::uint32_t(placement.page) == page) charts.push_back(placement.chart);
  std::sort(charts.begin(), charts.end());
  return charts;
}

Status check_transfer(const UnwrappedMesh& all, std::span<const Vec3f> values,
                      const TransferOptions& options) {
  if (options.page >= all.pages.size())
    return {ErrorCode::bad_option,
            fmt::format("transfer: page is {}; there are {} (counted from 0)", options.page,
                        all.pages.size())};
  if (options.shifts < 1 || options.shifts > 64)
    return {ErrorCode::bad_option, fmt::format("transfer: shifts is {} (1 to 64)", options.shifts)};
  if (values.size() != all.vertices.size())
    return {ErrorCode::bad_input,
            fmt::format("transfer: {} values, but the meshes have {} vertices in all",
                        values.size(), all.vertices.size())};
  for (std::size_t i = 0; i < values.size(); ++i)
    if (!std::isfinite(values[i].x) || !std::isfinite(values[i].y) || !std::isfinite(values[i].z))
      return {ErrorCode::bad_input, fmt::format("transfer: value {} is not finite", i)};
  return {};
}

ValueRange range_of(std::span<const Vec3f> values) {
  ValueRange bounds{values[0].x, values[0].x};
  for (const Vec3f& v : values) {
    bounds.low = std::min({bounds.low, v.x, v.y, v.z});
    bounds.high = std::max({bounds.high, v.x, v.y, v.z});
  }
  return bounds;
}

// The page of all charts. They are fitted a few at a time, since each takes memory of its own.
std::optional<TexelGrid> fit_page(const PageValues& from, std::span<const std::size_t> charts,
                                  const Context& context) {
  TexelGrid page(from.page.width, from.page.height);
  const std::size_t batch = 4 * thread_count(context);
  for (std::size_t begin = 0; begin < charts.size(); begin += batch) {
    const std::size_t count = std::min(batch, charts.size() - begin);
    std::vector<std::optional<PlacedTexels>> fitted(count);
    parallel_for(context, count, 1, [&](std::size_t first, std::size_t end) {
      for (std::size_t i = first; i < end; ++i) fitted[i] = fit_chart(from, charts[begin + i]);
    });
    if (context.cancelled()) return std::nullopt;
    for (const std::optional<PlacedTexels>& one : fitted) copy_known(*one, page);
    context.report("transfer", double(begin + count) / double(charts.size()));
  }
  fill_unknown(page);
  return page;
}

}  // namespace

Result<ImageF> transfer(const UnwrappedAtlas& unwrapped, std::span<const Vec3f> values,
                        const TransferOptions& options, const Context& context) {
  const UnwrappedMesh& all = unwrapped.all();
  if (Status s = check_transfer(all, values, options); !s.ok()) return s;
  const SampleGrid grid(options.shifts);
  const std::vector<GridSplat> splats = grid_splats(grid);
  const Extent size = all.pages[options.page];
  const PageValues from{unwrapped, values, size, range_of(values), grid, splats};
  const auto page = fit_page(from, charts_on(all, options.page), context);
  if (!page) return Status::cancelled();
  ImageF image(size.width, size.height, 3);
  for (std::size_t i = 0; i < page->rgb.size(); ++i)
    for (std::size_t k = 0; k < 3; ++k) image.texels[3 * i + k] = page->rgb[i][int(k)];
  return image;
}

}  // namespace atlas
