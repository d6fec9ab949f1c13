#include "libatlas/scene/check_scene.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <span>

#include "libatlas/core/is_enumerator.h"
#include "libatlas/core/is_finite.h"
#include "libatlas/core/no_index.h"
#include "libatlas/image/file_kind.h"

namespace atlas {
namespace {

template <class... Arguments>
Status wrong(fmt::format_string<Arguments...> text, Arguments&&... arguments) {
  return {ErrorCode::bad_input,
          "scene: " + fmt::format(text, std::forward<Arguments>(arguments)...)};
}

// Returns the index of the first element that is not finite, or size().
template <class Vector>
std::size_t first_not_finite(const std::vector<Vector>& values) {
  return std::size_t(
      std::find_if(values.begin(), values.end(), [](const Vector& v) { return !is_finite(v); }) -
      values.begin());
}

Status check_vertices(const Scene& scene) {
  if (!is_finite(scene.origin)) return wrong("origin is not finite");
  if (!(scene.metres_per_unit > 0) || !std::isfinite(scene.metres_per_unit))
    return wrong("metres_per_unit is {} (give the length of a unit, above 0)",
                 scene.metres_per_unit);
  const std::size_t vertices = scene.positions.size();
  if (!scene.illumination.empty() && scene.illumination.size() != vertices)
    return wrong("illumination has {} values for {} positions (one each, or none)",
                 scene.illumination.size(), vertices);
  if (const std::size_t v = first_not_finite(scene.positions); v < vertices)
    return wrong("positions[{}] is not finite", v);
  if (const std::size_t v = first_not_finite(scene.illumination); v < scene.illumination.size())
    return wrong("illumination[{}] is not finite (where it is unknown, 0 leaves it black)", v);
  if (!scene.vertex_opacity.empty() && scene.vertex_opacity.size() != vertices)
    return wrong("vertex_opacity has {} values for {} positions (one each, or none)",
                 scene.vertex_opacity.size(), vertices);
  if (!scene.unlit_colours.empty() && scene.unlit_colours.size() != vertices)
    return wrong("unlit_colours has {} values for {} positions (one each, or none)",
                 scene.unlit_colours.size(), vertices);
  for (std::size_t v = 0; v < scene.unlit_colours.size(); ++v)
    if (!is_reflectance(scene.unlit_colours[v]))
      return wrong("unlit_colours[{}] is not within 0..1", v);
  for (std::size_t v = 0; v < scene.vertex_opacity.size(); ++v)
    if (!(scene.vertex_opacity[v] >= 0 && scene.vertex_opacity[v] <= 1))
      return wrong("vertex_opacity[{}] is {} (must be within 0..1)", v, scene.vertex_opacity[v]);
  if (const std::size_t v = first_not_finite(scene.texcoords); v < scene.texcoords.size())
    return wrong("texcoords[{}] is not finite", v);
  for (std::size_t i = 0; i < scene.normals.size(); ++i) {
    const Vec3f& n = scene.normals[i];
    // std::hypot is not used, since GCC 12 returns 0 for (0, 0, NaN).
    const double length = std::sqrt(double(n.x) * n.x + double(n.y) * n.y + double(n.z) * n.z);
    if (!(std::abs(length - 1) <= 0.01))
      return wrong("normals[{}] has length {:g} (must be 1)", i, length);
  }
  return {};
}

struct IndexList {
  const char* name;
  std::span<const std::uint32_t> values;
};
// The elements that an index list names.
struct Indexed {
  const char* name;
  std::size_t count;
};

// Checks that every index names an element, or is kNoTexcoord (equal to kNoNormal) if `may_be_none`
// is set.
Status check_range(const IndexList& list, const Indexed& of, bool may_be_none = false) {
  for (std::size_t i = 0; i < list.values.size(); ++i) {
    const std::uint32_t value = list.values[i];
    if (value < of.count || (may_be_none && value == Scene::kNoTexcoord)) continue;
    return wrong("{}[{}] is {}, but there are {} {}", list.name, i, value, of.count, of.name);
  }
  return {};
}

Status check_triangles(const Scene& scene) {
  const std::size_t corners = scene.indices.size(), triangles = corners / 3;
  if (corners % 3 != 0) return wrong("{} indices are not whole triangles", corners);
  const auto one_each = [&](const char* name, std::size_t size, std::size_t wanted) {
    return size == wanted
               ? Status{}
               : wrong("{} has {} entries for {} triangles (must be {}{})", name, size, triangles,
                       wanted, size == 0 ? "; complete_scene() fills them in" : "");
  };
  Status s = check_range({"indices", scene.indices}, {"positions", scene.positions.size()});
  if (s.ok()) s = one_each("triangle_material", scene.triangle_material.size(), triangles);
  if (s.ok() && !scene.triangle_object.empty())
    s = one_each("triangle_object", scene.triangle_object.size(), triangles);
  if (s.ok() && !scene.texcoord_indices.empty())
    s = one_each("texcoord_indices", scene.texcoord_indices.size(), corners);
  if (s.ok() && !scene.normal_indices.empty())
    s = one_each("normal_indices", scene.normal_indices.size(), corners);
  if (s.ok())
    s = check_range({"triangle_material", scene.triangle_material},
                    {"materials", scene.materials.size()});
  if (s.ok())
    s = check_range({"triangle_object", scene.triangle_object},
                    {"object_names", scene.object_names.size()});
  if (s.ok())
    s = check_range({"texcoord_indices", scene.texcoord_indices},
                    {"texcoords", scene.texcoords.size()}, true);
  if (s.ok())
    s = check_range({"normal_indices", scene.normal_indices}, {"normals", scene.normals.size()},
                    true);
  return s;
}

// Checks that the faces have all triangles, in their order, and that corners have one vertex each.
Status check_polygons(const Scene& scene) {
  const PolygonCorners& faces = scene.polygons;
  if (faces.count() == 0) return {};
  if (faces.polygon.size() != scene.triangle_count() ||
      faces.triangles.size() != scene.indices.size())
    return wrong("polygons has {} triangles, but there are {}", faces.polygon.size(),
                 scene.triangle_count());
  std::vector<std::uint32_t> vertex(faces.first.back(), kNoIndex);
  for (std::size_t i = 0; i < faces.triangles.size(); ++i) {
    const std::uint32_t polygon = faces.polygon[i / 3], corner = faces.triangles[i];
    const bool in_order = i < 3 || polygon >= faces.polygon[i / 3 - 1];
    if (polygon >= faces.count() || !in_order || corner < faces.first[polygon] ||
        corner >= faces.first[polygon + 1])
      return wrong("polygons: corner {} of triangle {} is none of its polygon's", i % 3, i / 3);
    if (vertex[corner] == kNoIndex) vertex[corner] = scene.indices[i];
    if (vertex[corner] != scene.indices[i])
      return wrong("polygons: corner {} has the vertices {} and {}", corner, vertex[corner],
                   scene.indices[i]);
  }
  for (std::size_t c = 0; c < vertex.size(); ++c)
    if (vertex[c] == kNoIndex) return wrong("polygons: no triangle has corner {}", c);
  return {};
}

// Checks that every triangle on the lightmap has all three coordinates, and a page with an image.
Status check_lightmap(const Scene& scene) {
  if (!scene.lightmap) return {};
  const SceneLightmap& map = *scene.lightmap;
  const std::size_t triangles = scene.triangle_count();
  if (map.texcoord_indices.size() != 3 * triangles || map.triangle_page.size() != triangles)
    return wrong("lightmap has {} texcoord_indices and {} pages for {} triangles",
                 map.texcoord_indices.size(), map.triangle_page.size(), triangles);
  if (!(map.white >= 0 && std::isfinite(map.white)))
    return wrong("lightmap.white is {} (must be finite, 0 or more)", map.white);
  if (const std::size_t v = first_not_finite(map.texcoords); v < map.texcoords.size())
    return wrong("lightmap.texcoords[{}] is not finite", v);
  for (std::size_t p = 0; p < map.pages.size(); ++p) {
    const ImageF& page = map.pages[p];
    if (!page.whole() || (!page.empty() && page.channels != 3))
      return wrong(
          "lightmap.pages[{}] is {} x {} with {} channels (must be 3), and holds {} values", p,
          page.width, page.height, page.channels, page.texels.size());
    if (!std::all_of(page.texels.begin(), page.texels.end(),
                     [](float value) { return std::isfinite(value); }))
      return wrong("lightmap.pages[{}] has a value that is not finite", p);
  }
  if (Status s = check_range({"lightmap.texcoord_indices", map.texcoord_indices},
                             {"texcoords", map.texcoords.size()}, true);
      !s.ok())
    return s;
  for (std::size_t t = 0; t < triangles; ++t) {
    const std::uint32_t* corner = &map.texcoord_indices[3 * t];
    const auto absent = std::count(corner, corner + 3, Scene::kNoTexcoord);
    if (absent == 3) continue;
    if (absent > 0) return wrong("lightmap: only some corners of triangle {} lie on it", t);
    const std::uint32_t page = map.triangle_page[t];
    if (page >= map.pages.size() || map.pages[page].empty())
      return wrong("lightmap.triangle_page[{}] is {}, which has no image", t, page);
  }
  return {};
}

Status check_materials(const Scene& scene) {
  for (std::size_t m = 0; m < scene.materials.size(); ++m) {
    const Material& material = scene.materials[m];
    if (material.texture < -1 || material.texture >= std::int64_t(scene.textures.size()))
      return wrong("materials[{}] names texture {}, but there are {} (-1: none)", m,
                   material.texture, scene.textures.size());
    if (!is_finite(material.diffuse)) return wrong("the diffuse of materials[{}] is not finite", m);
    const Vec3f& e = material.emission;
    if (!is_finite(e) || std::min({e.x, e.y, e.z}) < 0)
      return wrong("the emission of materials[{}] is not finite or below 0", m);
    if (!(material.opacity >= 0 && material.opacity <= 1))
      return wrong("the opacity of materials[{}] is {} (must be within 0..1)", m, material.opacity);
    if (!(material.alpha_cutoff >= 0) || !std::isfinite(material.alpha_cutoff))
      return wrong("the alpha_cutoff of materials[{}] is {} (must be 0 or more)", m,
                   material.alpha_cutoff);
    if (!is_enumerator(material.alpha_mode, AlphaMode::blend) ||
        !is_enumerator(material.wrap_u, TextureWrap::clamp) ||
        !is_enumerator(material.wrap_v, TextureWrap::clamp))
      return wrong(
          "materials[{}] has the alpha_mode {}, wrap_u {} and wrap_v {} (give an "
          "AlphaMode and a TextureWrap)",
          m, int(material.alpha_mode), int(material.wrap_u), int(material.wrap_v));
  }
  for (std::size_t i = 0; i < scene.textures.size(); ++i) {
    const Image8& image = scene.textures[i].image;
    const auto& encoded = scene.textures[i].encoded;
    if (!encoded.empty() && !image.empty())
      return wrong("textures[{}] has both image and encoded (one of them must be empty)", i);
    if (!encoded.empty() && image_extension(encoded).empty())
      return wrong("the encoded of textures[{}] is neither a PNG nor a JPEG file", i);
    if (!encoded.empty()) continue;
    if (image.empty() || !image.whole())
      return wrong("the image of textures[{}] is {} x {} with {} channels, but holds {} values", i,
                   image.width, image.height, image.channels, image.texels.size());
  }
  return {};
}

}  // namespace

Status check_scene(const Scene& scene) {
  Status s = check_vertices(scene);
  if (s.ok()) s = check_triangles(scene);
  if (s.ok()) s = check_polygons(scene);
  if (s.ok()) s = check_materials(scene);
  if (s.ok()) s = check_lightmap(scene);
  return s;
}

Status check_images(const Scene& scene) {
  for (std::size_t i = 0; i < scene.textures.size(); ++i) {
    if (scene.textures[i].image.empty())
      return wrong("textures[{}] has no image to bake (read it without encoded_textures)", i);
  }
  return {};
}

Status complete_scene(Scene& scene) {
  if (scene.materials.empty()) scene.materials.resize(1);
  if (scene.triangle_material.empty()) scene.triangle_material.resize(scene.triangle_count());
  if (scene.object_names.empty()) scene.object_names.resize(1);
  if (scene.triangle_object.empty()) scene.triangle_object.resize(scene.triangle_count());
  return check_scene(scene);
}

}  // namespace atlas
