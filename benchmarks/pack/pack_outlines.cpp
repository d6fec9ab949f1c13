// Packs the uv charts of OBJ files by their outlines, checks every layout independently, and prints
// one line per model. Uvs that were made for a page that is not square are rescaled to the
// proportions of the surface. A single page gets the shape that packs best, unless it has to be
// square.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <string>
#include <vector>

#include "apps/common/options.h"
#include "benchmarks/pack/command_line.h"
#include "libatlas/core/clock.h"
#include "libatlas/pack/fit.h"
#include "tests/support/atlas_measure.h"
#include "tests/support/layout_checks.h"

namespace {

using atlas::Vec2d;
using atlas::Vec3d;
using atlas::test::UvMesh;

struct Model {
  std::string name;
  std::vector<std::vector<Vec2d>> charts;  // 3 corners per triangle
};

// Gives the charts the proportions that they have on the surface: scales u by sqrt(s / t), where s
// and t are the factors with which the squared lengths of edges, s du² + t dv², come closest to
// those on the surface.
void unsqueeze(UvMesh& mesh) {
  double aa = 0, ab = 0, bb = 0, ad = 0, bd = 0;
  for (const UvMesh::Face& f : mesh.faces)
    for (std::size_t j = 0; j < 3; ++j) {
      const std::size_t to = (j + 1) % 3;
      const Vec2d p = mesh.uvs[f.uv[j]], q = mesh.uvs[f.uv[to]];
      const Vec3d x = mesh.positions[f.position[j]], y = mesh.positions[f.position[to]];
      const double a = std::pow(q.x - p.x, 2), b = std::pow(q.y - p.y, 2);
      const double d = std::pow(y.x - x.x, 2) + std::pow(y.y - x.y, 2) + std::pow(y.z - x.z, 2);
      aa += a * a;
      ab += a * b;
      bb += b * b;
      ad += a * d;
      bd += b * d;
    }
  const double s = ad * bb - bd * ab, t = bd * aa - ad * ab;
  if (!(s > 0) || !(t > 0)) return;
  for (Vec2d& uv : mesh.uvs) uv.x *= std::sqrt(s / t);
}

atlas::Result<Model> read_charts(const std::filesystem::path& path) {
  Model model{path.stem().string(), {}};
  atlas::Result<UvMesh> mesh = atlas::test::read_uv_obj(path);
  if (!mesh.ok()) return mesh.status();
  if (mesh->faces.empty())
    return atlas::Status(atlas::ErrorCode::bad_input, path.string() + ": has no uv charts");
  unsqueeze(*mesh);
  const std::vector<std::uint32_t> chart = atlas::test::charts_by_texcoord(*mesh);
  for (std::size_t f = 0; f < chart.size(); ++f) {
    if (chart[f] == model.charts.size()) model.charts.emplace_back();
    for (const std::uint32_t uv : mesh->faces[f].uv)
      model.charts[chart[f]].push_back(mesh->uvs[uv]);
  }
  return model;
}

double area_of(const std::vector<Vec2d>& c) {
  double twice = 0;
  for (std::size_t k = 0; k + 2 < c.size(); k += 3)
    twice += std::abs((c[k + 1].x - c[k].x) * (c[k + 2].y - c[k].y) -
                      (c[k + 1].y - c[k].y) * (c[k + 2].x - c[k].x));
  return twice / 2;
}

// Scales the charts so that they have the area of the pages at scale 1.
void fill_pages(Model& model, const atlas::FitOptions& o) {
  double area = 0;
  for (const auto& c : model.charts) area += area_of(c);
  const double factor = area > 0 ? o.page_size * std::sqrt(o.pages / area) : 1;
  for (auto& c : model.charts)
    for (Vec2d& p : c) p = {p.x * factor, p.y * factor};
}

int run(Model& model, atlas::FitOptions options, int repeats) {
  fill_pages(model, options);
  const atlas::test::ChartItems charts(model.charts);
  options.shapes = charts.shapes;
  atlas::Context context;
  context.threads = 1;
  const auto timed = [&](double& least) {
    const double start = atlas::cpu_seconds();
    auto fit = atlas::fit_pages(charts.items, options, context);
    least = std::min(least, atlas::cpu_seconds() - start);
    return fit;
  };
  double least = 1e300;
  auto fit = timed(least);
  for (int k = 1; k < repeats; ++k) fit = timed(least);
  if (!fit.ok()) {
    std::printf("%s: FAILED %s\n", model.name.c_str(), fit.status().message().c_str());
    return 1;
  }
  const std::string wrong = atlas::test::check_outlines(atlas::test::placed_shapes(charts, *fit),
                                                        fit->pages, options.padding);
  std::printf("%-16s charts %5zu pages %2zu of %4d x %4d utilization %.4f cpu %.3f%s%s\n",
              model.name.c_str(), charts.shapes.size(), fit->pages.size(), fit->pages[0].width,
              fit->pages[0].height, fit->utilization, least,
              wrong.empty() ? "" : " INVALID: ", wrong.c_str());
  std::fflush(stdout);
  return !wrong.empty();
}

}  // namespace

int main(int argc, char** argv) {
  atlas::FitOptions options;
  options.padding = options.alignment = 1;
  options.minimum_side = 0;
  options.power_of_two = false;
  options.free_aspect = true;
  int repeats = 1, copies = 1;
  bool join = false;
  std::vector<std::string> files;
  CLI::App app("Packs the uv charts of OBJ files by their outlines and checks every layout.",
               "atlas-bench-pack-outlines");
  app.add_option("obj", files, "meshes with uvs")->required()->check(CLI::ExistingFile);
  app.add_option("--page", options.page_size, "side of the largest page, texels")
      ->check(CLI::Range(16, 1 << 17))
      ->capture_default_str();
  app.add_option("--pages", options.pages, "at most; several are square")
      ->check(CLI::Range(1, 100'000))
      ->capture_default_str();
  app.add_option("--padding", options.padding, "on each side of a chart, texels")
      ->check(CLI::Range(0, 1 << 16))
      ->capture_default_str();
  app.add_flag("--square", options.square, "a square page");
  app.add_option("--repeat", repeats, "runs: the least CPU time counts")
      ->check(CLI::Range(1, 1000))
      ->capture_default_str();
  app.add_flag("--join", join, "the charts of all files together");
  app.add_option("--copies", copies, "of --join: of every file")
      ->check(CLI::Range(1, 1000))
      ->capture_default_str();
  atlas::bench::add_effort_options(app, options);
  if (const int code = atlas::app::parse(app, argc, argv); code >= 0) return code;
  std::vector<Model> models;
  for (const std::string& file : files) {
    atlas::Result<Model> model = read_charts(file);
    if (!model.ok()) {
      fmt::print(stderr, "atlas-bench-pack-outlines: {}\n", model.status().message());
      return 1;
    }
    models.push_back(std::move(*model));
  }
  if (options.square || options.pages > 1) {
    options.free_aspect = false;
    options.square = options.power_of_two = true;
  }
  if (join && !models.empty()) {
    Model all{"joined", {}};
    for (int k = 0; k < copies; ++k)
      for (const Model& m : models)
        all.charts.insert(all.charts.end(), m.charts.begin(), m.charts.end());
    models = {all};
  }
  int invalid = 0;
  for (Model& m : models) invalid += run(m, options, repeats);
  return invalid > 0;
}
