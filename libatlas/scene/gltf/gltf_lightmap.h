// Internal: reads the lightmap that a glTF file names in asset.extras.lightmap (docs/formats.md).
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "libatlas/core/context.h"
#include "libatlas/scene/building/lightmap_images.h"
#include "libatlas/scene/building/scene_builder.h"
#include "libatlas/scene/gltf/gltf_file.h"

namespace atlas {

// Replaces the values of a file's lightmap that tinygltf drops or changes by `false`, which is as
// wrong, and stays: null and empty ones, which would move the names behind them in a list, and
// integers beyond 32 bits, which would name another page. Returns whether there are any.
bool mark_lightmap_values(nlohmann::json& document);

// Collects what primitives say of the lightmap, then loads its pages, then takes the triangles. If
// the file names none, the builder does not want it (SceneBuilder::wants_lightmap), or it cannot be
// used, which is a defect, all calls do nothing. The images are noted as files of the scene in any
// case.
class GltfLightmap {
 public:
  // Both must outlive the object.
  GltfLightmap(const tinygltf::Model& model, SceneBuilder& builder);

  // Where a primitive lies on the lightmap: texture coordinates, one per vertex, and the page.
  struct Part {
    std::size_t first = 0, count = 0;
    std::int32_t page = -1;  // -1: it does not lie there
  };
  // Returns the part of a primitive. One without it is remembered as a defect, unless it is `unlit`
  // and needs none.
  Part part_of(const tinygltf::Primitive& primitive, bool unlit, const std::string& name);

  // Reads the pages that parts lie on. If all can be read, the scene gets the lightmap.
  void load(const Context& context);

  // Returns whether the scene gets the lightmap; to be called after load().
  bool loaded() const { return map_ != nullptr; }

  // Takes the next triangle of the builder; corners are numbers of the primitive's vertices.
  void add_triangle(const Part& part, const std::array<std::uint32_t, 3>& corners);

  // Gives the lightmap to the builder.
  void finish();

 private:
  // Returns what keeps the lightmap from being used, or an empty string.
  std::string name_from(const tinygltf::Value& extras);
  std::string coordinates_of(const tinygltf::Primitive& primitive, const std::string& name,
                             Part& part);

  const tinygltf::Model& model_;
  SceneBuilder& builder_;
  std::optional<LightmapImages> named_;
  int set_ = 0;                      // of texture coordinates
  std::map<int, Part> parts_;        // by accessor
  std::vector<bool> used_;           // 1 per page: whether a part lies on it
  std::vector<std::string> absent_;  // primitives that have no part, and why
  std::vector<Vec2f> texcoords_;
  std::shared_ptr<SceneLightmap> map_;
};

}  // namespace atlas
