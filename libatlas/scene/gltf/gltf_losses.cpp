#include "libatlas/scene/gltf/gltf_losses.h"

namespace atlas {
namespace {

std::size_t texture_count(const tinygltf::Value& part) {
  std::size_t count = 0;
  if (part.IsArray())
    for (std::size_t i = 0; i < part.ArrayLen(); ++i)
      count += texture_count(part.Get(static_cast<int>(i)));
  if (part.IsObject())
    for (const auto& [key, value] : part.Get<tinygltf::Value::Object>())
      count += key.ends_with("Texture") && value.IsObject() ? 1 : texture_count(value);
  return count;
}

std::size_t texture_count(const tinygltf::ExtensionMap& extensions) {
  std::size_t count = 0;
  for (const auto& [name, value] : extensions) count += texture_count(value);
  return count;
}

// Returns how many textures a material has besides that of its base colour.
std::size_t other_textures(const tinygltf::Material& m) {
  const auto& pbr = m.pbrMetallicRoughness;
  std::size_t count = texture_count(m.extensions) + texture_count(pbr.extensions);
  for (const int index : {pbr.metallicRoughnessTexture.index, m.normalTexture.index,
                          m.occlusionTexture.index, m.emissiveTexture.index})
    count += index >= 0;
  return count;
}

// Returns whether the material has more than a base colour, emission and their textures.
bool shaded(const tinygltf::Material& m) {
  const auto& pbr = m.pbrMetallicRoughness;
  return !m.extensions.empty() || pbr.metallicFactor != 1 || pbr.roughnessFactor != 1;
}

bool moved(const tinygltf::Node& node) {
  return !node.children.empty() || !node.matrix.empty() || !node.translation.empty() ||
         !node.rotation.empty() || !node.scale.empty();
}

std::size_t uv_sets(const tinygltf::Primitive& primitive) {
  std::size_t count = 0;
  for (const auto& [name, accessor] : primitive.attributes) count += name.starts_with("TEXCOORD_");
  return count;
}

// Adds what neither a Scene nor an OBJ file holds.
void count_common(const tinygltf::Model& model, Losses& losses) {
  losses.add("animations", model.animations.size());
  losses.add("skins, kept at rest", model.skins.size());
  losses.add("cameras", model.cameras.size());
  losses.add("lights", model.lights.size());
  for (const tinygltf::Mesh& mesh : model.meshes) {
    bool morphs = false;
    for (const tinygltf::Primitive& primitive : mesh.primitives) {
      morphs |= !primitive.targets.empty();
      losses.add("primitives with tangents", primitive.attributes.contains("TANGENT"));
    }
    losses.add("meshes with morph targets, kept at rest", morphs);
  }
  for (const tinygltf::Node& node : model.nodes)
    losses.add("nodes with transforms or children, applied to what they show", moved(node));
  for (const tinygltf::Material& material : model.materials)
    losses.add("materials of more than a base colour", shaded(material));
}

}  // namespace

LossCounts gltf_not_read(const tinygltf::Model& model) {
  Losses losses;
  count_common(model, losses);
  for (const tinygltf::Mesh& mesh : model.meshes)
    for (const tinygltf::Primitive& primitive : mesh.primitives)
      losses.add("primitives with uvs in several sets", uv_sets(primitive) > 1);
  for (const tinygltf::Material& material : model.materials)
    losses.add("textures of materials", other_textures(material));
  return losses.counts();
}

void count_losses(const tinygltf::Model& model, Losses& losses) {
  count_common(model, losses);
  for (const tinygltf::Mesh& mesh : model.meshes)
    for (const tinygltf::Primitive& primitive : mesh.primitives)
      losses.add("primitives with uvs of their own", primitive.attributes.contains("TEXCOORD_0"));
  for (const tinygltf::Material& m : model.materials)
    losses.add("textures of materials",
               other_textures(m) + (m.pbrMetallicRoughness.baseColorTexture.index >= 0));
}

}  // namespace atlas
