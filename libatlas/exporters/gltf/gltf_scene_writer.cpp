// glTF 2.0 and GLB of a scene with atlas coordinates: one mesh per object, one primitive per
// material.
#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <set>
#include <string>
#include <tuple>
#include <utility>

#include "libatlas/exporters/gltf/gltf_document.h"
#include "libatlas/exporters/gltf/gltf_textures.h"
#include "libatlas/exporters/writing/far_origin.h"
#include "libatlas/exporters/writing/scene_parts.h"
#include "libatlas/exporters/writing/scene_writers.h"
#include "libatlas/exporters/writing/unify_vertices.h"
#include "libatlas/files/file_extension.h"
#include "libatlas/scene/building/losses.h"

namespace atlas {
namespace fs = std::filesystem;
using nlohmann::json;
namespace {

// Returns whether the material's emission is written. If a texture modulates it, it is left out:
// the texture is not read, and without it the whole surface would glow.
bool keeps_emission(const Material& material) {
  return material.emission != Vec3f{} && !material.emission_textured;
}

// glTF's factors are at most 1; stronger emission needs an extension.
void add_emission(const Material& material, json& entry) {
  const Vec3f& e = material.emission;
  const float strength = std::max({1.f, e.x, e.y, e.z});
  entry["emissiveFactor"] = {e.x / strength, e.y / strength, e.z / strength};
  if (strength > 1)
    entry["extensions"]["KHR_materials_emissive_strength"]["emissiveStrength"] = strength;
}

// Returns a material without its texture.
json look_of(const Material& material) {
  const Vec3f& d = material.diffuse;
  json surface = {{"metallicFactor", 0}, {"roughnessFactor", 1}};
  if (d != Vec3f{1, 1, 1} || material.opacity != 1)
    surface["baseColorFactor"] = {std::clamp(d.x, 0.f, 1.f), std::clamp(d.y, 0.f, 1.f),
                                  std::clamp(d.z, 0.f, 1.f), material.opacity};
  json entry = {{"pbrMetallicRoughness", std::move(surface)}};
  if (keeps_emission(material)) add_emission(material, entry);
  if (material.unlit) entry["extensions"]["KHR_materials_unlit"] = json::object();
  if (!material.name.empty()) entry["name"] = material.name;
  if (material.double_sided) entry["doubleSided"] = true;
  if (material.alpha_mode == AlphaMode::blend) entry["alphaMode"] = "BLEND";
  if (material.alpha_mode == AlphaMode::mask) {
    entry["alphaMode"] = "MASK";
    entry["alphaCutoff"] = material.alpha_cutoff;
  }
  return entry;
}

// Writes those of the scene's materials and textures that are used, each once.
class MaterialWriter {
 public:
  MaterialWriter(const World& world, GltfDocument& document, GltfTextures& textures)
      : scene_(*world.scene), document_(document), files_(textures) {}

  // Returns the number of the part's material in the document. If the part has no texture
  // coordinates, the texture is left out: a reader would use none, while a viewer would show one of
  // its texels.
  Result<std::size_t> material(const ScenePart& part) {
    const Material& material = scene_.materials[part.material];
    const bool textured = part.texcoords && material.texture >= 0;
    const auto [at, is_new] = materials_.try_emplace({part.material, textured}, materials_.size());
    if (!is_new) return at->second;
    json entry = look_of(material);
    if (textured) {
      auto number = texture(material);
      if (!number.ok()) return number.status();
      entry["pbrMetallicRoughness"]["baseColorTexture"] = {{"index", *number}};
    }
    if (const auto list = entry.find("extensions"); list != entry.end())
      for (const auto& [name, extension] : list->items()) document_.use(name.c_str());
    document_.json["materials"].push_back(std::move(entry));
    return at->second;
  }

 private:
  // Returns the number of a texture. There is one for each image and pair of wrap modes.
  Result<std::size_t> texture(const Material& material) {
    const auto key = std::tuple(material.texture, material.wrap_u, material.wrap_v);
    const auto [at, is_new] = textures_.try_emplace(key, textures_.size());
    if (!is_new) return at->second;
    auto source = image(std::size_t(material.texture));
    if (!source.ok()) return source.status();
    document_.json["textures"].push_back(
        {{"sampler", sampler(material.wrap_u, material.wrap_v)}, {"source", *source}});
    return at->second;
  }

  Result<std::size_t> image(std::size_t index) {
    const auto [at, is_new] = images_.try_emplace(index, images_.size());
    if (!is_new) return at->second;
    auto image = files_.image(index, index);
    if (!image.ok()) return image.status();
    document_.json["images"].push_back(std::move(*image));
    return at->second;
  }

  // Returns the number of a sampler. Repeating is the default, so it has no entry.
  std::size_t sampler(TextureWrap u, TextureWrap v) {
    const auto [at, is_new] = samplers_.try_emplace({u, v}, samplers_.size());
    if (!is_new) return at->second;
    json entry = {{"magFilter", kLinear}, {"minFilter", kLinearMipmapLinear}};
    for (const auto& [name, wrap] : {std::pair("wrapS", u), std::pair("wrapT", v)}) {
      if (wrap == TextureWrap::clamp) entry[name] = kClampToEdge;
      if (wrap == TextureWrap::mirror) entry[name] = kMirroredRepeat;
    }
    document_.json["samplers"].push_back(std::move(entry));
    return at->second;
  }

  const Scene& scene_;
  GltfDocument& document_;
  GltfTextures& files_;
  std::map<std::pair<std::uint32_t, bool>, std::size_t> materials_;  // with or without texture
  std::map<std::tuple<std::int32_t, TextureWrap, TextureWrap>, std::size_t> textures_;
  std::map<std::size_t, std::size_t> images_;
  std::map<std::pair<TextureWrap, TextureWrap>, std::size_t> samplers_;
};

constexpr const char* kColours = "COLOR_0";

// Returns the attribute that holds the vertices' light. Values within 0 to 1 are a colour to
// viewers; for others, the attribute has a name of this library's own.
const char* light_attribute(const std::vector<Vec3f>& light) {
  const auto is_colour = [](const Vec3f& v) {
    return std::min({v.x, v.y, v.z}) >= 0 && std::max({v.x, v.y, v.z}) <= 1;
  };
  return std::all_of(light.begin(), light.end(), is_colour) ? kColours : "_ILLUMINANCE";
}

// Returns whether alpha of the vertices is written: it needs colours beside it, which are white
// with a lightmap.
bool holds_alpha(const World& world) {
  const Scene& scene = *world.scene;
  return scene.lit() && !scene.vertex_opacity.empty() &&
         (world.lightmap || light_attribute(scene.illumination) == kColours);
}

class SceneWriter {
 public:
  SceneWriter(const World& world, GltfDocument& document)
      : world_(world),
        scene_(*world.scene),
        document_(document),
        texcoord_(first_equals(scene_.texcoords)),
        normal_(first_equals(scene_.normals)),
        light_(light_attribute(scene_.illumination)),
        writes_alpha_(holds_alpha(world)) {}

  // Adds the part as a primitive to its object's mesh.
  void add(const ScenePart& part, std::size_t material, WorldFile& result) {
    const auto unified = unify_vertices<4>(3 * part.triangles.size(), [&](std::size_t k) {
      const std::size_t corner = 3 * std::size_t(part.triangles[k / 3]) + k % 3;
      return Key{scene_.indices[corner], world_.pages[0].uv_indices[corner],
                 part.texcoords ? texcoord_[scene_.texcoord_indices[corner]] : 0,
                 part.normals ? normal_[scene_.normal_indices[corner]] : 0};
    });
    json primitive = {{"material", material}};
    primitive["attributes"] = attributes(part, unified.vertices);
    primitive["indices"] = document_.add_indices(unified.indices);
    name_lightmap_page(world_, part.page, primitive);
    mesh_of(part.object)["primitives"].push_back(std::move(primitive));
    result.triangles += part.triangles.size();
    result.vertices += unified.vertices.size();
    result.uvs += unified.vertices.size();
  }

  // Returns the sets that hold the new uvs in all parts; to be called when all are added.
  std::set<std::int64_t> new_sets() const {
    std::set<std::int64_t> sets;
    for (std::int64_t set = own_uvs_ ? 1 : 0; set <= last_set(); ++set) sets.insert(set);
    return sets;
  }

  // Returns the number of the set that is printed as that of the new uvs.
  std::int64_t last_set() const { return std::max(1, world_.uv_set); }

  // Adds the nodes; to be called when all meshes are known. If up axis, unit and origin are as glTF
  // requires, no node above the objects is needed.
  void add_nodes(WorldFile& result) {
    json& file = document_.json;
    result.far_origin = too_far_for_floats(world_);
    const bool as_is =
        world_.up == Up::y && world_.metres_per_unit == 1 && world_.origin == Vec3d{};
    const std::size_t first = as_is ? 0 : 1;
    json list = json::array();
    for (std::size_t i = 0; i < file["meshes"].size(); ++i) list.push_back(first + i);
    file["nodes"] = json::array();
    if (!as_is) {
      file["nodes"].push_back(gltf_root(world_, result.far_origin ? Vec3d{} : world_.origin));
      file["nodes"][0]["children"] = std::exchange(list, json::array({0}));
    }
    for (std::size_t i = 0; i < file["meshes"].size(); ++i) {
      json node = {{"mesh", i}};
      if (file["meshes"][i].contains("name")) node["name"] = file["meshes"][i]["name"];
      file["nodes"].push_back(std::move(node));
    }
    if (result.far_origin) {
      const std::size_t above = file["nodes"].size();
      file["nodes"].push_back(gltf_far_origin(world_, std::exchange(list, json::array({above}))));
    }
    file["scenes"] = json::array({{{"nodes", std::move(list)}}});
    file["scene"] = 0;
  }

 private:
  using Key = std::array<std::uint32_t, 4>;  // position, uv, texture coordinate, normal

  // Engines look for light maps in the second uv set. glTF has no second set without a first, so a
  // part without uvs of its own refers to the new ones in both.
  json attributes(const ScenePart& part, const std::vector<Key>& vertices) {
    own_uvs_ |= part.texcoords;
    json result;
    result["POSITION"] = document_.add_positions(gather(world_.positions, vertices, 0));
    if (part.normals) result["NORMAL"] = document_.add_vectors(gather(scene_.normals, vertices, 3));
    add_light(vertices, result);
    result["TEXCOORD_1"] = document_.add_uvs(gather(world_.uvs, vertices, 1));
    for (std::int64_t set = 2; set <= last_set(); ++set)
      result[fmt::format("TEXCOORD_{}", set)] = result["TEXCOORD_1"];
    result["TEXCOORD_0"] = part.texcoords
                               ? json(document_.add_uvs(gather(scene_.texcoords, vertices, 2)))
                               : result["TEXCOORD_1"];
    return result;
  }

  // Readers use 0 for vertices without light in a scene where others have some. Viewers would draw
  // them black, so a part whose vertices all have 0 and are opaque gets no light.
  void add_light(const std::vector<Key>& vertices, json& to) {
    if (!scene_.lit()) return;
    const std::vector<Vec3f> light = world_.lightmap
                                         ? std::vector<Vec3f>(vertices.size(), Vec3f{1, 1, 1})
                                         : gather(scene_.illumination, vertices, 0);
    if (writes_alpha_) {
      const std::vector<float> alpha = gather(scene_.vertex_opacity, vertices, 0);
      if (std::any_of(alpha.begin(), alpha.end(), [](float a) { return a != 1; })) {
        to[kColours] = document_.add_colours(light, alpha);
        return;
      }
    }
    if (world_.lightmap) return;
    const bool any = std::any_of(light.begin(), light.end(), [](auto& v) { return v != Vec3f{}; });
    if (any) to[light_] = document_.add_vectors(light);
  }

  // Returns the object's mesh. Parts are added object by object, so it is the last mesh or a new
  // one.
  json& mesh_of(std::uint32_t object) {
    json& meshes = document_.json["meshes"];
    if (meshes.empty() || object != object_) {
      meshes.push_back({{"primitives", json::array()}});
      if (object < scene_.object_names.size() && !scene_.object_names[object].empty())
        meshes.back()["name"] = scene_.object_names[object];
    }
    object_ = object;
    return meshes.back();
  }

  const World& world_;
  const Scene& scene_;
  GltfDocument& document_;
  std::vector<std::uint32_t> texcoord_, normal_;  // index of the first equal value
  const char* light_;                             // name of the light's attribute
  bool writes_alpha_;                             // whether parts that are not opaque have it
  std::uint32_t object_ = 0;                      // the object of the last mesh
  bool own_uvs_ = false;                          // whether any part has uvs of its own
};

// Counts what is lost: what an MTL says of materials and this file does not, what the reader left
// in the scene's file, and colours that exceed glTF's range.
std::vector<std::string> losses_of(const World& world) {
  const Scene& scene = *world.scene;
  Losses losses;
  losses.add(scene.not_read);
  if (!holds_alpha(world)) count_vertex_alpha(scene, losses);
  for (const Material& material : scene.materials) {
    losses.add("colours of materials beyond 0 to 1, limited to it",
               !is_reflectance(material.diffuse));
    count_mtl_losses(material, losses);
  }
  return losses.lines();
}

}  // namespace

Result<WorldFile> write_gltf_scene(const World& world, const fs::path& path, AtomicFiles& files,
                                   const Context& context) {
  WorldFile result;
  GltfDocument document(world, lower_extension(path) == ".glb");
  GltfTextures textures(*world.scene, path, document, files);
  MaterialWriter materials(world, document, textures);
  SceneWriter writer(world, document);
  const std::vector<ScenePart> parts =
      world.lightmap ? scene_parts(*world.scene, world.lightmap->triangle_page)
                     : scene_parts(*world.scene);
  for (std::size_t i = 0; i < parts.size(); ++i) {
    if (context.cancelled()) return Status::cancelled();
    auto material = materials.material(parts[i]);
    if (!material.ok()) return material.status();
    writer.add(parts[i], *material, result);
    context.report("writing the world", double(i + 1) / double(parts.size()));
  }
  writer.add_nodes(result);
  result.uv_set = fmt::format("TEXCOORD_{}", writer.last_set());
  document.name_uv_sets(writer.new_sets());
  document.name_lightmap(world, writer.last_set());
  document.add_info("the new uvs: " + result.uv_set);
  result.not_kept = losses_of(world);
  if (Status s = document.write(path, files, result); !s.ok()) return s;
  return result;
}

}  // namespace atlas
