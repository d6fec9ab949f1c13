#include "libatlas/exporters/writing/scene_parts.h"

#include <array>
#include <cstring>
#include <map>
#include <tuple>

#include "libatlas/exporters/writing/unify_vertices.h"

namespace atlas {
namespace {

bool all_named(const std::vector<std::uint32_t>& indices, std::size_t triangle) {
  if (indices.empty()) return false;
  const std::uint32_t* i = &indices[3 * triangle];
  static_assert(Scene::kNoTexcoord == Scene::kNoNormal);
  return i[0] != Scene::kNoNormal && i[1] != Scene::kNoNormal && i[2] != Scene::kNoNormal;
}

template <std::size_t N, class Vector>
std::vector<std::uint32_t> first_equal_of(std::span<const Vector> values) {
  static_assert(sizeof(Vector) == 4 * N);
  const auto unified = unify_vertices<N>(values.size(), [&](std::size_t i) {
    std::array<std::uint32_t, N> bits;
    std::memcpy(bits.data(), &values[i], sizeof bits);
    return bits;
  });
  std::vector<std::uint32_t> first(unified.vertices.size()), result = unified.indices;
  for (std::size_t i = result.size(); i-- > 0;) first[result[i]] = static_cast<std::uint32_t>(i);
  for (std::uint32_t& i : result) i = first[i];
  return result;
}

}  // namespace

std::vector<ScenePart> scene_parts(const Scene& scene,
                                   std::span<const std::uint32_t> triangle_page) {
  using Key = std::tuple<std::uint32_t, std::uint32_t, bool, bool, std::uint32_t>;
  std::map<Key, ScenePart> parts;
  ScenePart* last = nullptr;
  Key last_key;
  for (std::size_t t = 0; t < scene.triangle_count(); ++t) {
    const std::uint32_t object = scene.triangle_object.empty() ? 0 : scene.triangle_object[t];
    const Key key{object, scene.triangle_material[t], all_named(scene.texcoord_indices, t),
                  all_named(scene.normal_indices, t), triangle_page.empty() ? 0 : triangle_page[t]};
    if (!last || key != last_key) {
      last = &parts[key];
      last_key = key;
    }
    last->triangles.push_back(static_cast<std::uint32_t>(t));
  }
  std::vector<ScenePart> result;
  for (auto& [key, part] : parts) {
    std::tie(part.object, part.material, part.texcoords, part.normals, part.page) = key;
    result.push_back(std::move(part));
  }
  return result;
}

std::vector<std::uint32_t> first_equals(std::span<const Vec2f> values) {
  return first_equal_of<2>(values);
}

std::vector<std::uint32_t> first_equals(std::span<const Vec3f> values) {
  return first_equal_of<3>(values);
}

}  // namespace atlas
