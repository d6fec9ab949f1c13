#include "libatlas/scene/gltf/gltf_lightmap.h"

#include <fmt/format.h>

#include <algorithm>
#include <limits>
#include <utility>

#include "libatlas/core/is_finite.h"
#include "libatlas/scene/gltf/gltf_check.h"
#include "libatlas/scene/gltf/gltf_pose.h"

namespace atlas {
namespace {

// Returns the file names of a list, or an empty one if the value is anything else.
std::vector<std::string> names(const tinygltf::Value& value) {
  std::vector<std::string> result;
  if (!value.IsArray()) return result;
  for (const tinygltf::Value& name : value.Get<tinygltf::Value::Array>())
    result.push_back(name.IsString() ? name.Get<std::string>() : std::string());
  return result;
}

bool is_light(const tinygltf::Value& value) {
  return value.IsNumber() && value.GetNumberAsDouble() <= double(kMostLight) &&
         float(value.GetNumberAsDouble()) > 0;
}

// Returns how many values an accessor announces; 0 if there is none of that number.
std::size_t count_of(const tinygltf::Model& model, int accessor) {
  const bool exists = accessor >= 0 && std::size_t(accessor) < model.accessors.size();
  return exists ? model.accessors[std::size_t(accessor)].count : 0;
}

bool mark(nlohmann::json* value) {
  if (value == nullptr) return false;
  using Int = std::numeric_limits<int>;
  const bool empty = value->is_null() || (value->is_structured() && value->empty());
  // As a double, since integers may also be unsigned ones of 64 bits.
  const double number = value->is_number_integer() ? value->get<double>() : 0;
  const bool keeps = !empty && number >= Int::min() && number <= Int::max();
  if (!keeps) *value = false;
  return !keeps;
}

}  // namespace

bool mark_lightmap_values(nlohmann::json& document) {
  nlohmann::json* const map =
      member_at(member_at(member_at(&document, "asset"), "extras"), "lightmap");
  bool any = false;
  for (const char* key : {"texCoord", "white"}) any |= mark(member_at(map, key));
  for (const char* key : {"images", "linear"})
    if (nlohmann::json* names = member_at(map, key); names != nullptr && names->is_array())
      for (nlohmann::json& name : *names) any |= mark(&name);
  nlohmann::json* const meshes = map == nullptr ? nullptr : member_at(&document, "meshes");
  if (meshes == nullptr || !meshes->is_array()) return any;
  for (nlohmann::json& mesh : *meshes)
    if (nlohmann::json* parts = member_at(&mesh, "primitives");
        parts != nullptr && parts->is_array())
      for (nlohmann::json& part : *parts)
        any |= mark(member_at(member_at(&part, "extras"), "lightmap"));
  return any;
}

GltfLightmap::GltfLightmap(const tinygltf::Model& model, SceneBuilder& builder)
    : model_(model), builder_(builder) {
  const tinygltf::Value& extras = model.asset.extras;
  if (!extras.IsObject() || !extras.Has("lightmap")) return;
  const std::string wrong = name_from(extras.Get("lightmap"));
  if (named_) note_lightmap(*named_, builder);
  if (wrong.empty() && builder.wants_lightmap) return;
  named_.reset();
  if (!builder.wants_lightmap) return;
  builder_.defects.add(DefectKind::lightmap_unusable, [&] {
    return fmt::format("{}: asset.extras.lightmap {}", builder_.file, wrong);
  });
}

std::string GltfLightmap::name_from(const tinygltf::Value& map) {
  if (!map.IsObject()) return "is no object";
  named_.emplace();
  named_->images = names(map.Get("images"));
  named_->linear = names(map.Get("linear"));
  if (named_->images.empty() && named_->linear.empty()) return "names no images";
  const tinygltf::Value& set = map.Get("texCoord");
  if (!set.IsInt() || set.GetNumberAsInt() < 0)
    return "has a texCoord that is no whole number from 0 on";
  set_ = set.GetNumberAsInt();
  if (map.Has("white")) {
    const tinygltf::Value& white = map.Get("white");
    if (!is_light(white))
      return fmt::format("has a white that is no number above 0 and up to {:g}", kMostLight);
    named_->white = float(white.GetNumberAsDouble());
  }
  used_.resize(std::max(named_->images.size(), named_->linear.size()));
  return {};
}

// Reads the texture coordinates. Returns what is wrong with them, or an empty string.
std::string GltfLightmap::coordinates_of(const tinygltf::Primitive& primitive,
                                         const std::string& name, Part& part) {
  const std::string attribute = fmt::format("TEXCOORD_{}", set_);
  const int accessor = gltf_attribute(primitive.attributes, attribute);
  if (accessor < 0) return "has no " + attribute;
  // This also keeps a small file from announcing more coordinates than it shows vertices.
  if (count_of(model_, accessor) !=
      count_of(model_, gltf_attribute(primitive.attributes, "POSITION")))
    return "has another number of " + attribute + " than of positions";
  const auto [at, is_new] = parts_.try_emplace(accessor);
  if (is_new) {
    const auto uvs = gltf_floats(model_, accessor, 2);
    if (!uvs.ok()) {
      parts_.erase(at);
      return fmt::format("{}: {}", attribute, uvs.status().message());
    }
    at->second = {texcoords_.size(), uvs->size() / 2, 0};
    for (std::size_t i = 0; i + 1 < uvs->size(); i += 2) {
      Vec2f uv{(*uvs)[i], 1 - (*uvs)[i + 1]};
      if (!is_finite(uv)) {
        uv = {};
        builder_.defects.add(DefectKind::texcoord_not_finite, [&] {
          return fmt::format("{}: {}: {} of vertex {}", builder_.file, name, attribute, i / 2);
        });
      }
      texcoords_.push_back(uv);
    }
  }
  part = at->second;
  return {};
}

GltfLightmap::Part GltfLightmap::part_of(const tinygltf::Primitive& primitive, bool unlit,
                                         const std::string& name) {
  Part part;
  if (!named_) return part;
  std::int64_t page = 0;
  if (primitive.extras.IsObject() && primitive.extras.Has("lightmap")) {
    const tinygltf::Value& value = primitive.extras.Get("lightmap");
    page = value.IsInt() ? value.GetNumberAsInt() : -1;
  }
  std::string wrong;
  if (page < 0 || std::size_t(page) >= used_.size())
    wrong = fmt::format("its extras.lightmap is no page from 0 to {}", used_.size() - 1);
  else
    wrong = coordinates_of(primitive, name, part);
  if (!wrong.empty()) {
    if (!unlit) absent_.push_back(fmt::format("{}: {}", name, wrong));
    return {};
  }
  part.page = std::int32_t(page);
  used_[std::size_t(page)] = true;
  return part;
}

void GltfLightmap::load(const Context& context) {
  if (!named_) return;
  Result<std::vector<ImageF>> pages =
      Status(ErrorCode::not_found,
             fmt::format("{}: no triangle has TEXCOORD_{} and a page", builder_.file, set_));
  if (std::find(used_.begin(), used_.end(), true) != used_.end())
    pages = read_lightmap(*named_, used_, builder_, context);
  if (!pages.ok()) {
    builder_.defects.add(DefectKind::lightmap_unusable, [&] { return pages.status().message(); });
    return;
  }
  for (const std::string& primitive : absent_)
    builder_.defects.add(DefectKind::lightmap_absent,
                         [&] { return fmt::format("{}: {}", builder_.file, primitive); });
  map_ = std::make_shared<SceneLightmap>();
  map_->pages = std::move(*pages);
  map_->texcoords = std::move(texcoords_);
  map_->white = named_->white.value_or(0.0f);
}

void GltfLightmap::add_triangle(const Part& part, const std::array<std::uint32_t, 3>& corners) {
  if (!map_) return;
  const bool given = part.page >= 0 && std::all_of(corners.begin(), corners.end(),
                                                   [&](auto c) { return c < part.count; });
  for (const std::uint32_t corner : corners)
    map_->texcoord_indices.push_back(given ? std::uint32_t(part.first) + corner
                                           : Scene::kNoTexcoord);
  map_->triangle_page.push_back(given ? std::uint32_t(part.page) : 0);
}

void GltfLightmap::finish() {
  builder_.lightmap = std::move(map_);
}

}  // namespace atlas
