#include "libatlas/texture/sample_chart.h"

#include <algorithm>
#include <cstring>

#include "libatlas/charts/chart_triangles.h"
#include "libatlas/raster/sampling.h"
#include "libatlas/texture/triangle_light.h"

namespace atlas {
namespace {

using Texel = SampledChart::Texel;
static_assert(sizeof(Texel) == sizeof(Lanes));

// Adds a weighted sample to a texel. `rgb1` is a colour with a 1 in the 4th lane.
void add(Texel& texel, Lanes rgb1, float weight) {
  Lanes sum;
  std::memcpy(&sum, &texel, sizeof sum);
  sum += weight * rgb1;
  std::memcpy(static_cast<void*>(&texel), &sum, sizeof sum);
}

}  // namespace

void sample_chart(const ChartLight& light, std::uint32_t id, double texels_per_unit,
                  SampledChart& out) {
  const ChartSet& charts = light.charts;
  const Chart& chart = charts.charts[id];
  const TexelSize size = texel_size(chart.size, {texels_per_unit, texels_per_unit});
  out.width = size.width;
  out.height = size.height;
  out.texels.assign(std::size_t(size.width) * size.height, {});
  const Rect box{0, 0, size.width, size.height};
  const SampleGrid grid(1);
  for (const std::uint32_t t : triangles_of(charts, chart)) {
    TexelTriangle p;
    for (int k = 0; k < 3; ++k) {
      const Vec2d uv = charts.uvs[charts.triangle_uv[3 * std::size_t(t) + k]];
      p[k] = {uv.x * texels_per_unit, uv.y * texels_per_unit};
    }
    const SampleKind kind = sample_kind(p, grid);
    if (kind == SampleKind::none) continue;
    TriangleLight lit(light.sampler.prepare(t, 1 / texels_per_unit), &light.tone);
    if (kind == SampleKind::grid) lit.set_position(p);
    const auto row = [&](int, int y, int x0, int x1) {
      Texel* texels = &out.texels[std::size_t(y) * size.width + x0];
      lit.row({x0 + 0.5, y + 0.5}, x1 - x0, [&](int first, const Lanes* rgb, int count) {
        for (int j = 0; j < count; ++j) add(texels[first + j], rgb[j], 1);
      });
    };
    const auto point = [&](const float* b, float weight) {
      const double x = b[0] * p[0].x + b[1] * p[1].x + b[2] * p[2].x;
      const double y = b[0] * p[0].y + b[1] * p[1].y + b[2] * p[2].y;
      const int i0 = std::clamp(static_cast<int>(x), 0, size.width - 1);
      const int j0 = std::clamp(static_cast<int>(y), 0, size.height - 1);
      add(out.texels[std::size_t(j0) * size.width + i0], lit.at(b), weight);
    };
    sample_triangle(p, box, grid, SampleVisitor{row, point});
  }
  for (Texel& texel : out.texels)
    if (texel.weight > 0 && texel.weight != 1)
      for (float& v : texel.rgb) v /= texel.weight;
}

}  // namespace atlas
