#include "benchmarks/stability/stress.h"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <limits>

namespace atlas::bench {

using test::Shape;

TemporaryFile::TemporaryFile(const std::string& name)
    : path(std::filesystem::temp_directory_path() /
           fmt::format("atlas_stability_{}_{}", ::getpid(), name)) {}

TemporaryFile::~TemporaryFile() {
  std::error_code ignored;  // the file may never have been written
  std::filesystem::remove(path, ignored);
}

Result<ChartSet> charts_of(const Shape& shape, const ChartOptions& options,
                           const Context& context) {
  MeshView view;
  view.positions = shape.positions;
  view.indices = shape.indices;
  return make_charts(view, options, context);
}

double broken(const ChartSet& set) {
  std::uint64_t bad = set.distortion.flips;
  for (const std::uint32_t c : set.triangle_chart) bad += c >= set.charts.size();
  for (const Vec2d& uv : set.uvs) bad += !(std::isfinite(uv.x) && std::isfinite(uv.y));
  return double(bad);
}

double uv_drift(const ChartSet& set, const ChartSet& reference, double scale) {
  if (set.uvs.size() != reference.uvs.size() || set.triangle_chart != reference.triangle_chart)
    return std::numeric_limits<double>::infinity();
  double drift = 0, extent = 0;
  for (std::size_t i = 0; i < set.uvs.size(); ++i) {
    const Vec2d a = set.uvs[i], b = reference.uvs[i];
    drift = std::max({drift, std::abs(a.x / scale - b.x), std::abs(a.y / scale - b.y)});
    extent = std::max({extent, b.x, b.y});
  }
  return drift == 0 ? 0 : drift / extent;  // a point stays a point
}

std::vector<Shape> subjects(const CheckList& list) {
  Shape ball = test::noisy(test::icosphere(list.options.full ? 5 : 3), 0.02, 3);
  ball.name = "noisy sphere";
  Shape plate = test::plate_with_holes(3, list.options.full ? 8 : 2);
  plate.name = "plate with holes";
  std::vector<Shape> shapes{ball, plate};
  for (const auto& path : list.options.models) {
    const Result<LoadedScene> read = read_scene(path, {}, list.context);
    if (!read.ok()) {
      list.context.say(read.status().message());
      continue;
    }
    shapes.push_back({path.stem().string(), read->scene.positions, read->scene.indices});
  }
  return shapes;
}

Result<LoadedScene> read_moved(const Shape& shape, double offset, const Context& context) {
  const TemporaryFile temporary("offset.obj");
  {
    std::ofstream file(temporary.path);
    for (const Vec3f& p : shape.positions)
      file << fmt::format("v {:.17g} {:.17g} {:.17g}\n", p.x + offset, p.y - offset,
                          p.z + 0.5 * offset);
    for (std::size_t t = 0; t < shape.triangle_count(); ++t)
      file << fmt::format("f {} {} {}\n", shape.indices[3 * t] + 1, shape.indices[3 * t + 1] + 1,
                          shape.indices[3 * t + 2] + 1);
  }
  return read_scene(temporary.path, {}, context);
}

}  // namespace atlas::bench
