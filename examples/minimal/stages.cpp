// Takes the mesh of a file through the stages of an export, one call each, and writes a picture of
// what each stage makes. A mesh without light is lit by a sky and a sun without shadows. `Stage`
// counts as the method of Barladian et al. does (docs/architecture.md).
//   stages mesh.obj folder
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include "libatlas/bake/bake.h"
#include "libatlas/bake/fidelity.h"
#include "libatlas/exporters/viewpoint.h"
#include "libatlas/exporters/world.h"
#include "libatlas/image/image_io.h"
#include "libatlas/scene/reader.h"
#include "libatlas/simplify/simplify.h"
#include "libatlas/texture/chart_textures.h"
#include "libatlas/unwrap/page_layout.h"

namespace {

using atlas::Vec2d;
using atlas::Vec3f;

constexpr int kPageSide = 1024;

// A colour for chart c: hues a golden angle apart.
Vec3f colour_of(std::uint32_t c) {
  const auto wave = [&](double shift) { return float(0.6 + 0.4 * std::cos(2.39996 * c + shift)); };
  return {wave(0), wave(2.094), wave(4.189)};
}

// Light at the vertices is what a simulation would have left there: E = sky (1 + n.up) / 2 +
// sun max(0, n.l), with the mean normal n of the triangles around the vertex.
void light_by_sky_and_sun(atlas::Scene& scene) {
  std::vector<Vec3f> normals(scene.positions.size());
  for (std::size_t i = 0; i < scene.indices.size(); i += 3) {
    const std::uint32_t* v = &scene.indices[i];
    const Vec3f a = scene.positions[v[0]], b = scene.positions[v[1]], c = scene.positions[v[2]];
    const Vec3f p{b.x - a.x, b.y - a.y, b.z - a.z}, q{c.x - a.x, c.y - a.y, c.z - a.z};
    for (int k = 0; k < 3; ++k) {
      Vec3f& n = normals[v[k]];  // the cross product is as long as twice the triangle's area
      n = {n.x + p.y * q.z - p.z * q.y, n.y + p.z * q.x - p.x * q.z, n.z + p.x * q.y - p.y * q.x};
    }
  }
  for (const Vec3f& n : normals) {
    const float length = std::max(1e-30f, std::sqrt(n.x * n.x + n.y * n.y + n.z * n.z));
    const float sky = 0.5f + 0.5f * n.y / length;
    const float sun = std::max(0.0f, (0.6f * n.x + 0.64f * n.y + 0.48f * n.z) / length);
    scene.illumination.push_back(
        {300 * sky + 900 * sun, 330 * sky + 850 * sun, 400 * sky + 700 * sun});
  }
}

// The mesh with a colour for each chart at its vertices. Show it with
//   atlas-play charts.obj --quantity colour --shading unlit
void write_charts(const atlas::Scene& scene, const atlas::ChartSet& charts,
                  const std::filesystem::path& path) {
  std::ofstream out(path);
  for (std::size_t corner = 0; corner < scene.indices.size(); ++corner) {
    const Vec3f p = scene.positions[scene.indices[corner]];
    const Vec3f c = colour_of(charts.triangle_chart[corner / 3]);
    out << "v " << p.x << ' ' << p.y << ' ' << p.z << ' ' << c.x << ' ' << c.y << ' ' << c.z
        << '\n';
  }
  for (std::size_t v = 1; v < scene.indices.size(); v += 3)
    out << "f " << v << ' ' << v + 1 << ' ' << v + 2 << '\n';
}

// The triangles as they lie on the page, in the colours of charts.obj.
void write_layout(const atlas::ChartSet& charts, const atlas::PageLayout& layout,
                  const std::filesystem::path& path) {
  std::ofstream out(path);
  const atlas::Extent page = layout.pages[0];
  out << "<svg xmlns='http://www.w3.org/2000/svg' viewBox='0 0 " << page.width << ' ' << page.height
      << "' stroke='black' stroke-width='0.3'>\n";
  for (std::size_t t = 0; t < charts.triangle_chart.size(); ++t) {
    const std::uint32_t chart = charts.triangle_chart[t];
    const Vec3f c = colour_of(chart);
    out << "<path fill='rgb(" << int(255 * c.x) << ',' << int(255 * c.y) << ',' << int(255 * c.z)
        << ")' d='";
    for (std::size_t k = 0; k < 3; ++k) {
      const Vec2d texel =
          page_texel(layout.placements[chart], charts.uvs[charts.triangle_uv[3 * t + k]]);
      out << (k == 0 ? 'M' : 'L') << texel.x << ' ' << page.height - texel.y;  // y runs downwards
    }
    out << "z'/>\n";
  }
  out << "</svg>\n";
}

// The coarse mesh with the page as its texture.
atlas::Status write_textured(const atlas::Scene& scene, const atlas::ChartSet& charts,
                             const atlas::PageLayout& layout, const atlas::SimplifiedMesh& coarse,
                             const std::filesystem::path& folder) {
  atlas::World world;
  world.origin = scene.origin;
  world.metres_per_unit = scene.metres_per_unit;
  world.positions = scene.positions;
  world.uvs.resize(charts.uvs.size());
  for (std::size_t c = 0; c < charts.charts.size(); ++c)
    for (std::uint32_t i = 0; i < charts.charts[c].uv_count; ++i) {
      const std::uint32_t uv = charts.charts[c].first_uv + i;
      const Vec2d texel = page_texel(layout.placements[c], charts.uvs[uv]);
      world.uvs[uv] = {float(texel.x / layout.pages[0].width),
                       float(texel.y / layout.pages[0].height)};
    }
  world.pages.push_back({.image = "page.png",
                         .image_source = folder / "page.png",
                         .indices = coarse.indices,
                         .uv_indices = coarse.uv_indices});
  world.viewpoint = atlas::choose_viewpoint(world.positions, coarse.indices,
                                            {.metres_per_unit = scene.metres_per_unit}, {});
  atlas::AtomicFiles files;
  const auto written = atlas::write_world(world, folder / "world.glb", files, {});
  return written.ok() ? files.commit() : written.status();
}

// Stage 5 ends: the light of the fine triangles becomes texels, whose error is measured.
atlas::Status bake_layout(const atlas::ChartLight& light, const atlas::PageLayout& layout,
                          atlas::BakeOptions bake, const std::filesystem::path& folder) {
  bake.page_width = layout.pages[0].width;
  bake.page_height = layout.pages[0].height;
  const auto page = atlas::bake_page(light, layout.placements, bake, {});
  if (!page.ok()) return page.status();
  auto meter = atlas::FidelityMeter::make(light, layout.placements, {}, {});
  if (!meter.ok()) return meter.status();
  meter->add_page(0, page->display);
  std::printf("5 baking      %llu texels, PSNR %.1f dB\n",
              static_cast<unsigned long long>(page->covered_texels), meter->result().psnr);
  return atlas::write_png(folder / "page.png", page->display, {});
}

atlas::Status run(const std::filesystem::path& mesh_file, const std::filesystem::path& folder) {
  std::filesystem::create_directories(folder);
  auto loaded = atlas::read_scene(mesh_file, {}, {});
  if (!loaded.ok()) return loaded.status();
  atlas::Scene& scene = loaded->scene;
  if (!scene.lit()) light_by_sky_and_sun(scene);

  // Stage 1: charts, each flat in units of the mesh.
  atlas::MeshView mesh;
  mesh.positions = scene.positions;
  mesh.indices = scene.indices;
  mesh.materials = scene.triangle_material;
  const auto charts = atlas::make_charts(mesh, {}, {});
  if (!charts.ok()) return charts.status();
  write_charts(scene, *charts, folder / "charts.obj");
  std::printf("1 charts      %zu triangles, %zu charts, L2 stretch %.4f\n", scene.triangle_count(),
              charts->charts.size(), charts->distortion.stretch_l2);

  // Stage 2: luminance = illuminance * reflectance, tone-mapped, and texels enough to fill the
  // page. Stage 3: textures are halved where no texel changes by more than the threshold.
  const atlas::LuminanceSampler sampler(scene, atlas::Quantity::illuminance);
  const auto statistics = atlas::measure_luminance(sampler, {});
  if (!statistics.ok()) return statistics.status();
  const auto tone = atlas::make_tone_mapping({}, *statistics);
  if (!tone.ok()) return tone.status();
  const atlas::ChartLight light{sampler, *charts, *tone};
  atlas::BakeOptions bake;
  const int pad = atlas::gutter_pad(bake.mip_levels);
  atlas::TextureOptions textures;
  textures.texel = 1 / atlas::filling_density(*charts, double(kPageSide) * kPageSide);
  textures.max_side = kPageSide - 2 * pad;
  const auto sizes = atlas::size_chart_textures(light, textures, {});
  if (!sizes.ok()) return sizes.status();
  std::printf("2 luminance   white %.4g, %lld texels of %.3g units\n", tone->white / tone->scale,
              static_cast<long long>(sizes->full_texels), textures.texel);
  std::printf("3 downsizing  %lld texels, %llu charts halved\n",
              static_cast<long long>(sizes->final_texels),
              static_cast<unsigned long long>(sizes->halved));

  // Stage 4: charts are distributed over pages (here one). Stage 5 begins: they are placed, and
  // scaled alike if they do not fit.
  std::vector<Vec2d> densities;
  for (const atlas::ChartTexture& texture : sizes->charts)
    densities.push_back(texture.texels_per_unit);
  atlas::LayoutOptions packing;
  packing.pages = 1;
  packing.page_size = kPageSide;
  packing.padding = pad;
  packing.alignment = 1 << bake.mip_levels;
  packing.outlines = true;
  const auto layout = atlas::lay_out_pages(*charts, densities, packing, {});
  if (!layout.ok()) return layout.status();
  write_layout(*charts, *layout, folder / "layout.svg");
  std::printf("4 packing     page of %d x %d, scale %.3f, %.0f %% used\n", layout->pages[0].width,
              layout->pages[0].height, layout->scale, 100 * layout->uv_utilization);

  if (auto s = bake_layout(light, *layout, bake, folder); !s.ok()) return s;

  // The light is in the page now, so that a coarser mesh shows the same.
  std::vector<double> texels_per_unit;
  for (const atlas::ChartPlacement& p : layout->placements)
    texels_per_unit.push_back(std::max(p.texels_per_unit.x, p.texels_per_unit.y));
  const auto coarse = atlas::simplify_charts({mesh, *charts, texels_per_unit}, {}, {});
  if (!coarse.ok()) return coarse.status();
  std::printf("  simplify    %llu triangles, slip %.2f texels\n",
              static_cast<unsigned long long>(coarse->triangles_out), coarse->max_slip_texels);
  return write_textured(scene, *charts, *layout, *coarse, folder);
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 3) return std::puts("usage: stages mesh.obj folder"), 2;
  const atlas::Status status = run(argv[1], argv[2]);
  if (!status.ok()) std::fprintf(stderr, "%s\n", status.message().c_str());
  return status.ok() ? 0 : 1;
}
