// Charts and packed texture coordinates for a mesh in memory: a torus here.
#include <cmath>
#include <cstdio>
#include <vector>

#include "libatlas/charts/charts.h"
#include "libatlas/pack/fit.h"

int main() {
  constexpr unsigned kAround = 48, kAcross = 24;
  constexpr double kTurn = 6.283185307179586;
  std::vector<atlas::Vec3f> positions;
  std::vector<std::uint32_t> indices;
  for (unsigned i = 0; i < kAround; ++i)
    for (unsigned j = 0; j < kAcross; ++j) {
      const double a = kTurn * i / kAround, b = kTurn * j / kAcross, r = 1 + 0.4 * std::cos(b);
      positions.push_back(
          {float(r * std::cos(a)), float(r * std::sin(a)), float(0.4 * std::sin(b))});
      const unsigned i1 = (i + 1) % kAround, j1 = (j + 1) % kAcross;
      const unsigned p = i * kAcross + j, q = i1 * kAcross + j, r1 = i1 * kAcross + j1,
                     s = i * kAcross + j1;
      for (unsigned v : {p, q, r1, p, r1, s}) indices.push_back(v);
    }

  const atlas::MeshView mesh{.positions = positions, .indices = indices};
  const auto charts = atlas::make_charts(mesh, {}, {});
  if (!charts.ok()) return std::fprintf(stderr, "%s\n", charts.status().message().c_str()), 1;

  // 200 texels per unit of length, on one page of at most 1024 x 1024.
  std::vector<atlas::FitItem> items;
  for (const atlas::Chart& chart : charts->charts)
    items.push_back({200 * chart.size.x, 200 * chart.size.y});
  atlas::FitOptions options;
  options.page_size = 1024;
  const auto layout = atlas::fit_pages(items, options, {});
  if (!layout.ok()) return std::fprintf(stderr, "%s\n", layout.status().message().c_str()), 1;

  std::printf("%zu triangles, %zu charts, stretch %.4f, page %d x %d, %.0f %% used\n",
              indices.size() / 3, charts->charts.size(), charts->distortion.stretch_l2,
              layout->pages[0].width, layout->pages[0].height, 100 * layout->utilization);
}
