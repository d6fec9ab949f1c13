// Draws the picture of docs/bake.md: a wooden floor with the edge of sunlight and a narrow beam on
// it, once as the mesh holds the light and once for each baking method.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <cmath>
#include <cstdio>
#include <string>
#include <utility>
#include <vector>

#include "apps/common/options.h"
#include "apps/common/program.h"
#include "benchmarks/light_leak/baked_surface.h"
#include "benchmarks/light_leak/picture.h"
#include "libatlas/bake/fidelity.h"
#include "libatlas/image/image_io.h"

namespace {

using namespace atlas;

constexpr int kCells = 300, kTexels = 50;  // per side of one metre
constexpr int kPixels = kCells;            // side of the picture

Vec3f light_at(double x, double y) {
  // Factors for sunlight in shadow and for reflectance in joints.
  constexpr double kShadow = 0.06, kJoint = 0.12;
  const double across = x + 0.45 * y;
  const bool sun = across < 0.5 || std::fabs(across - 1.18) < 0.022;
  const bool joint = std::fabs(y - 0.42) < 0.008 || std::fabs(y - 0.91) < 0.008;
  const double rings = 0.82 + 0.18 * std::cos(48 * std::hypot(x + 0.4, y < 0.42 ? y : y - 0.6));
  const double e = (sun ? 1 : kShadow) * rings * (joint ? kJoint : 1);
  return {float(0.56 * e), float(0.31 * e), float(0.13 * e)};
}

Scene make_floor() {
  Scene scene;
  for (int j = 0; j <= kCells; ++j)
    for (int i = 0; i <= kCells; ++i) {
      const double x = double(i) / kCells, y = double(j) / kCells;
      scene.positions.push_back({float(x), float(y), 0});
      scene.illumination.push_back(light_at(x, y));
    }
  for (int j = 0; j < kCells; ++j)
    for (int i = 0; i < kCells; ++i) {
      const auto at = static_cast<std::uint32_t>(j * (kCells + 1) + i);
      const std::uint32_t above = at + kCells + 1;
      scene.indices.insert(scene.indices.end(), {at, at + 1, above + 1, at, above + 1, above});
    }
  scene.triangle_material.assign(scene.triangle_count(), 0);
  scene.triangle_object.assign(scene.triangle_count(), 0);
  scene.materials.push_back({"wood", {1, 1, 1}, -1});
  scene.object_names.push_back("floor");
  return scene;
}

// Returns the floor as one chart, whose uvs are its own coordinates.
ChartSet one_chart(const Scene& scene) {
  ChartSet set;
  Chart chart;
  chart.triangle_count = static_cast<std::uint32_t>(scene.triangle_count());
  chart.uv_count = static_cast<std::uint32_t>(scene.positions.size());
  chart.size = {1, 1};
  chart.axis = {0, 0, 1};
  set.charts.push_back(chart);
  set.triangle_chart.assign(scene.triangle_count(), 0);
  for (std::uint32_t t = 0; t < chart.triangle_count; ++t) set.chart_triangles.push_back(t);
  for (std::uint32_t v = 0; v < chart.uv_count; ++v) {
    set.uvs.push_back({scene.positions[v].x, scene.positions[v].y});
    set.uv_vertex.push_back(v);
  }
  set.triangle_uv = scene.indices;
  return set;
}

template <class Colour>
Image8 draw(const Colour& colour) {
  Image8 tile(kPixels, kPixels, 3);
  for (int y = 0; y < kPixels; ++y)
    for (int x = 0; x < kPixels; ++x) {
      const glm::dvec3 c = colour((x + 0.5) / kPixels, (y + 0.5) / kPixels);
      for (int k = 0; k < 3; ++k) tile.at(x, y)[k] = quantize8(float(c[k]));
    }
  return tile;
}

// Draws the light in the middle of each cell, half-way along the diagonal between its two
// triangles.
Image8 draw_light(const LuminanceSampler& sampler, const ToneMapping& tone) {
  return draw([&](double x, double y) {
    const int cell = int(y * kCells) * kCells + int(x * kCells);
    const auto triangle = sampler.prepare(static_cast<std::uint32_t>(2 * cell), 0);
    return to_dvec(tone.display(LuminanceSampler::sample(triangle, 0.5f, 0, 0.5f)));
  });
}

Status draw_methods(const std::string& path) {
  const Scene scene = make_floor();
  const LuminanceSampler sampler(scene, Quantity::luminance);
  const ChartSet charts = one_chart(scene);
  const ToneMapping tone;
  const ChartLight light{sampler, charts, tone};
  BakeOptions options;
  const int pad = gutter_pad(options.mip_levels);
  ChartPlacement placement;
  placement.page = 0;
  placement.x = placement.y = pad;
  placement.width = placement.height = kTexels;
  placement.texels_per_unit = {kTexels, kTexels};
  turn_in_box(placement, false);
  options.page_width = options.page_height = kTexels + 2 * pad;

  std::vector<Image8> tiles{draw_light(sampler, tone)};
  for (const auto& [method, name] : {std::pair{BakeMethod::average, "average"},
                                     std::pair{BakeMethod::least_squares, "least squares"}}) {
    options.method = method;
    const Result<BakedPage> page = bake_page(light, {&placement, 1}, options, {});
    if (!page.ok()) return page.status();
    Result<FidelityMeter> meter = FidelityMeter::make(light, {&placement, 1}, {}, {});
    if (!meter.ok()) return meter.status();
    meter->add_page(0, page->display);
    app::print(stdout, fmt::format("{}: {:.1f} dB\n", name, meter->result().psnr));
    tiles.push_back(draw([&](double x, double y) {
      return bench::lookup(page->display, page_texel(placement, {x, y}));
    }));
  }
  return write_png(path, bench::side_by_side(tiles), {9});
}

int main_of(int argc, char** argv) {
  CLI::App app(
      "Draws a sunlit floor as the mesh holds the light and as each baking method shows it.",
      "atlas-bench-bake-picture");
  std::string picture;
  app.add_option("picture", picture, "PNG file to write")->required();
  if (const int code = app::parse(app, argc, argv); code >= 0) return code;
  const Status status = draw_methods(picture);
  if (!status.ok()) app::print_error("atlas-bench-bake-picture", status.message());
  return status.ok() ? 0 : 1;
}

}  // namespace

int main(int argc, char** argv) {
  return app::run_program("atlas-bench-bake-picture", argc, argv, main_of);
}
