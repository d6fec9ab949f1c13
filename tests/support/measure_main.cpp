// atlas-measure: the measures of the tests as a program.
//   atlas-measure atlas FILE.obj WIDTH HEIGHT               uv quality, overlaps and bleeding
//   atlas-measure world SCENE.obj WORLD.(wrl|obj|html) [CAMERAS] how the world looks beside the
//   scene
#include <fmt/format.h>

#include <cstdio>
#include <cstdlib>
#include <cstring>

#include "tests/support/atlas_measure.h"
#include "tests/support/fidelity.h"

namespace {

using namespace atlas::test;

int fail(const std::string& message) {
  fmt::print(stderr, "atlas-measure: {}\n", message);
  return 1;
}

int measure_uvs(const char* path, int width, int height) {
  const auto mesh = read_uv_obj(path);
  if (!mesh.ok()) return fail(mesh.status().message());
  if (width < 1 || height < 1) return fail("the page size must be positive");
  const AtlasMeasures m = measure_atlas(*mesh, width, height);
  fmt::print(
      "{{\"triangles\":{},\"without_uv\":{},\"charts\":{},\"pages\":{},\"utilization\":{:.4f},"
      "\"covered\":{:.4f},"
      "\"scale\":{:.6g},\"stretch_l2\":{:.4f},\"stretch_linf\":{:.2f},\"stretch_999\":{:.3f},"
      "\"conformal_mean\":{:.4f},\"conformal_999\":{:.3f},\"conformal_max\":{:.3g},\"dirichlet_"
      "mean\":{:.4f},"
      "\"flipped\":{},\"mirrored\":{},\"degenerate\":{},\"outside\":{},\"overlap\":{},\"bleed\":{},"
      "\"seam\":{:.3f}}}\n",
      m.triangles, m.faces_without_uv, m.charts, m.pages, m.utilization, m.covered, m.scale,
      m.stretch_l2, m.stretch_linf, m.stretch_999, m.conformal_mean, m.conformal_999,
      m.conformal_max, m.dirichlet_mean, m.flipped, m.mirrored, m.degenerate, m.outside, m.overlap,
      m.bleed, m.seam);
  return 0;
}

int measure_world(const char* scene_path, const char* world_path, int cameras) {
  const auto scene = read_world(scene_path), world = read_world(world_path);
  for (const auto* mesh : {&scene, &world})
    if (!mesh->ok()) return fail(mesh->status().message());
  ViewOptions options;
  options.cameras = cameras;
  const Fidelity f = compare_views(*scene, *world, options);
  if (f.cameras == 0) return fail("no place to stand in this scene");
  fmt::print(
      "{{\"psnr\":{:.2f},\"p50\":{:.4f},\"p99\":{:.4f},\"p999\":{:.4f},\"bad8\":{:.5f},\"miss\":{:."
      "6f},"
      "\"triangles_in\":{},\"triangles_out\":{},\"pages\":{},\"scale\":{:.4g},\"white\":{:.3f},"
      "\"cameras\":{}}}\n",
      f.psnr, f.p50, f.p99, f.p999, f.bad8, f.miss, f.triangles_in, f.triangles_out, f.pages,
      f.scale, f.white, f.cameras);
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc == 5 && !std::strcmp(argv[1], "atlas"))
    return measure_uvs(argv[2], std::atoi(argv[3]), std::atoi(argv[4]));
  if ((argc == 4 || argc == 5) && !std::strcmp(argv[1], "world"))
    return measure_world(argv[2], argv[3], argc == 5 ? std::atoi(argv[4]) : 12);
  fmt::print(stderr,
             "usage: atlas-measure atlas FILE.obj WIDTH HEIGHT\n"
             "       atlas-measure world SCENE.obj WORLD.(wrl|obj|html) [CAMERAS]\n");
  return 2;
}
