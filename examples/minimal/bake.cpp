// Bakes a linear RGB colour at each vertex into one texture with gutters for mip levels. Also finds
// how large each chart's texture has to be, and how far the result is from the input. The mesh is a
// sphere that is lit from one side.
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <vector>

#include "libatlas/bake/bake.h"
#include "libatlas/bake/fidelity.h"
#include "libatlas/charts/charts.h"
#include "libatlas/image/image_io.h"
#include "libatlas/scene/check_scene.h"
#include "libatlas/texture/chart_textures.h"
#include "libatlas/unwrap/page_layout.h"

namespace {

atlas::Scene sphere() {
  constexpr unsigned kAround = 96, kRings = 48;
  atlas::Scene scene;
  for (unsigned j = 0; j <= kRings; ++j)
    for (unsigned i = 0; i < kAround; ++i) {
      const double a = 6.283185307179586 * i / kAround, b = 3.141592653589793 * j / kRings;
      const double x = std::sin(b) * std::cos(a), y = std::cos(b), z = std::sin(b) * std::sin(a);
      const float light = float(0.5 + 0.5 * x);
      scene.positions.push_back({float(x), float(y), float(z)});
      scene.illumination.push_back({light, 0.8f * light, 0.1f + 0.5f * light});
      if (j == kRings) continue;
      const unsigned p = j * kAround + i, q = j * kAround + (i + 1) % kAround;
      for (unsigned v : {p, q, q + kAround, p, q + kAround, p + kAround})
        scene.indices.push_back(v);
    }
  return scene;
}

int complain(const atlas::Status& status) {
  std::fprintf(stderr, "%s\n", status.message().c_str());
  return 1;
}

}  // namespace

int main(int argc, char** argv) {
  atlas::Scene scene = sphere();
  if (auto s = atlas::complete_scene(scene); !s.ok()) return complain(s);
  atlas::MeshView mesh;
  mesh.positions = scene.positions;
  mesh.indices = scene.indices;
  const auto charts = atlas::make_charts(mesh, {}, {});
  if (!charts.ok()) return complain(charts.status());

  // The colours are used as they are: there is nothing to be lit, and 1 is white.
  const atlas::LuminanceSampler sampler(scene, atlas::Quantity::luminance);
  const auto statistics = atlas::measure_luminance(sampler, {});
  if (!statistics.ok()) return complain(statistics.status());
  atlas::ToneOptions plain;
  plain.white = 1;
  const auto tone = atlas::make_tone_mapping(plain, *statistics);
  if (!tone.ok()) return complain(tone.status());
  const atlas::ChartLight light{sampler, *charts, *tone};

  // The texel size is 0.005 units. Textures are halved where no colour changes by more than the
  // threshold.
  atlas::TextureOptions textures;
  textures.texel = 0.005;
  textures.threshold = 4.0 / 255;
  const auto sizes = atlas::size_chart_textures(light, textures, {});
  if (!sizes.ok()) return complain(sizes.status());

  std::vector<atlas::Vec2d> densities;
  for (const atlas::ChartTexture& texture : sizes->charts)
    densities.push_back(texture.texels_per_unit);
  atlas::BakeOptions bake;
  atlas::LayoutOptions layout;
  layout.pages = 1;
  layout.page_size = 1024;
  layout.padding = atlas::gutter_pad(bake.mip_levels);
  layout.alignment = 1 << bake.mip_levels;
  const auto pages = atlas::lay_out_pages(*charts, densities, layout, {});
  if (!pages.ok()) return complain(pages.status());

  bake.page_width = pages->pages[0].width;
  bake.page_height = pages->pages[0].height;
  const auto page = atlas::bake_page(light, pages->placements, bake, {});
  if (!page.ok()) return complain(page.status());
  auto meter = atlas::FidelityMeter::make(light, pages->placements, {}, {});
  if (!meter.ok()) return complain(meter.status());
  meter->add_page(0, page->display);
  if (argc > 1)
    if (auto s = atlas::write_png(argv[1], page->display, {}); !s.ok()) return complain(s);
  std::printf("%zu charts, texels %lld -> %lld, page %d x %d, %.1f dB\n", charts->charts.size(),
              static_cast<long long>(sizes->full_texels),
              static_cast<long long>(sizes->final_texels), bake.page_width, bake.page_height,
              meter->result().psnr);
}
