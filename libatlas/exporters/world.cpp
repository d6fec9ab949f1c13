#include "libatlas/exporters/world.h"

#include <fmt/format.h>

#include <cmath>
#include <limits>
#include <utility>

#include "libatlas/core/is_enumerator.h"
#include "libatlas/core/is_finite.h"
#include "libatlas/scene/check_scene.h"

namespace atlas {
namespace {

Status wrong(const std::string& what) {
  return {ErrorCode::bad_input, "the world to write is inconsistent: " + what};
}

bool in_float_range(double value) {
  return std::abs(value) <= static_cast<double>(std::numeric_limits<float>::max());
}

Status check_numbers(const World& world) {
  for (std::size_t i = 0; i < world.positions.size(); ++i) {
    const Vec3f& p = world.positions[i];
    if (!in_float_range(world.origin.x + p.x) || !in_float_range(world.origin.y + p.y) ||
        !in_float_range(world.origin.z + p.z)) {
      return wrong(fmt::format("position {} is not a finite float", i));
    }
  }
  for (std::size_t i = 0; i < world.uvs.size(); ++i) {
    if (!is_finite(world.uvs[i])) {
      return wrong(fmt::format("texture coordinate {} is not finite", i));
    }
  }
  return {};
}

// Checks that the indices of a page's list are all below `count`.
Status check_indices(std::size_t page, const char* list, const std::vector<std::uint32_t>& indices,
                     std::size_t count) {
  for (std::size_t i = 0; i < indices.size(); ++i) {
    if (indices[i] < count) continue;
    return wrong(
        fmt::format("page {}: {}[{}] is {}, but there are {}", page, list, i, indices[i], count));
  }
  return {};
}

// Checks that the sizes of faces add up, if there are any.
Status check_faces(std::size_t number, const Page& page) {
  if (page.face_sizes.empty()) return {};
  std::size_t corners = 0;
  for (const std::uint32_t size : page.face_sizes) {
    if (size < 3) return wrong(fmt::format("page {} has a face of {} corners", number, size));
    corners += size;
  }
  if (corners == page.indices.size()) return {};
  return wrong(fmt::format("page {} has faces of {} corners, and {} indices", number, corners,
                           page.indices.size()));
}

// Checks what has one value per triangle or none.
Status check_triangle_lists(std::size_t number, const Page& page) {
  const std::size_t triangles = page.indices.size() / 3;
  for (const auto& [list, size] :
       {std::pair("one_sided", page.one_sided.size()), std::pair("charts", page.charts.size())}) {
    if (size != 0 && size != triangles)
      return wrong(
          fmt::format("page {} has {} values {} for {} triangles", number, size, list, triangles));
  }
  return {};
}

Status check_viewpoint(const Viewpoint& view) {
  for (const double value : {view.position.x, view.position.y, view.position.z, view.direction.x,
                             view.direction.y, view.direction.z}) {
    if (!in_float_range(value)) return wrong("the viewpoint is not finite");
  }
  if (view.direction == Vec3d{}) return wrong("the viewpoint has no direction");
  if (!(view.fov > 0 && view.fov < 3.14159265)) return wrong("the field of view is out of (0, pi)");
  return {};
}

constexpr int kMostUvSets = 7;  // behind TEXCOORD_0; engines read no more

Status check_lightmap(const Lightmap& map, std::size_t triangles) {
  if (map.images.empty() || (!map.linear.empty() && map.linear.size() != map.images.size()))
    return wrong(fmt::format("its lightmap has {} images and {} of linear light (one a page each)",
                             map.images.size(), map.linear.size()));
  if (map.triangle_page.empty()) return {};
  if (map.triangle_page.size() != triangles)
    return wrong(fmt::format("its lightmap has the pages of {} triangles, the scene has {}",
                             map.triangle_page.size(), triangles));
  for (std::size_t t = 0; t < triangles; ++t) {
    if (map.triangle_page[t] >= map.images.size())
      return wrong(fmt::format("triangle {} is on page {} of its lightmap, which has {}", t,
                               map.triangle_page[t], map.images.size()));
  }
  return {};
}

Status check_kept_scene(const World& world) {
  const Scene& scene = *world.scene;
  if (Status s = check_scene(scene); !s.ok()) return s;
  if (world.uv_set < 0 || world.uv_set > kMostUvSets)
    return wrong("its set of uvs must be within 1..7, or 0 for the first that is free");
  if (scene.indices.empty()) return wrong("its scene has no triangle");
  if (world.pages.size() != 1 || !world.pages[0].image.empty())
    return wrong("a world that keeps its scene has one page, without an image");
  if (world.positions.size() != scene.positions.size() || world.pages[0].indices != scene.indices)
    return wrong("its page has other corners than its scene");
  return world.lightmap ? check_lightmap(*world.lightmap, scene.triangle_count()) : Status();
}

}  // namespace

Status check_world(const World& world) {
  if (Status s = check_numbers(world); !s.ok()) return s;
  if (Status s = check_viewpoint(world.viewpoint); !s.ok()) return s;
  if (!(world.metres_per_unit > 0) || !std::isfinite(world.metres_per_unit))
    return wrong(fmt::format("metres_per_unit is {} (must be above 0)", world.metres_per_unit));
  if (!is_enumerator(world.up, Up::z))
    return wrong(fmt::format("up is {} (give an Up)", int(world.up)));
  if (!world.uv_tiles.empty() && world.uv_tiles.size() != world.uvs.size())
    return wrong(
        fmt::format("it has tiles of {} uvs, and {} uvs", world.uv_tiles.size(), world.uvs.size()));
  for (std::size_t i = 0; i < world.pages.size(); ++i) {
    const Page& page = world.pages[i];
    if (Status s = check_faces(i, page); !s.ok()) return s;
    if ((page.face_sizes.empty() && page.indices.size() % 3 != 0) ||
        page.indices.size() != page.uv_indices.size()) {
      return wrong(fmt::format("page {} has {} indices and {} uv_indices (3 a triangle each)", i,
                               page.indices.size(), page.uv_indices.size()));
    }
    Status s = check_indices(i, "indices", page.indices, world.positions.size());
    if (s.ok()) s = check_indices(i, "uv_indices", page.uv_indices, world.uvs.size());
    if (s.ok()) s = check_triangle_lists(i, page);
    if (!s.ok()) return s;
    if (!page.error.empty() &&
        (page.error_columns == 0 || page.error.size() % page.error_columns != 0))
      return wrong(fmt::format("page {} has {} cells of its error in rows of {}", i,
                               page.error.size(), page.error_columns));
  }
  if (world.light && world.light->curves.empty())
    return wrong("its pages hold light, but no curve shows it");
  if (world.instances && (!world.scene || !world.scene->source || world.lightmap))
    return wrong("only a scene that was read from glTF has instances, and no lightmap then");
  if (world.lightmap && !world.scene) return wrong("it has a lightmap, but no scene to keep");
  return world.scene ? check_kept_scene(world) : Status();
}

Status check_only_triangles(const World& world) {
  for (const Page& page : world.pages)
    if (!page.face_sizes.empty()) return wrong("it has polygons, which only OBJ has");
  return world.uv_tiles.empty() ? Status() : wrong("it has UDIM tiles, which only OBJ has");
}

std::string page_name(const std::filesystem::path& target, std::size_t page) {
  return fmt::format("{}_{}", safe_file_name(target.stem().string()), page);
}

}  // namespace atlas
