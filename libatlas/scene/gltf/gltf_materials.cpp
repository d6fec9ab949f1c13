#include "libatlas/scene/gltf/gltf_materials.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "libatlas/scene/files/decode_uri.h"
#include "libatlas/scene/files/finite_float.h"

namespace atlas {
namespace fs = std::filesystem;
namespace {

// Returns the image that an extension of a texture names, or -1.
int image_of_extension(const tinygltf::Model& model, const tinygltf::Value& extension) {
  if (!extension.IsObject() || !extension.Get("source").IsInt()) return -1;
  const int image = extension.Get("source").GetNumberAsInt();
  return image >= 0 && std::size_t(image) < model.images.size() ? image : -1;
}

// Returns which images extensions of textures name.
std::vector<bool> images_of_extensions(const tinygltf::Model& model) {
  std::vector<bool> named(model.images.size());
  for (const tinygltf::Texture& texture : model.textures)
    for (const auto& [name, extension] : texture.extensions)
      if (const int i = image_of_extension(model, extension); i >= 0) named[std::size_t(i)] = true;
  return named;
}

Status add_images(const tinygltf::Model& model, SceneBuilder& builder) {
  const fs::path folder = fs::path(builder.file).parent_path();
  const std::vector<bool> of_extensions = images_of_extensions(model);
  for (std::size_t i = 0; i < model.images.size(); ++i) {
    const tinygltf::Image& image = model.images[i];
    RawTexture texture;
    texture.place = fmt::format("{}: image {}", builder.file, i);
    texture.of_extension = of_extensions[i];
    texture.path = image.uri.empty() ? fs::path(texture.place) : folder / decode_uri(image.uri);
    if (builder.wants_textures) texture.bytes = image.image;
    if (builder.wants_textures && image.bufferView >= 0) {
      auto bytes = gltf_view(model, image.bufferView);
      if (!bytes.ok()) {
        return {ErrorCode::bad_input,
                fmt::format("{}: image {}: {} (check it with a glTF validator)", builder.file, i,
                            bytes.status().message())};
      }
      texture.bytes.assign(bytes->begin(), bytes->end());
    }
    builder.textures.push_back(std::move(texture));
  }
  return {};
}

// Returns the image of a texture, or -1. An extension names it if glTF itself does not have its
// format.
int image_of(const tinygltf::Model& model, int texture) {
  if (texture < 0 || std::size_t(texture) >= model.textures.size()) return -1;
  const tinygltf::Texture& t = model.textures[texture];
  int source = t.source;
  const auto webp = t.extensions.find("EXT_texture_webp");
  if (source < 0 && webp != t.extensions.end()) source = image_of_extension(model, webp->second);
  return source >= 0 && std::size_t(source) < model.images.size() ? source : -1;
}

// Returns whether the scene is kept with an image that an extension of a texture names, whether or
// not it can be decoded.
bool keeps_image(const tinygltf::Model& model, int texture, const SceneBuilder& builder) {
  if (!builder.wants_rest || !builder.wants_textures) return false;
  if (texture < 0 || std::size_t(texture) >= model.textures.size()) return false;
  const auto& extensions = model.textures[std::size_t(texture)].extensions;
  return std::any_of(extensions.begin(), extensions.end(),
                     [&](const auto& e) { return image_of_extension(model, e.second) >= 0; });
}

// Returns the names of a texture's extensions, in brackets after a blank, or nothing.
std::string extensions_of(const tinygltf::Model& model, int texture) {
  std::string names;
  if (std::size_t(texture) >= model.textures.size()) return names;
  for (const auto& [name, value] : model.textures[texture].extensions)
    names += (names.empty() ? " (" : ", ") + name;
  return names.empty() ? names : names + ')';
}

// Returns `count` numbers of a list, or `absent` for each that is not given.
template <std::size_t count>
std::array<double, count> numbers(const tinygltf::Value& object, const char* key, double absent) {
  std::array<double, count> result;
  result.fill(absent);
  if (!object.IsObject()) return result;
  const tinygltf::Value& value = object.Get(key);
  for (int i = 0; i < int(count) && value.IsArray() && value.ArrayLen() >= count; ++i) {
    if (value.Get(i).IsNumber()) result[std::size_t(i)] = value.Get(i).GetNumberAsDouble();
  }
  return result;
}

// The diffuse part of a material, from glTF's own model of shading or from the older
// specular-glossiness extension.
struct Diffuse {
  Vec3f colour{1, 1, 1};
  double opacity = 1;
  tinygltf::TextureInfo texture;
};

Diffuse diffuse_of(const tinygltf::Material& material) {
  Diffuse diffuse;
  const auto glossy = material.extensions.find("KHR_materials_pbrSpecularGlossiness");
  if (glossy == material.extensions.end() || !glossy->second.IsObject()) {
    const auto& pbr = material.pbrMetallicRoughness;
    if (pbr.baseColorFactor.size() >= 3) {
      diffuse.colour = {finite_float(pbr.baseColorFactor[0]), finite_float(pbr.baseColorFactor[1]),
                        finite_float(pbr.baseColorFactor[2])};
    }
    if (pbr.baseColorFactor.size() >= 4) diffuse.opacity = pbr.baseColorFactor[3];
    diffuse.texture = pbr.baseColorTexture;
    return diffuse;
  }
  const auto rgb = numbers<3>(glossy->second, "diffuseFactor", 1);
  diffuse.colour = {finite_float(rgb[0]), finite_float(rgb[1]), finite_float(rgb[2])};
  diffuse.opacity = numbers<4>(glossy->second, "diffuseFactor", 1)[3];
  const tinygltf::Value& info = glossy->second.Get("diffuseTexture");
  if (!info.IsObject() || !info.Get("index").IsInt()) return diffuse;
  diffuse.texture.index = info.Get("index").GetNumberAsInt();
  if (info.Get("texCoord").IsInt())
    diffuse.texture.texCoord = info.Get("texCoord").GetNumberAsInt();
  const tinygltf::Value& extensions = info.Get("extensions");
  for (const std::string& key : extensions.Keys())
    diffuse.texture.extensions[key] = extensions.Get(key);
  return diffuse;
}

// Reads the emission, which has no defined unit: glTF's own factors are at most 1, and an extension
// multiplies them.
void add_emission(const tinygltf::Material& m, RawMaterial& material) {
  if (m.emissiveFactor.size() < 3) return;
  double strength = 1;
  const auto at = m.extensions.find("KHR_materials_emissive_strength");
  if (at != m.extensions.end() && at->second.IsObject()) {
    const tinygltf::Value& value = at->second.Get("emissiveStrength");
    if (value.IsNumber()) strength = value.GetNumberAsDouble();
  }
  const auto limited = [&](double factor) {
    return float(std::clamp(factor * strength, 0.0, double(kMostLight)));
  };
  material.emission = {limited(m.emissiveFactor[0]), limited(m.emissiveFactor[1]),
                       limited(m.emissiveFactor[2])};
  material.emission_textured = m.emissiveTexture.index >= 0;
}

void add_visibility(const tinygltf::Material& m, double opacity, RawMaterial& material) {
  material.opacity = float(std::clamp(opacity, 0.0, 1.0));
  material.alpha_mode = m.alphaMode == "MASK"    ? AlphaMode::mask
                        : m.alphaMode == "BLEND" ? AlphaMode::blend
                                                 : AlphaMode::opaque;
  material.alpha_cutoff = float(std::clamp(m.alphaCutoff, 0.0, 1e6));
  material.double_sided = m.doubleSided;
  material.unlit = m.extensions.contains("KHR_materials_unlit");
}

// KHR_texture_transform may name another set of texture coordinates than its texture does.
int texcoord_set(const tinygltf::TextureInfo& info) {
  const auto at = info.extensions.find("KHR_texture_transform");
  const bool given =
      at != info.extensions.end() && at->second.IsObject() && at->second.Get("texCoord").IsInt();
  return given ? at->second.Get("texCoord").GetNumberAsInt() : info.texCoord;
}

// KHR_texture_transform scales, rotates and moves coordinates whose v axis points down. Here v
// points up.
void add_transform(const tinygltf::TextureInfo& info, RawMaterial& material) {
  const auto at = info.extensions.find("KHR_texture_transform");
  if (at == info.extensions.end() || !at->second.IsObject()) return;
  const auto scale = numbers<2>(at->second, "scale", 1),
             offset = numbers<2>(at->second, "offset", 0);
  const tinygltf::Value& rotation = at->second.Get("rotation");
  const double angle = rotation.IsNumber() ? rotation.GetNumberAsDouble() : 0;
  const double c = std::cos(angle), s = std::sin(angle);
  material.uv_u = {c * scale[0], -s * scale[1], offset[0] + s * scale[1]};
  material.uv_v = {s * scale[0], c * scale[1], 1 - c * scale[1] - offset[1]};
}

// Shaders of WebGL, by either name of their extension, give their inputs any names, so the colour
// cannot be found among these.
void report_shaders(const tinygltf::Material& m, const std::string& name, SceneBuilder& builder) {
  for (const char* extension : {"KHR_techniques_webgl", "KHR_technique_webgl"})
    if (m.extensions.contains(extension))
      builder.defects.add(DefectKind::reflectance_unknown, [&] {
        return fmt::format("{}: material '{}' ({})", builder.file, name, extension);
      });
}

TextureWrap wrap_of(int mode) {
  if (mode == TINYGLTF_TEXTURE_WRAP_CLAMP_TO_EDGE) return TextureWrap::clamp;
  return mode == TINYGLTF_TEXTURE_WRAP_MIRRORED_REPEAT ? TextureWrap::mirror : TextureWrap::repeat;
}

void add_wraps(const tinygltf::Model& model, int texture, RawMaterial& material) {
  if (texture < 0 || std::size_t(texture) >= model.textures.size()) return;
  const int sampler = model.textures[texture].sampler;
  if (sampler < 0 || std::size_t(sampler) >= model.samplers.size()) return;
  material.wrap_u = wrap_of(model.samplers[sampler].wrapS);
  material.wrap_v = wrap_of(model.samplers[sampler].wrapT);
}

}  // namespace

Status add_gltf_materials(const tinygltf::Model& model, SceneBuilder& builder) {
  if (Status s = add_images(model, builder); !s.ok()) return s;
  for (std::size_t i = 0; i < model.materials.size(); ++i) {
    const tinygltf::Material& m = model.materials[i];
    const Diffuse diffuse = diffuse_of(m);
    RawMaterial material;
    material.name = m.name.empty() ? fmt::format("material{}", i) : m.name;
    material.diffuse = diffuse.colour;
    if (!is_reflectance(material.diffuse)) {
      builder.defects.add(DefectKind::reflectance_beyond_one, [&] {
        return fmt::format("{}: material '{}'", builder.file, material.name);
      });
    }
    report_shaders(m, material.name, builder);
    add_emission(m, material);
    add_visibility(m, diffuse.opacity, material);
    material.texture = image_of(model, diffuse.texture.index);
    if (diffuse.texture.index >= 0 && material.texture < 0 &&
        !keeps_image(model, diffuse.texture.index, builder)) {
      builder.defects.add(DefectKind::texture_unreadable, [&] {
        return fmt::format("{}: material '{}': its texture names no image of a kind that is read{}",
                           builder.file, material.name,
                           extensions_of(model, diffuse.texture.index));
      });
    }
    add_transform(diffuse.texture, material);
    add_wraps(model, diffuse.texture.index, material);
    material.uv_set = texcoord_set(diffuse.texture);
    builder.materials.push_back(std::move(material));
  }
  builder.materials.push_back({});
  return {};
}

}  // namespace atlas
