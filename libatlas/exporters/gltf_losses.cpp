#include "libatlas/exporters/gltf_losses.h"

#include "libatlas/scene/gltf_source.h"

namespace atlas {
namespace {

std::size_t texture_count(const nlohmann::json& part) {
  std::size_t count = 0;
  if (!part.is_structured()) return count;
  for (const auto& [key, value] : part.items()) {
    const bool texture = part.is_object() && key.ends_with("Texture") && value.is_object();
    count += texture ? 1 : texture_count(value);
  }
  return count;
}

// Whether it is more than a base colour, light of its own, and their textures.
bool shaded(const tinygltf::Material& m) {
  const auto& pbr = m.pbrMetallicRoughness;
  return !m.extensions.empty() || pbr.metallicFactor != 1 || pbr.roughnessFactor != 1;
}

bool moved(const tinygltf::Node& node) {
  return !node.children.empty() || !node.matrix.empty() || !node.translation.empty() ||
         !node.rotation.empty() || !node.scale.empty();
}

void count_attributes(const tinygltf::Model& model, Losses& losses) {
  for (const tinygltf::Mesh& mesh : model.meshes) {
    bool morphs = false;
    for (const tinygltf::Primitive& primitive : mesh.primitives) {
      morphs |= !primitive.targets.empty();
      losses.add("primitives with uvs of their own", primitive.attributes.contains("TEXCOORD_0"));
      losses.add("primitives with tangents", primitive.attributes.contains("TANGENT"));
    }
    losses.add("meshes with morph targets, kept at rest", morphs);
  }
}

}  // namespace

void count_losses(const GltfSource& source, Losses& losses) {
  const tinygltf::Model& model = source.model;
  losses.add("animations", model.animations.size());
  losses.add("skins, kept at rest", model.skins.size());
  losses.add("cameras", model.cameras.size());
  losses.add("lights", model.lights.size());
  count_attributes(model, losses);
  for (const tinygltf::Node& node : model.nodes)
    losses.add("nodes with transforms or children, applied to what they show", moved(node));
  for (std::size_t m = 0; m < model.materials.size(); ++m) {
    losses.add("materials of more than a base colour", shaded(model.materials[m]));
    losses.add("textures of materials", texture_count(source.document["materials"][m]));
  }
}

}  // namespace atlas
