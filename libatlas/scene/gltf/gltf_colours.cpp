#include "libatlas/scene/gltf/gltf_colours.h"

#include <algorithm>
#include <cmath>
#include <set>
#include <vector>

#include "libatlas/scene/gltf/gltf_pose.h"

namespace atlas {
namespace {

// The format limits colours to 0..1. What is no number becomes 0, as light does.
float within_range(float value) {
  return value > 0 ? std::min(value, 1.0f) : 0;
}

bool is_unlit(const tinygltf::Model& model, int material) {
  return material >= 0 && std::size_t(material) < model.materials.size() &&
         model.materials[std::size_t(material)].extensions.contains("KHR_materials_unlit");
}

bool beyond_one(const tinygltf::Model& model, int accessor) {
  constexpr float kRounding = 1e-3f;  // of programs that convert colours
  const tinygltf::Accessor& a = model.accessors[std::size_t(accessor)];
  if (a.componentType != TINYGLTF_COMPONENT_TYPE_FLOAT) return false;
  const auto rgb = gltf_floats(model, accessor, 3);
  return rgb.ok() &&
         std::any_of(rgb->begin(), rgb->end(), [](float value) { return value > 1 + kRounding; });
}

}  // namespace

KeptColours find_gltf_colours(const tinygltf::Model& model) {
  KeptColours found;
  std::set<int> accessors;
  for (const tinygltf::Mesh& mesh : model.meshes)
    for (const tinygltf::Primitive& primitive : mesh.primitives) {
      found.illuminance |= gltf_attribute(primitive.attributes, "_ILLUMINANCE") >= 0;
      if (!is_unlit(model, primitive.material))
        accessors.insert(gltf_attribute(primitive.attributes, "COLOR_0"));
    }
  for (const int accessor : accessors) {
    if (accessor < 0 || std::size_t(accessor) >= model.accessors.size()) continue;
    if (beyond_one(model, accessor)) found.values = GltfColours::beyond_one;
    if (found.values == GltfColours::none) found.values = GltfColours::within_one;
  }
  return found;
}

Result<bool> add_gltf_light(const tinygltf::Model& model, const tinygltf::Primitive& primitive,
                            const GltfVertexRange& vertices, SceneBuilder& builder) {
  const auto [first, count] = vertices;
  builder.linear_light = true;
  builder.illumination.resize(first + count, {NAN, NAN, NAN});
  if (builder.wants_rest) builder.vertex_opacity.resize(first + count, 1);
  int accessor = gltf_attribute(primitive.attributes, "_ILLUMINANCE");
  const bool colours = accessor < 0;
  if (colours) accessor = gltf_attribute(primitive.attributes, "COLOR_0");
  if (accessor < 0) return false;
  const auto rgb = gltf_floats(model, accessor, 3);
  if (!rgb.ok()) return rgb.status();
  if (rgb->size() != 3 * count)
    return Status(ErrorCode::bad_input, "has another number of colours than of positions");
  for (std::size_t i = 0; i < count; ++i)
    builder.illumination[first + i] = {(*rgb)[3 * i], (*rgb)[3 * i + 1], (*rgb)[3 * i + 2]};
  if (!colours || !builder.wants_rest ||
      model.accessors[std::size_t(accessor)].type != TINYGLTF_TYPE_VEC4)
    return true;
  const auto rgba = gltf_floats(model, accessor, 4);
  if (!rgba.ok()) return rgba.status();
  for (std::size_t i = 0; i < count; ++i) builder.vertex_opacity[first + i] = (*rgba)[4 * i + 3];
  return true;
}

void add_gltf_unlit_colours(const tinygltf::Model& model, const tinygltf::Primitive& primitive,
                            const GltfVertexRange& vertices, SceneBuilder& builder) {
  const int accessor = gltf_attribute(primitive.attributes, "COLOR_0");
  if (accessor < 0) return;
  const auto rgb = gltf_floats(model, accessor, 3);
  const auto [first, count] = vertices;
  if (!rgb.ok() || rgb->size() != 3 * count) return;
  if (builder.unlit_colours.size() < first + count)
    builder.unlit_colours.resize(first + count, {1, 1, 1});
  for (std::size_t i = 0; i < count; ++i)
    builder.unlit_colours[first + i] = {within_range((*rgb)[3 * i]),
                                        within_range((*rgb)[3 * i + 1]),
                                        within_range((*rgb)[3 * i + 2])};
}

}  // namespace atlas
