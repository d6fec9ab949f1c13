#include "benchmarks/light_leak/light_leak.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "libatlas/core/glm_bridge.h"

namespace atlas::bench {
namespace {

// Collects errors; percentiles by sorting.
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

glm::dvec3 lookup(const Image8& page, Vec2d at) {
  const double x = at.x - 0.5, y = at.y - 0.5;
  const int i = int(std::floor(x)), j = int(std::floor(y));
  const double s = x - i, t = y - j;
  glm::dvec3 sum(0);
  for (int k = 0; k < 4; ++k) {
    const int px = std::clamp(i + k % 2, 0, page.width - 1);
    const int py = std::clamp(j + k / 2, 0, page.height - 1);
    const std::uint8_t* texel = page.at(px, py);
    sum += (k % 2 ? s : 1 - s) * (k / 2 ? t : 1 - t) * glm::dvec3(texel[0], texel[1], texel[2]);
  }
  return sum / 255.0;
}

// Bakes the pages that hold charts of the object.
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

// Light and atlas at any point of a triangle.
class Surface {
 public:
  Surface(const Staged& staged, const std::vector<Image8>& pages, std::uint32_t triangle)
      : staged_(staged),
        placement_(staged.layout->placements[staged.charts->triangle_chart[triangle]]),
        page_(pages[std::size_t(placement_.page)]),
        light_(staged.sampler->prepare(triangle, 0)) {
    const Scene& scene = staged.scene();
    for (int k = 0; k < 3; ++k) {
      corner[k] = to_dvec(scene.positions[scene.indices[3 * triangle + k]]);
      uv_[k] = to_glm(staged.charts->uvs[staged.charts->triangle_uv[3 * triangle + k]]);
    }
  }

  glm::dvec3 at(glm::dvec3 b) const { return b.x * corner[0] + b.y * corner[1] + b.z * corner[2]; }
  glm::dvec3 input(glm::dvec3 b) const {
    const Vec3f v = LuminanceSampler::sample(light_, float(b.x), float(b.y), float(b.z));
    return to_dvec(staged_.tone->display(v));
  }
  glm::dvec3 baked(glm::dvec3 b) const {
    const glm::dvec2 uv = b.x * uv_[0] + b.y * uv_[1] + b.z * uv_[2];
    return lookup(page_, page_texel(placement_, from_glm(uv)));
  }
  double texel() const {
    return 1 / std::sqrt(placement_.texels_per_unit.x * placement_.texels_per_unit.y);
  }
  double area() const {
    return 0.5 * glm::length(glm::cross(corner[1] - corner[0], corner[2] - corner[0]));
  }

  std::array<glm::dvec3, 3> corner;

 private:
  const Staged& staged_;
  const ChartPlacement& placement_;
  const Image8& page_;
  LuminanceSampler::Triangle light_;
  std::array<glm::dvec2, 3> uv_;
};

// Centres of the n² equal parts of a triangle, as barycentric coordinates.
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

  // Every point stands for (nearly) the same area: parts are as many as the area asks for.
  void visit(const Surface& s, double spacing) {
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
    const Surface s(staged, pages, t);
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
  for (const std::uint32_t t : edge.triangles) probe.visit(Surface(staged, pages, t), spacing);
  leak.band = probe.in_band.summary();
  leak.fixed = probe.in_fixed.summary();
  leak.whole = probe.everywhere.summary();
  return leak;
}

}  // namespace atlas::bench
