#include "benchmarks/support/work.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <fstream>

namespace atlas::bench {
namespace {

using test::Shape;

Vec3f light_at(Vec3f p, double size) {
  const double x = p.x / size, y = p.y / size, z = p.z / size;
  const double wave = 120 + 90 * std::sin(7 * x + 1) * std::cos(5 * y) + 40 * z;
  const bool shadow = x + 0.4 * y + 0.3 * z > 0.37 && std::sin(11 * y) > 0;
  const double sun = shadow ? 0 : 400;
  return {float(wave + sun), float(wave + 0.9 * sun), float(1.1 * wave + 0.75 * sun)};
}

}  // namespace

LoadedScene lit(Shape shape) {
  LoadedScene loaded;
  Scene& scene = loaded.scene;
  float low = INFINITY, high = -INFINITY;
  for (const Vec3f& p : shape.positions) {
    low = std::min({low, p.x, p.y, p.z});
    high = std::max({high, p.x, p.y, p.z});
  }
  for (const Vec3f& p : shape.positions)
    scene.illumination.push_back(light_at(p, double(high) - low));
  scene.triangle_material.assign(shape.triangle_count(), 0);
  scene.triangle_object.assign(shape.triangle_count(), 0);
  scene.materials.push_back({"white", {0.8f, 0.8f, 0.8f}, -1});
  scene.object_names.push_back(shape.name);
  scene.positions = std::move(shape.positions);
  scene.indices = std::move(shape.indices);
  return loaded;
}

Result<LoadedScene> make_work(const std::string& name, const Context& context) {
  const auto colon = name.find(':');
  const std::string kind = name.substr(0, colon);
  const std::string rest = colon == std::string::npos ? "" : name.substr(colon + 1);
  if (kind == "file") return read_scene(rest, {}, context);
  std::uint64_t triangles = 0;
  const auto end = std::from_chars(rest.data(), rest.data() + rest.size(), triangles);
  if (end.ec != std::errc() || end.ptr != rest.data() + rest.size() || triangles < 8 ||
      triangles > 100000000)
    return Status{ErrorCode::bad_option,
                  fmt::format("{}: work is KIND:TRIANGLES, with 8 to 10^8 triangles", name)};
  if (kind == "cabin") {
#ifdef ATLAS_BENCH_CABIN
    return make_cabin(triangles, context);
#else
    return Status{ErrorCode::bad_option, "this build has no cabin (LIBATLAS_BUILD_EXAMPLES)"};
#endif
  }
  Result<Shape> shape = make_shape(kind, triangles);
  if (!shape.ok())
    return Status{
        ErrorCode::bad_option,
        fmt::format("{}: no such work (there are file:PATH, and with a number of triangles "
                    "cabin, {})",
                    kind, kShapeKinds)};
  return lit(std::move(*shape));
}

Status write_plain_obj(const Scene& scene, const std::filesystem::path& path, bool with_light) {
  std::ofstream file(path);
  std::string text;
  const auto flush = [&](std::size_t limit) {
    if (text.size() < limit) return;
    file.write(text.data(), std::streamsize(text.size()));
    text.clear();
  };
  for (std::size_t i = 0; i < scene.positions.size(); ++i) {
    const Vec3f p = scene.positions[i];
    fmt::format_to(std::back_inserter(text), "v {} {} {}", p.x, p.y, p.z);
    if (with_light && scene.lit()) {
      const Vec3f e = scene.illumination[i];
      fmt::format_to(std::back_inserter(text), " {} {} {}", e.x, e.y, e.z);
    }
    text += '\n';
    flush(1 << 20);
  }
  for (std::size_t t = 0; t < scene.triangle_count(); ++t) {
    const std::uint32_t* v = &scene.indices[3 * t];
    fmt::format_to(std::back_inserter(text), "f {} {} {}\n", v[0] + 1, v[1] + 1, v[2] + 1);
    flush(1 << 20);
  }
  flush(0);
  file.flush();
  if (file) return {};
  return {ErrorCode::io, path.string() + ": cannot be written"};
}

}  // namespace atlas::bench
