// glTF 2.0 and GLB of a scene that was read from glTF: the file as it was, with an additional set
// of uvs.
#include <fmt/format.h>

#include <algorithm>
#include <set>
#include <string>
#include <string_view>

#include "libatlas/exporters/gltf_kept/gltf_data.h"
#include "libatlas/exporters/gltf_kept/gltf_kept_instances.h"
#include "libatlas/exporters/gltf_kept/gltf_kept_materials.h"
#include "libatlas/exporters/gltf_kept/gltf_kept_meshes.h"
#include "libatlas/exporters/gltf_kept/gltf_kept_nodes.h"
#include "libatlas/exporters/gltf_kept/gltf_kept_rest.h"
#include "libatlas/exporters/gltf_kept/gltf_kept_unit.h"
#include "libatlas/exporters/writing/scene_writers.h"
#include "libatlas/exporters/writing/unify_vertices.h"
#include "libatlas/files/file_extension.h"

namespace atlas {
namespace fs = std::filesystem;
using nlohmann::json;
namespace {

constexpr std::string_view kTexcoord = "TEXCOORD_", kColours = "COLOR_", kFirstColours = "COLOR_0";

// Returns the numbers of the sets of uvs, or of what `kind` says, among the attributes.
std::set<std::int64_t> sets_of(const std::map<std::string, int>& attributes,
                               std::string_view kind = kTexcoord) {
  std::set<std::int64_t> sets;
  for (const auto& [name, accessor] : attributes) {
    const std::string number = name.starts_with(kind) ? name.substr(kind.size()) : "";
    const bool digits = number.find_first_not_of("0123456789") == std::string::npos;
    if (!number.empty() && number.size() <= 9 && digits) sets.insert(std::stoi(number));
  }
  return sets;
}

// Returns attributes without one of them. The format allows no set of colours without those before
// it, so those behind a COLOR_0 that is left out move up.
std::map<std::string, int> without_light(const std::map<std::string, int>& attributes,
                                         const std::string& light) {
  std::map<std::string, int> rest = attributes;
  rest.erase(light);
  if (light != kFirstColours) return rest;
  for (const std::int64_t set : sets_of(attributes, kColours)) {
    auto colours = rest.extract(fmt::format("{}{}", kColours, set));
    if (colours.empty()) continue;
    colours.key() = fmt::format("{}{}", kColours, set - 1);
    rest.insert(std::move(colours));
  }
  return rest;
}

// Returns the uv sets that any primitive shown has.
std::set<std::int64_t> shown_sets(const GltfSource& source) {
  std::set<std::int64_t> sets;
  for (const GltfPlace& place : source.places)
    for (const GltfShownPrimitive& shown : place.primitives)
      sets.merge(sets_of(source.model.meshes[std::size_t(place.mesh)]
                             .primitives[std::size_t(shown.primitive)]
                             .attributes));
  return sets;
}

// Returns the first uv set after TEXCOORD_0 that no primitive shown has. It is the same for the
// whole file, because engines select it by its number.
std::int64_t free_set(const std::set<std::int64_t>& taken) {
  std::int64_t free = 1;
  while (taken.contains(free)) ++free;
  return free;
}

std::string texcoord_name(std::int64_t set) {
  return fmt::format("{}{}", kTexcoord, set);
}

class FileWriter {
 public:
  FileWriter(const World& world, const fs::path& path, GltfDocument& document)
      : world_(world),
        path_(path),
        scene_(*world.scene),
        source_(*scene_.source),
        document_(document),
        data_(source_, document),
        materials_(source_, document.json, losses_),
        had_sets_(shown_sets(source_)),
        set_(world.uv_set > 0 ? world.uv_set : free_set(had_sets_)),
        map_set_(lightmap_set(source_.document)) {
    json asset = std::move(document_.json["asset"]);
    document_.json = source_.document;
    for (const char* list : {"accessors", "bufferViews", "extensionsUsed", "extensionsRequired"})
      document_.json.erase(list);
    document_.json["asset"] = std::move(asset);
  }

  Status run(GltfTextures& textures, const Context& context, WorldFile& result) {
    if (Status s = check_triangles(); !s.ok()) return s;
    if (positions_mark(scene_) != source_.positions_mark) return other_positions();
    if (Status s = materials_.write_images(textures); !s.ok()) return s;
    const bool once = world_.instances.has_value();
    if (once && !world_.instances->empty() && world_.instances->size() != source_.places.size())
      return {ErrorCode::bad_input, fmt::format("the world has {} instances, its scene {}",
                                                world_.instances->size(), source_.places.size())};
    const std::vector<std::size_t> numbers = number_kept_meshes(source_, once);
    const std::set<std::size_t> own(numbers.begin(), numbers.end());
    const std::size_t count = source_.model.meshes.size();
    json meshes = json::array();
    for (std::size_t m = 0; m < std::max(count, own.empty() ? 0 : *own.rbegin() + 1); ++m)
      meshes.push_back(own.contains(m) ? json::object() : unchanged_mesh(m));
    for (std::size_t p = 0; p < numbers.size(); ++p) {
      if (context.cancelled()) return Status::cancelled();
      if (meshes[numbers[p]].empty())  // else another place has it already
        meshes[numbers[p]] = mesh_of(source_.places[p], result);
      context.report("writing the world", double(p + 1) / double(numbers.size()));
    }
    document_.json["meshes"] = std::move(meshes);
    const std::vector<std::size_t> holders =
        place_kept_meshes(world_, numbers, document_.json, losses_);
    if (world_.metres_per_unit != 1)
      scale_kept_lengths(world_.metres_per_unit, document_.json, losses_);
    drop_empty_meshes(document_.json, losses_);
    keep_rest(source_, data_, document_.json, losses_);
    if (once) name_instances(world_, holders, document_, losses_);
    name_asset();
    result.uv_set = texcoord_name(set_);
    document_.add_info("the new uvs: " + result.uv_set);
    if (left_out_colours_) count_vertex_alpha(scene_, losses_);
    result.not_kept = losses_.lines();
    result.meshes_without_uvs = meshes_without_uvs_;
    return {};
  }

 private:
  using Key = std::array<std::uint32_t, 2>;  // vertex of the primitive, uv

  // Adds to what is known of the new uvs what the source says of itself.
  void name_asset() {
    std::set<std::int64_t> new_sets;
    for (std::int64_t set = 0; set <= set_; ++set)
      if (!own_sets_.contains(set)) new_sets.insert(set);
    document_.name_uv_sets(new_sets);
    document_.name_lightmap(world_, set_);
    json& asset = document_.json["asset"];
    asset = merge_assets(source_.document.value("asset", json()), asset, new_sets);
    if (!world_.lightmap) count_absent_images(asset, path_, losses_);
  }

  const tinygltf::Mesh& model_mesh(std::size_t mesh) const { return source_.model.meshes[mesh]; }

  json primitive_json(std::size_t mesh, std::size_t primitive) const {
    return source_.document["meshes"][mesh]["primitives"][primitive];
  }

  // Returns a copy of a mesh that gets no new uvs: it is not shown, or its number is kept for nodes
  // that are not shown.
  json unchanged_mesh(std::size_t number) {
    json mesh = source_.document["meshes"][number];
    mesh["primitives"] = json::array();
    for (std::size_t p = 0; p < model_mesh(number).primitives.size(); ++p)
      add_unchanged(number, p, mesh);
    if (!mesh["primitives"].empty()) ++meshes_without_uvs_;
    return mesh;
  }

  void add_unchanged(std::size_t mesh, std::size_t number, json& to) {
    json primitive = primitive_json(mesh, number);
    if (unchanged(primitive))
      to["primitives"].push_back(std::move(primitive));
    else
      losses_.add("primitives whose data cannot be read");
  }

  // Copies the primitive's accessors unchanged. Returns false if one cannot be copied.
  bool unchanged(json& primitive) {
    bool whole = true;
    const auto copy_all = [&](json& attributes) {
      if (!attributes.is_object()) return false;
      for (auto& [name, number] : attributes.items()) {
        const auto copied =
            number.is_number_integer() ? data_.accessor(number.get<std::int64_t>()) : std::nullopt;
        if (copied) number = *copied;
        whole &= copied.has_value();
      }
      return whole;
    };
    if (!copy_all(primitive["attributes"])) return false;
    if (primitive.contains("indices") && !data_.renumber(primitive, "indices")) return false;
    if (const auto targets = primitive.find("targets");
        targets != primitive.end() && targets->is_array())
      for (json& target : *targets) whole = copy_all(target) && whole;
    drop_data_extensions(primitive, losses_);
    return whole;
  }

  json mesh_of(const GltfPlace& place, WorldFile& result) {
    const auto number = static_cast<std::size_t>(place.mesh);
    json mesh = source_.document["meshes"][number];
    mesh["primitives"] = json::array();
    std::size_t next = 0;  // primitives that are not shown are points and lines
    for (const GltfShownPrimitive& shown : place.primitives) {
      for (; next < std::size_t(shown.primitive); ++next) add_unchanged(number, next, mesh);
      next = std::size_t(shown.primitive) + 1;
      if (shown.triangles == 0) continue;  // all its triangles were defects
      add_primitive(number, shown, mesh, result);
    }
    for (; next < model_mesh(number).primitives.size(); ++next) add_unchanged(number, next, mesh);
    drop_data_extensions(mesh, losses_);
    return mesh;
  }

  // Returns the scene's corner for corner k of the primitive, where k counts 3 per triangle in the
  // file's own order.
  static std::size_t corner_of(const GltfShownPrimitive& shown, std::size_t k) {
    return 3 * (shown.first_triangle + k / 3) + (shown.mirrored ? 2 - k % 3 : k % 3);
  }

  static Status other_triangles() {
    return {ErrorCode::bad_input,
            "the scene to keep is not as it was read: its triangles are other ones (give it no "
            "Scene::source)"};
  }

  // The file's positions are written, relative to nodes and joints that move them. Those of the
  // scene cannot be written in their place.
  static Status other_positions() {
    return {ErrorCode::bad_input,
            "the scene to keep is not as it was read: Scene::positions or Scene::origin has "
            "changed, but its glTF file would be written with its own positions (move its nodes "
            "instead, or set Scene::source to null: then the scene's arrays are written, and what "
            "only the file holds is counted as not kept)"};
  }

  // Refuses a scene whose triangles are not those that were read.
  Status check_triangles() const {
    std::size_t triangles = 0;
    for (const GltfPlace& place : source_.places) {
      for (const GltfShownPrimitive& shown : place.primitives) {
        const std::size_t end = 3 * (shown.first_triangle + shown.triangles);
        if (end > scene_.indices.size()) return other_triangles();
        for (std::size_t k = 3 * shown.first_triangle; k < end; ++k)
          if (scene_.indices[k] - shown.first_position >= shown.positions) return other_triangles();
        triangles += shown.triangles;
      }
    }
    return triangles == scene_.triangle_count() ? Status() : other_triangles();
  }

  UnifiedMesh<2> unify(const GltfShownPrimitive& shown) {
    return unify_vertices<2>(3 * shown.triangles, [&](std::size_t k) {
      const std::size_t corner = corner_of(shown, k);
      return Key{static_cast<std::uint32_t>(scene_.indices[corner] - shown.first_position),
                 world_.pages[0].uv_indices[corner]};
    });
  }

  // Adds a primitive with the new uvs, or one for each page of the lightmap that it is on. These
  // share the vertices.
  void add_primitive(std::size_t mesh, const GltfShownPrimitive& shown, json& to,
                     WorldFile& result) {
    const UnifiedMesh<2> unified = unify(shown);
    const json primitive = primitive_of(mesh, shown, unified.vertices);
    std::map<std::uint32_t, std::vector<std::uint32_t>> pages;
    for (std::size_t k = 0; k < unified.indices.size(); ++k)
      pages[page_of(shown.first_triangle + k / 3)].push_back(unified.indices[k]);
    for (const auto& [page, indices] : pages) {
      json part = primitive;
      part["indices"] = data_.indices(indices);
      name_lightmap_page(world_, page, part);
      to["primitives"].push_back(std::move(part));
    }
    result.triangles += shown.triangles;
    result.vertices += unified.vertices.size();
    result.uvs += unified.vertices.size();
  }

  std::uint32_t page_of(std::size_t triangle) const {
    const bool several = world_.lightmap && !world_.lightmap->triangle_page.empty();
    return several ? world_.lightmap->triangle_page[triangle] : 0;
  }

  // Returns a primitive without indices.
  json primitive_of(std::size_t mesh, const GltfShownPrimitive& shown,
                    const std::vector<Key>& keys) {
    const auto number = static_cast<std::size_t>(shown.primitive);
    const tinygltf::Primitive& from = model_mesh(mesh).primitives[number];
    std::vector<std::uint32_t> vertices;
    for (const Key& key : keys) vertices.push_back(key[0]);
    json primitive = primitive_json(mesh, number);
    for (const char* key : {"mode", "attributes", "indices", "targets", "material"})
      primitive.erase(key);
    const std::string light = light_on_map(from);
    const auto kept = [&light](const std::map<std::string, int>& attributes) {
      return without_light(attributes, light);
    };
    primitive["attributes"] = attributes(kept(from.attributes), vertices);
    for (const auto& target : from.targets)
      primitive["targets"].push_back(morph_target(kept(target), vertices));
    const auto sets = sets_of(rows_names(primitive["attributes"]));
    // Textures that used the uvs which are replaced are now those of the new ones.
    auto usable = sets;
    if (sets_of(from.attributes).contains(set_)) usable.insert(set_);
    if (const auto material = materials_.material(from.material, usable))
      primitive["material"] = *material;
    add_uvs(keys, sets, primitive["attributes"]);
    keep_lightmap_page(sets, primitive);
    add_light(shown, vertices, primitive["attributes"]);
    drop_data_extensions(primitive, losses_);
    return primitive;
  }

  // Returns the attribute whose values are on the lightmap and left out here: viewers multiply base
  // colours by COLOR_0. Colours of unlit materials are no light. Empty: there is none.
  std::string light_on_map(const tinygltf::Primitive& from) {
    if (!world_.lightmap || source_.other_light) return "";
    if (from.attributes.contains("_ILLUMINANCE")) return "_ILLUMINANCE";
    const auto& materials = source_.model.materials;
    const auto material = static_cast<std::size_t>(from.material);
    const bool unlit = from.material >= 0 && material < materials.size() &&
                       materials[material].extensions.contains("KHR_materials_unlit");
    if (unlit || !from.attributes.contains(std::string(kFirstColours))) return "";
    left_out_colours_ = true;
    return std::string(kFirstColours);
  }

  json attributes(const std::map<std::string, int>& from,
                  const std::vector<std::uint32_t>& vertices) {
    return rows_of(from, vertices, "attributes that are shorter than their positions");
  }

  json rows_of(const std::map<std::string, int>& attributes,
               const std::vector<std::uint32_t>& vertices, const char* loss) {
    json result = json::object();
    std::map<int, std::size_t>
        uvs;  // sets that refer to the same data still do: readers rely on it
    for (const auto& [name, accessor] : attributes) {
      if (name == texcoord_name(set_)) continue;  // replaced
      const bool is_uv = name.starts_with("TEXCOORD_");
      if (const auto same = uvs.find(accessor); is_uv && same != uvs.end())
        result[name] = same->second;
      else if (const auto rows = data_.rows(accessor, vertices, name == "POSITION"))
        result[name] = *rows;
      else
        losses_.add(loss);
      if (is_uv && result.contains(name)) uvs.emplace(accessor, result[name]);
    }
    return result;
  }

  // A morph target moves the uvs that are replaced, not the new ones. The format allows no empty
  // target, and meshes have a weight for each, so one that did nothing else moves nothing.
  json morph_target(const std::map<std::string, int>& target,
                    const std::vector<std::uint32_t>& vertices) {
    losses_.add("uvs of morph targets, replaced", target.contains(texcoord_name(set_)));
    json result = rows_of(target, vertices, "data of morph targets");
    if (result.empty()) result["POSITION"] = document_.add_zeros(vertices.size());
    return result;
  }

  static std::map<std::string, int> rows_names(const json& attributes) {
    std::map<std::string, int> names;
    for (const auto& [name, accessor] : attributes.items()) names[name] = 0;
    return names;
  }

  // The format allows no uv set without those before it, so the sets that the primitive lacks refer
  // to the new uvs, too.
  void add_uvs(const std::vector<Key>& vertices, const std::set<std::int64_t>& own, json& to) {
    const std::size_t uvs = document_.add_uvs(gather(world_.uvs, vertices, 1));
    own_sets_.insert(own.begin(), own.end());
    for (std::int64_t set = 0; set <= set_; ++set)
      if (!own.contains(set)) to[texcoord_name(set)] = uvs;
  }

  // Keeps the page that the primitive has on an earlier export's lightmap, as long as there is one.
  // If the primitive is on none, because it lacked that set, the new uvs are there now and would be
  // taken for a place on a page.
  void keep_lightmap_page(const std::set<std::int64_t>& own, json& primitive) const {
    if (world_.lightmap || map_set_ == set_) return drop_lightmap_page(primitive);
    const bool filled = map_set_ >= 0 && map_set_ < set_ && !own.contains(map_set_);
    if (filled && had_sets_.contains(map_set_)) set_lightmap_page(-1, primitive);
  }

  // Adds light that came from another file, beside the primitive's own attributes.
  void add_light(const GltfShownPrimitive& shown, const std::vector<std::uint32_t>& vertices,
                 json& to) {
    if (!source_.other_light || !scene_.lit() || world_.lightmap) return;
    std::vector<Vec3f> light;
    for (const std::uint32_t v : vertices)
      light.push_back(scene_.illumination[shown.first_position + v]);
    to["_ILLUMINANCE"] = document_.add_vectors(light);
  }

  const World& world_;
  const fs::path& path_;
  const Scene& scene_;
  const GltfSource& source_;
  GltfDocument& document_;
  Losses losses_;
  GltfData data_;
  KeptMaterials materials_;
  const std::set<std::int64_t> had_sets_;  // uv sets that any primitive shown has in the source
  const std::int64_t set_;                 // number of the new uv set
  const std::int64_t map_set_;             // that of an earlier export's lightmap, or -1
  std::set<std::int64_t> own_sets_;        // those that any primitive shown keeps
  bool left_out_colours_ = false;          // COLOR_0 of any primitive
  std::size_t meshes_without_uvs_ = 0;
};

}  // namespace

Result<WorldFile> write_gltf_file(const World& world, const fs::path& path, AtomicFiles& files,
                                  const Context& context) {
  WorldFile result;
  GltfDocument document(world, lower_extension(path) == ".glb");
  GltfTextures textures(*world.scene, path, document, files);
  FileWriter writer(world, path, document);
  if (Status s = writer.run(textures, context, result); !s.ok()) return s;
  if (Status s = document.write(path, files, result); !s.ok()) return s;
  return result;
}

}  // namespace atlas
