#include "libatlas/scene/gltf/gltf_draco.h"

#include <fmt/format.h>

#include <algorithm>
#include <limits>
#include <map>
#include <optional>
#include <utility>

#include "libatlas/scene/gltf/draco_mesh.h"
#include "libatlas/scene/gltf/gltf_check.h"

namespace atlas {
namespace fs = std::filesystem;
namespace {

using nlohmann::json;

constexpr int kUnsignedInt = TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT;

// Returns the index that an object has under a key if the list in the document has such an element.
std::optional<std::size_t> element(const json& document, const char* list, const json& object,
                                   const char* key) {
  const std::int64_t i = integer_at(object, key, -1);
  if (i < 0 || std::size_t(i) >= length_at(document, list)) return {};
  return static_cast<std::size_t>(i);
}

const json* draco_of(const json& primitive) {
  return primitive.is_object() ? extension_at(primitive, kGltfDraco) : nullptr;
}

class Describer {
 public:
  Describer(json& document, std::vector<GltfDracoPart>& parts)
      : document_(document), parts_(parts) {}

  // Returns what is wrong with the description, or an empty text.
  std::string add(json& primitive, std::string name) {
    const json draco = *draco_of(primitive);
    if (!draco.is_object()) return "is not an object";
    const json attributes = draco.value("attributes", json::object());
    if (!attributes.is_object()) return "has no list of attributes";
    if (!primitive.value("attributes", json()).is_object()) return "has no attributes to fill";
    if (!needed(primitive, attributes)) return {};
    const std::int64_t mode = integer_at(primitive, "mode", TINYGLTF_MODE_TRIANGLES);
    if (mode != TINYGLTF_MODE_TRIANGLES && mode != TINYGLTF_MODE_TRIANGLE_STRIP)
      return "has no triangles";
    const auto view = element(document_, "bufferViews", draco, "bufferView");
    if (!view) return "has no bufferView";
    if (!attributes.contains("POSITION") && !plain(primitive["attributes"], "POSITION"))
      return "has no id of POSITION";
    GltfDracoPart part{std::move(name), *view, {}, {}};
    for (const auto& [key, id] : attributes.items()) {
      if (!id.is_number_unsigned() || id > std::numeric_limits<std::uint32_t>::max())
        return fmt::format("has an id of {} that is no whole number", key);
      std::string wrong = target(primitive["attributes"], key, id.get<std::uint32_t>(), part);
      if (!wrong.empty()) return wrong;
    }
    // The data are triangles, also if the file would have them shown as a strip.
    primitive["mode"] = TINYGLTF_MODE_TRIANGLES;
    if (!primitive.contains("indices")) {
      primitive["indices"] = length_at(document_, "accessors");
      document_["accessors"].push_back({{"type", "SCALAR"}, {"count", 1}});
    }
    std::string wrong = target(primitive, "indices", {}, part);
    if (!wrong.empty()) return wrong;
    primitive["extensions"].erase(kGltfDraco);
    if (primitive["extensions"].empty()) primitive.erase("extensions");
    const bool filled_by_others = part.attributes.empty() && part.indices.empty();
    if (!filled_by_others) parts_.push_back(std::move(part));
    return {};
  }

 private:
  using Content = std::pair<std::size_t, std::optional<std::uint32_t>>;  // compressed view, id

  bool plain(const json& holder, const std::string& key) const {
    const auto accessor = element(document_, "accessors", holder, key.c_str());
    if (!accessor || contents_.contains(*accessor)) return false;
    const json& a = document_["accessors"][*accessor];
    return a.contains("bufferView") || a.contains("sparse");
  }

  // Returns whether something exists only in compressed form.
  bool needed(const json& primitive, const json& attributes) const {
    if (primitive.contains("indices") && !plain(primitive, "indices")) return true;
    if (!plain(primitive["attributes"], "POSITION")) return true;
    for (const auto& [key, id] : attributes.items())
      if (!plain(primitive["attributes"], key)) return true;
    return false;
  }

  // Gives the accessor that an object has under a key a view for what will be decoded. Primitives
  // may share accessors, but these can stand for one thing only.
  std::string target(const json& holder, const std::string& key, std::optional<std::uint32_t> id,
                     GltfDracoPart& part) {
    const auto accessor = element(document_, "accessors", holder, key.c_str());
    if (!accessor) return fmt::format("has no accessor for {}", key);
    const auto [at, is_new] = contents_.try_emplace(*accessor, part.view, id);
    if (!is_new && at->second != Content(part.view, id))
      return fmt::format("shares accessor {} with other compressed data", *accessor);
    if (!is_new) return {};
    const std::size_t view = document_["bufferViews"].size();
    const json compressed = document_["bufferViews"][part.view];
    document_["bufferViews"].push_back(
        {{"buffer", compressed.value("buffer", json(0))}, {"byteLength", 1}});
    json& a = document_["accessors"][*accessor];
    for (const char* old : {"byteOffset", "sparse"}) a.erase(old);
    a["bufferView"] = view;
    if (!id) a["componentType"] = kUnsignedInt;
    (id ? part.attributes : part.indices).push_back({id.value_or(0), *accessor, view});
    return {};
  }

  json& document_;
  std::vector<GltfDracoPart>& parts_;
  std::map<std::size_t, Content> contents_;  // of accessors
};

// Removes the extension from the lists of those that are used, once no primitive has it.
void drop_from_lists(json& document) {
  for (const json& mesh : document["meshes"])
    for (const json& primitive : mesh.value("primitives", json::array()))
      if (draco_of(primitive)) return;
  for (const char* name : {"extensionsUsed", "extensionsRequired"}) {
    const auto list = document.find(name);
    if (list == document.end() || !list->is_array()) continue;
    list->erase(std::remove(list->begin(), list->end(), json(kGltfDraco)), list->end());
    if (list->empty()) document.erase(name);
  }
}

// Puts decoded bytes where the target's view and accessor say, and makes these fit them.
class Filler {
 public:
  Filler(tinygltf::Model& model, json* document) : model_(model), document_(document) {}

  void fill(const GltfDracoPart::Target& target, std::size_t count,
            std::vector<unsigned char> bytes) {
    tinygltf::BufferView& view = model_.bufferViews[target.view];
    view.buffer = static_cast<int>(model_.buffers.size());
    view.byteOffset = 0;
    view.byteLength = bytes.size();
    model_.buffers.emplace_back().data = std::move(bytes);
    model_.accessors[target.accessor].count = count;
    if (document_) (*document_)["accessors"][target.accessor]["count"] = count;
  }

  void set_stride(const GltfDracoPart::Target& target, std::size_t stride) {
    model_.bufferViews[target.view].byteStride = stride;
    if (document_) (*document_)["bufferViews"][target.view]["byteStride"] = stride;
  }

 private:
  tinygltf::Model& model_;
  json* document_;
};

// Describes the rows that an accessor asks for, each padded to four bytes, as the format requires.
// Their stride is 0 if Draco cannot hold such values.
DracoRows rows_for(const tinygltf::Model& model, const GltfDracoPart::Target& target) {
  const tinygltf::Accessor& a = model.accessors[target.accessor];
  const int size = tinygltf::GetComponentSizeInBytes(static_cast<std::uint32_t>(a.componentType));
  const int components = tinygltf::GetNumComponentsInType(static_cast<std::uint32_t>(a.type));
  DracoRows rows{target.id, 0, a.componentType, 0};
  if (size < 1 || components < 1 || components > 4) return rows;  // matrices have more
  rows.components = static_cast<std::size_t>(components);
  rows.stride = (static_cast<std::size_t>(size) * rows.components + 3) / 4 * 4;
  return rows;
}

// A parser may skip elements that it takes for malformed.
bool complete(const tinygltf::Model& model, const GltfDracoPart& part) {
  bool all = part.view < model.bufferViews.size();
  for (const auto* targets : {&part.attributes, &part.indices})
    for (const GltfDracoPart::Target& target : *targets)
      all &= target.accessor < model.accessors.size() && target.view < model.bufferViews.size();
  return all;
}

// Returns the larger of the numbers of points and triangles that the accessors have.
std::size_t promised(const GltfDracoPart& part, const tinygltf::Model& model) {
  std::size_t most = 0;
  for (const GltfDracoPart::Target& target : part.attributes)
    most = std::max(most, model.accessors[target.accessor].count);
  for (const GltfDracoPart::Target& target : part.indices)
    most = std::max(most, model.accessors[target.accessor].count / 3);
  return most;
}

std::string decode_part(const GltfDracoPart& part, tinygltf::Model& model, Filler& filler,
                        DracoBudget& budget) {
  if (!complete(model, part)) return "names elements that are not as the format has them";
  const auto bytes = gltf_view(model, static_cast<int>(part.view));
  if (!bytes.ok()) return bytes.status().message();
  std::vector<DracoRows> asked;
  for (const GltfDracoPart::Target& target : part.attributes) {
    asked.push_back(rows_for(model, target));
    if (asked.back().stride == 0)
      return fmt::format("cannot fill accessor {}, which has values of no known kind",
                         target.accessor);
  }
  DracoMesh mesh;
  if (std::string wrong =
          decode_draco({*bytes, promised(part, model), budget.limited()}, asked, mesh, budget);
      !wrong.empty())
    return wrong;
  for (std::size_t i = 0; i < asked.size(); ++i) {
    filler.set_stride(part.attributes[i], asked[i].stride);
    filler.fill(part.attributes[i], mesh.points, std::move(asked[i].data));
  }
  const auto* raw = reinterpret_cast<const unsigned char*>(mesh.indices.data());
  const std::size_t size = mesh.indices.size() * sizeof(mesh.indices[0]);
  for (const GltfDracoPart::Target& target : part.indices)
    filler.fill(target, mesh.indices.size(), std::vector<unsigned char>(raw, raw + size));
  return {};
}

Status malformed(const fs::path& path, const std::string& primitive, const std::string& wrong) {
  return malformed_gltf(path, fmt::format("{} ({}) {}", primitive, kGltfDraco, wrong));
}

}  // namespace

Status describe_draco(const fs::path& path, json& document, std::vector<GltfDracoPart>& parts) {
  Describer describer(document, parts);
  for (std::size_t m = 0; m < length_at(document, "meshes"); ++m) {
    json& mesh = document["meshes"][m];
    for (std::size_t p = 0; p < length_at(mesh, "primitives"); ++p) {
      json& primitive = mesh["primitives"][p];
      if (!draco_of(primitive)) continue;
      const std::string name = fmt::format("mesh {} primitive {}", m, p);
      if (std::string wrong = describer.add(primitive, name); !wrong.empty())
        return malformed(path, name, wrong);
    }
  }
  if (!parts.empty()) drop_from_lists(document);
  return {};
}

Status decode_draco_parts(const fs::path& path, const std::vector<GltfDracoPart>& parts,
                          const GltfLoading& loading, tinygltf::Model& model) {
  Filler filler(model, loading.document);
  DracoBudget budget = loading.limits ? DracoBudget(gltf_buffer_bytes(model)) : DracoBudget();
  for (const GltfDracoPart& part : parts)
    if (std::string wrong = decode_part(part, model, filler, budget); !wrong.empty())
      return malformed(path, part.primitive, wrong);
  return {};
}

}  // namespace atlas
