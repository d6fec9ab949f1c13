// What atlas-play does with a scene before it draws.
#include <algorithm>
#include <cmath>

#include "libatlas/scene/reader.h"
#include "libatlas/view/start_camera.h"
#include "libatlas/view/view_scene.h"
#include "tests/fuzz/fuzz_files.h"

namespace atlas::test {
namespace {

bool finite(const Vec3d& v) {
  return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z);
}

bool finite(const std::vector<Vec3f>& values) {
  return std::all_of(values.begin(), values.end(), [](const Vec3f& v) {
    return finite(Vec3d{v.x, v.y, v.z});
  });
}

std::string judge(const Camera& camera) {
  if (!finite(camera.eye) || !finite(camera.target)) return "a camera that is nowhere";
  return camera.near_plane > 0 && camera.near_plane < camera.far_plane ? "" : "no depth";
}

std::string judge(const ViewScene& view, unsigned choice) {
  const std::size_t count = view.positions.size();
  for (const std::uint32_t i : view.indices)
    if (i >= count) return "an index beyond the vertices";
  for (const std::uint32_t i : view.caster_indices)
    if (i >= view.caster_positions.size()) return "an index beyond the casters";
  for (const auto* values : {&view.normals, &view.colours, &view.emission, &view.illumination})
    if (!values->empty() && values->size() != count) return "an array of another length";
  if (!finite(view.positions) || !finite(view.normals)) return "a vertex that is not finite";
  if (!finite(view.illumination)) return "light that is not finite";
  for (const Vec2f& uv : view.light_texcoords)
    if (!std::isfinite(uv.x) || !std::isfinite(uv.y)) return "a texcoord that is not finite";
  if (!(view.light_scale > 0) || !std::isfinite(view.light_scale))
    return "a scale of light that is not finite";
  for (const ViewScene::Cluster& c : view.clusters) {
    if (!std::isfinite(c.radius)) return "a cluster without bounds";
    if (c.look.texture >= int(view.textures.size())) return "a texture that there is not";
    if (c.look.light_page >= 0 && (!view.lightmap || view.light_texcoords.size() != count ||
                                   view.lightmap->pages[std::size_t(c.look.light_page)].empty()))
      return "a page of the lightmap that there is not";
  }
  const Vec3d up = choice & 8 ? Vec3d{0, 1, 0} : Vec3d{0, 0, 1};
  // Looking for a point inside takes seconds under sanitizers.
  const bool inside = choice % 64 < 8;
  return judge(inside ? start_camera(view, up, 60) : camera_for(view.bounds, up, 60));
}

}  // namespace

FuzzResult fuzz_view(FuzzBytes bytes, const std::string& extension) {
  const FuzzFolder folder;
  const unsigned choice = sum_of(bytes);
  ReadOptions read;
  ViewSceneOptions look;
  read.lightmap = true;
  read.srgb_colours = look.vertices_hold_colours = choice & 1;
  if (choice & 2) look.textures_hold_light = choice & 4;
  look.cluster_triangles = 2;
  Context context;
  context.threads = 1;
  const Result<LoadedScene> loaded =
      read_scene(folder.write_scene(bytes, extension), read, context);
  if (!loaded.ok()) return {};
  const Result<ViewScene> view = make_view_scene(loaded->scene, look);
  if (view.ok()) return {judge(*view, choice), true};
  const std::string& message = view.status().message();
  return {clear_error(message) ? "" : "an unclear error: " + message};
}

}  // namespace atlas::test
