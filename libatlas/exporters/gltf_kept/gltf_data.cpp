#include "libatlas/exporters/gltf_kept/gltf_data.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <string>

namespace atlas {
using nlohmann::json;
namespace {

// Returns the smallest and largest value of each component, as numbers of the accessor's type.
json bounds_of(const tinygltf::Accessor& accessor, const std::string& rows, std::size_t stride) {
  const int type = accessor.componentType;
  const auto size =
      std::size_t(tinygltf::GetComponentSizeInBytes(static_cast<std::uint32_t>(type)));
  const int components =
      tinygltf::GetNumComponentsInType(static_cast<std::uint32_t>(accessor.type));
  json low = json::array(), high = json::array();
  for (int c = 0; c < components; ++c) {
    double least = INFINITY, largest = -INFINITY;
    for (std::size_t at = std::size_t(c) * size; at < rows.size(); at += stride) {
      const double value =
          gltf_component(reinterpret_cast<const std::uint8_t*>(rows.data()) + at, type);
      if (!std::isfinite(value)) continue;
      least = std::min(least, value);
      largest = std::max(largest, value);
    }
    if (least > largest) least = largest = 0;  // no value is finite, and JSON has no others
    const bool real =
        type == TINYGLTF_COMPONENT_TYPE_FLOAT || type == TINYGLTF_COMPONENT_TYPE_DOUBLE;
    low.push_back(real ? json(least) : json(static_cast<std::int64_t>(least)));
    high.push_back(real ? json(largest) : json(static_cast<std::int64_t>(largest)));
  }
  return {{"min", std::move(low)}, {"max", std::move(high)}};
}

}  // namespace

std::optional<std::size_t> GltfData::view(std::int64_t number) {
  const auto [at, is_new] = views_.try_emplace(number);
  if (!is_new) return at->second;
  if (number < 0 || number > std::numeric_limits<int>::max()) return {};
  const auto bytes = gltf_view(source_.model, static_cast<int>(number));
  if (!bytes.ok()) return {};
  json copy = source_.document["bufferViews"][std::size_t(number)];
  copy.erase("extensions");  // of compression; these bytes are not compressed
  return at->second = document_.add_view(bytes->data(), bytes->size(), std::move(copy));
}

// Returns false if the holder names a view that cannot be copied.
bool GltfData::renumber_view(json& holder) {
  const auto at = holder.find("bufferView");
  if (at == holder.end()) return true;
  const auto copied = at->is_number_integer() ? view(at->get<std::int64_t>()) : std::nullopt;
  if (copied) *at = *copied;
  return copied.has_value();
}

std::optional<std::size_t> GltfData::accessor(std::int64_t number) {
  const auto [at, is_new] = accessors_.try_emplace(number);
  if (!is_new) return at->second;
  if (number < 0 || number > std::numeric_limits<int>::max()) return {};
  if (!gltf_rows(source_.model, static_cast<int>(number)).ok()) return {};
  json copy = source_.document["accessors"][std::size_t(number)];
  if (!renumber_view(copy)) return {};
  if (const auto sparse = copy.find("sparse"); sparse != copy.end() && sparse->is_object()) {
    for (const char* part : {"indices", "values"}) {
      const auto list = sparse->find(part);
      if (list == sparse->end() || !list->is_object() || !renumber_view(*list)) return {};
    }
  }
  return at->second = document_.add_accessor(std::move(copy));
}

bool GltfData::renumber(json& holder, const char* key) {
  const auto at = holder.find(key);
  if (at == holder.end()) return false;
  const auto copied = at->is_number_integer() ? accessor(at->get<std::int64_t>()) : std::nullopt;
  if (copied) {
    *at = *copied;
  } else {
    holder.erase(at);
  }
  return copied.has_value();
}

// Primitives often share accessors of a million values, of which each primitive uses a few. The
// rows are remembered, so that those that must be assembled first (sparse ones) are assembled only
// once.
const GltfRows* GltfData::source_rows(int number) {
  const auto [at, is_new] = rows_.try_emplace(number);
  if (is_new) {
    auto rows = gltf_rows(source_.model, number);
    if (rows.ok()) at->second = std::move(*rows);
  }
  return at->second ? &*at->second : nullptr;
}

std::optional<std::size_t> GltfData::rows(int number, const std::vector<std::uint32_t>& vertices,
                                          bool bounds) {
  const auto [at, is_new] = added_[vertices].try_emplace({number, bounds});
  if (is_new) at->second = add_rows(number, vertices, bounds);
  return at->second;
}

std::size_t GltfData::indices(const std::vector<std::uint32_t>& values) {
  const auto [at, is_new] = indices_.try_emplace(values);
  if (is_new) at->second = document_.add_indices(values);
  return at->second;
}

std::optional<std::size_t> GltfData::add_rows(int number, std::span<const std::uint32_t> vertices,
                                              bool bounds) {
  const GltfRows* rows = source_rows(number);
  if (!rows || vertices.empty()) return {};
  if (*std::max_element(vertices.begin(), vertices.end()) >= rows->count) return {};
  const std::size_t stride = (rows->row_bytes + 3) / 4 * 4;  // the format requires multiples of 4
  std::string bytes(vertices.size() * stride, '\0');
  for (std::size_t i = 0; i < vertices.size(); ++i)
    std::memcpy(&bytes[i * stride], rows->data + vertices[i] * rows->stride, rows->row_bytes);
  const tinygltf::Accessor& from = source_.model.accessors[std::size_t(number)];
  json accessor = source_.document["accessors"][std::size_t(number)];
  for (const char* key : {"byteOffset", "sparse", "min", "max"}) accessor.erase(key);
  accessor["count"] = vertices.size();
  if (bounds) accessor.update(bounds_of(from, bytes, stride));
  accessor["bufferView"] = document_.add_vertices(bytes.data(), vertices.size(), stride);
  return document_.add_accessor(std::move(accessor));
}

}  // namespace atlas
