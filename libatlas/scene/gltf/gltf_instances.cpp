#include "libatlas/scene/gltf/gltf_instances.h"

#include <fmt/format.h>

#include <glm/gtc/quaternion.hpp>
#include <optional>

namespace atlas {
namespace {

// Returns one of the extension's attributes, `components` values for each instance; empty if it is
// not given.
Result<std::vector<float>> attribute(const tinygltf::Model& model, const tinygltf::Value& list,
                                     const char* name, int components) {
  if (!list.Has(name)) return std::vector<float>{};
  if (!list.Get(name).IsInt()) return Status{ErrorCode::bad_input, "is no accessor's number"};
  return gltf_floats(model, list.Get(name).GetNumberAsInt(), components);
}

glm::dmat4 matrix_of(const float* move, const float* turn, const float* scale) {
  glm::dmat4 m(1);
  if (turn) {
    const glm::dquat q(turn[3], turn[0], turn[1], turn[2]);
    if (glm::length(q) > 0) m = glm::mat4_cast(glm::normalize(q));
  }
  for (int c = 0; scale && c < 3; ++c) m[c] *= double(scale[c]);
  if (move) m[3] = {move[0], move[1], move[2], 1};
  return m;
}

}  // namespace

Result<std::vector<glm::dmat4>> gltf_instances(const tinygltf::Model& model,
                                               const tinygltf::Node& node) {
  const auto at = node.extensions.find(kGltfInstancing);
  if (at == node.extensions.end() || !at->second.IsObject() || !at->second.Has("attributes"))
    return std::vector{glm::dmat4(1)};
  struct Attribute {
    const char* name;
    std::size_t components;
    std::vector<float> values = {};
    const float* of(std::size_t i) const {
      return values.empty() ? nullptr : values.data() + components * i;
    }
  };
  Attribute attributes[] = {{"TRANSLATION", 3}, {"ROTATION", 4}, {"SCALE", 3}};
  std::optional<std::size_t> count;
  for (Attribute& a : attributes) {
    auto values = attribute(model, at->second.Get("attributes"), a.name, int(a.components));
    if (!values.ok()) {
      return Status{ErrorCode::bad_input,
                    fmt::format("{} of its instances {}", a.name, values.status().message())};
    }
    a.values = std::move(*values);
    if (a.values.empty()) continue;
    if (count.value_or(a.values.size() / a.components) != a.values.size() / a.components)
      return Status{ErrorCode::bad_input, "has another number of " + std::string(a.name) +
                                              " than of other values of its instances"};
    count = a.values.size() / a.components;
  }
  if (!count) return std::vector{glm::dmat4(1)};  // it has only attributes that viewers define
  std::vector<glm::dmat4> matrices(*count);
  for (std::size_t i = 0; i < *count; ++i)
    matrices[i] = matrix_of(attributes[0].of(i), attributes[1].of(i), attributes[2].of(i));
  return matrices;
}

}  // namespace atlas
