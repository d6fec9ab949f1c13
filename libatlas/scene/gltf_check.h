// Internal: what is looked at in a glTF file before tinygltf parses it.
#pragma once

#include <cstdint>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <string_view>
#include <vector>

#include "libatlas/core/status.h"

namespace atlas {

// The file breaks the rules of glTF: `what` says how.
Status malformed_gltf(const std::filesystem::path& path, const std::string& what);

inline constexpr const char* kGltfDraco = "KHR_draco_mesh_compression";

// The whole number that an object has under a key; `absent` where it has none.
std::int64_t integer_at(const nlohmann::json& object, const char* key, std::int64_t absent);

// The parts of a file: of a .gltf its JSON is all.
struct GltfParts {
  std::string_view json, binary;
  nlohmann::json document;             // the JSON, parsed; an object
  std::vector<double> external_bytes;  // what the buffers need that lie in files of their own
  bool container = false;              // a .glb
  bool plain = true;  // false: a .glb in a form that the format allows, or many write, but tinygltf
                      // refuses
};

// Finds the parts, and checks in the JSON what tinygltf passes over in silence or trusts: the
// version, required extensions, lists that are none, indices that are there only compressed, ranges
// of embedded images. Errors: bad_input, unsupported.
Result<GltfParts> check_gltf(const std::filesystem::path& path, std::string_view bytes);

}  // namespace atlas
