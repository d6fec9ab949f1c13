#include "benchmarks/light_leak/light_leak.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "benchmarks/light_leak/baked_surface.h"
#include "benchmarks/light_leak/picture.h"

namespace atlas::bench {
namespace {

// Collects errors. Percentiles are found by sorting.
class Errors {
 public:
  void add(double error) { errors_.push_back(float(error)); }
  LeakErrors summary() {
    LeakErrors s;
    s.points = errors_.size();
    if (errors_.empty()) return s;
    std::sort(errors_.begin(), errors_.end());
    const auto at = [&](double share) {
      return double(errors_[std::size_t(share * double(errors_.size() - 1))]);
    };
    double squares = 0;
    for (const float e : errors_) squares += double(e) * e;
    s.p50 = at(0.5);
    s.p95 = at(0.95);
    s.p99 = at(0.99);
    s.maximum = errors_.back();
    s.rms = std::sqrt(squares / double(errors_.size()));
    return s;
  }

 private:
  std::vector<float> errors_;
};

// Bakes the pages that contain wanted charts.
Status bake_pages_of(Staged& staged, const std::vector<bool>& wanted, BakeMethod method,
                     std::vector<Image8>& pages) {
  const PageLayout& layout = *staged.layout;
  std::vector<std::vector<ChartPlacement>> by_page(layout.pages.size());
  std::vector<bool> needed(layout.pages.size());
  for (const ChartPlacement& p : layout.placements) {
    by_page[std::size_t(p.page)].push_back(p);
    if (wanted[p.chart]) needed[std::size_t(p.page)] = true;
  }
  pages.resize(layout.pages.size());
  for (std::size_t p = 0; p < pages.size(); ++p) {
    if (!needed[p]) continue;
    BakeOptions options;
    options.page_width = layout.pages[p].width;
    options.page_height = layout.pages[p].height;
    options.method = method;
    Result<BakedPage> baked = bake_page(staged.light(), by_page[p], options, staged.context);
    if (!baked.ok()) return baked.status();
    pages[p] = std::move(baked->display);
  }
  return {};
}

// Visits the centres of the n² equal parts of a triangle, as barycentric coordinates.
template <class Visit>
void each_part(int n, const Visit& visit) {
  for (int i = 0; i < n; ++i)
    for (int j = 0; i + j < n; ++j) {
      const double third = 1.0 / 3;
      const auto point = [&](double a, double b) {
        return glm::dvec3(1 - (a + b) / n, a / n, b / n);
      };
      visit(point(i + third, j + third));
      if (i + j + 1 < n) visit(point(i + 2 * third, j + 2 * third));
    }
}

struct Probe {
  const NearPoints& near;
  double band, fixed;  // scene units
  Errors in_band, in_fixed, everywhere;

  // Every point represents (nearly) the same area, because the number of parts depends on the area.
  void visit(const BakedSurface& s, double spacing) {
    const double squares = std::ceil(s.area() / (spacing * spacing));
    const int parts = int(std::clamp(std::round(std::sqrt(squares)), 1.0, 400.0));
    each_part(parts, [&](glm::dvec3 b) {
      const glm::dvec3 difference = glm::abs(s.input(b) - s.baked(b));
      const double error = std::max({difference.x, difference.y, difference.z});
      const double distance = near.distance(from_glm(s.at(b)));
      everywhere.add(error);
      if (distance <= band) in_band.add(error);
      if (distance <= fixed) in_fixed.add(error);
    });
  }
};

Status lay_out(Staged& staged, const LeakOptions& options) {
  staged.textures.reset();
  staged.layout.reset();
  staged.settings.texel = options.texel / staged.scene().metres_per_unit;
  staged.settings.threshold = options.threshold;
  return staged.need_layout();
}

}  // namespace

Result<Leak> measure_leak(Staged& staged, const LeakOptions& options) {
  const Scene& scene = staged.scene();
  if (!scene.lit()) return Status{ErrorCode::bad_input, staged.name + ": has no light"};
  const ShadowEdge edge = find_shadow_edge(scene, options.edge);
  if (edge.triangles.empty())
    return Status{ErrorCode::bad_input,
                  fmt::format("{}: has no object '{}'", staged.name, options.edge.object)};
  if (edge.points.empty())
    return Status{ErrorCode::bad_input,
                  fmt::format("{}: no shadow edge on '{}' (take a finer mesh)", staged.name,
                              options.edge.object)};
  if (const Status s = lay_out(staged, options); !s.ok()) return s;
  std::vector<bool> wanted(staged.charts->charts.size());
  for (const std::uint32_t t : edge.triangles) wanted[staged.charts->triangle_chart[t]] = true;
  std::vector<Image8> pages;
  if (const Status s = bake_pages_of(staged, wanted, options.method, pages); !s.ok()) return s;

  Leak leak;
  double area = 0;
  for (const std::uint32_t t : edge.triangles) {
    const BakedSurface s(staged, pages, t);
    area += s.area();
    leak.texel += s.area() * s.texel();
  }
  const double unit = scene.metres_per_unit, texel = leak.texel / area;
  leak.texel = texel * unit;
  leak.scale = staged.layout->scale;
  leak.pages = staged.layout->pages.size();
  leak.edge_length = edge.length;
  const double band = options.band_texels * texel, fixed = options.fixed_band / unit;
  const NearPoints near(edge.points, std::max(band, fixed));
  Probe probe{near, band, fixed, {}, {}, {}};
  const double spacing = options.sampling * texel;
  for (const std::uint32_t t : edge.triangles) probe.visit(BakedSurface(staged, pages, t), spacing);
  leak.band = probe.in_band.summary();
  leak.fixed = probe.in_fixed.summary();
  leak.whole = probe.everywhere.summary();
  if (options.picture > 0)
    leak.picture = draw_patch(staged, pages, edge, {options.picture / unit, options.pixels});
  return leak;
}

}  // namespace atlas::bench
