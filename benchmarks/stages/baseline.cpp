// The physical limit for comparison: only reads the mesh and computes its normals.
#include <fmt/format.h>
#include <unistd.h>

#include <filesystem>

#include "benchmarks/support/staged.h"
#include "libatlas/core/glm_bridge.h"

namespace atlas::bench {
namespace {

double sum_of_normals(const Scene& scene) {
  std::vector<glm::dvec3> normals(scene.positions.size(), glm::dvec3(0));
  for (std::size_t t = 0; t < scene.triangle_count(); ++t) {
    const std::uint32_t* v = &scene.indices[3 * t];
    const glm::dvec3 a = to_dvec(scene.positions[v[0]]);
    const glm::dvec3 n =
        glm::cross(to_dvec(scene.positions[v[1]]) - a, to_dvec(scene.positions[v[2]]) - a);
    for (int k = 0; k < 3; ++k) normals[v[k]] += n;
  }
  double sum = 0;
  for (glm::dvec3& n : normals) {
    const double length = glm::length(n);
    if (length > 0) n /= length;
    sum += n.x + n.y + n.z;
  }
  return sum;
}

}  // namespace

void bench_baseline(const StageRun& run) {
  const std::filesystem::path path =
      std::filesystem::temp_directory_path() / fmt::format("atlas_baseline_{}.obj", ::getpid());
  if (const Status s = write_plain_obj(run.staged.scene(), path, true); !s.ok()) {
    std::filesystem::remove(path);
    return report_failure(run, "baseline", s);
  }
  Row row = run.staged.row("baseline", "parse + normals", true);
  row.unit = "triangles read";
  run.measured(row, [&]() -> Status {
    const Result<LoadedScene> read = read_scene(path, {}, run.staged.context);
    if (!read.ok()) return read.status();
    row.size_out = read->scene.triangle_count();
    row.values = {{"missing", double(row.size_in - row.size_out)}};
    // The sum is stored so that the normals cannot be optimised away.
    row.values.emplace_back("normal_sum", sum_of_normals(read->scene));
    return {};
  });
  std::filesystem::remove(path);
}

}  // namespace atlas::bench
