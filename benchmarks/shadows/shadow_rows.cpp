#include "benchmarks/shadows/shadow_rows.h"

#include <fmt/format.h>

#include <utility>

#include "libatlas/core/clock.h"
#include "libatlas/view/bench.h"
#include "libatlas/view/context.h"
#include "libatlas/view/start_camera.h"

namespace atlas::bench {
namespace {

constexpr Vec3d kUp{0, 0, 1};

Row row_of(const BenchError& error, const std::string& name, std::size_t triangles) {
  Row row;
  row.stage = "shadows";
  row.mesh = name;
  row.setting = error.method == ShadowMethod::classic
                    ? "classic"
                    : fmt::format("{}, k = {}", name_of(error.method), error.interval);
  row.triangles = row.size_in = triangles;
  row.size_out = std::uint64_t(error.interval);
  row.unit = "triangles, frames a key";
  row.preset = error.interval == 8;
  row.cpu_seconds = error.cpu_median;
  row.values = {{"mean", error.visibility.mean},
                {"wrong", error.visibility.wrong},
                {"mean_off_edges", error.visibility.mean_off_edges},
                {"ssim", error.ssim}};
  return row;
}

Camera camera_of(const ViewScene& scene, const std::optional<Look>& look) {
  Camera camera = start_camera(scene, kUp);
  if (!look) return camera;
  const Vec3d& o = scene.origin;
  camera.eye = {look->from.x - o.x, look->from.y - o.y, look->from.z - o.z};
  camera.target = {look->to.x - o.x, look->to.y - o.y, look->to.z - o.z};
  fit_planes(camera, scene.bounds);
  return camera;
}

}  // namespace

Result<std::vector<Row>> measure_shadows(const Scene& scene, const std::string& name,
                                         const ShadowRunOptions& options) {
  const Result<ViewScene> view = make_view_scene(scene, {});
  if (!view.ok()) return view.status();
  ContextOptions wanted;
  wanted.software = options.software;
  const auto gl = make_headless_context(wanted);
  if (!gl.ok()) return gl.status();
  BenchOptions bench;
  bench.render.width = options.width;
  bench.render.height = options.height;
  bench.render.map_resolution = options.map_resolution;
  bench.render.up = kUp;
  bench.camera = camera_of(*view, options.look);
  bench.shadings = {Shading::lambert};
  bench.error_intervals = options.intervals;
  bench.error_frames = options.frames;
  LightPathOptions sun;
  sun.sun = {355, 50.45, 11, kUp, {0, 1, 0}};  // low through the windows, onto the seats
  const Result<LightPath> path = LightPath::make(sun);
  if (!path.ok()) return path.status();
  Result<Renderer> renderer = Renderer::make(*view, bench.render);
  if (!renderer.ok()) return renderer.status();
  const Result<std::vector<BenchError>> errors = bench_errors(*renderer, *path, bench);
  if (!errors.ok()) return errors.status();
  std::vector<Row> rows;
  bool classic = false;  // equal for every interval
  for (const BenchError& error : *errors) {
    if (error.method == ShadowMethod::classic && std::exchange(classic, true)) continue;
    rows.push_back(row_of(error, name, view->triangle_count()));
    rows.back().memory_mib = double(peak_memory()) / (1 << 20);
  }
  return rows;
}

}  // namespace atlas::bench
