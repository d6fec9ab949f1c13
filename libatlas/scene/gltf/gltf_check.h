// Internal: checks a glTF file before tinygltf parses it.
#pragma once

#include <cstdint>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <string_view>
#include <vector>

#include "libatlas/core/status.h"
#include "libatlas/scene/defects.h"
#include "libatlas/scene/files/file_bytes.h"

namespace atlas {

// Returns the error for a file that breaks the rules of glTF; `what` says how.
Status malformed_gltf(const std::filesystem::path& path, const std::string& what);

// Returns the integer that an object has under a key, or `absent` if it has none.
std::int64_t integer_at(const nlohmann::json& object, const char* key, std::int64_t absent);

// Returns the length of the list that an object has under a key, or 0 if it has none.
std::size_t length_at(const nlohmann::json& object, const char* key);

// Returns what an extension says of an element, or null if it says nothing.
const nlohmann::json* extension_at(const nlohmann::json& element, const char* name);

// The parts of a file. A .gltf file is JSON as a whole.
struct GltfParts {
  std::string_view json, binary;
  nlohmann::json document;             // the JSON, parsed; an object
  std::vector<double> external_bytes;  // sizes of the buffers that are files of their own
  bool container = false;              // a .glb
  bool plain = true;  // false: a .glb whose form is allowed, or common, but refused by tinygltf
};

// Finds the parts, and checks in the JSON what tinygltf ignores or trusts: the version, required
// extensions, lists that are not arrays, and the ranges of embedded images. If `textures` is false,
// extensions that only concern textures are not refused. Bytes of the JSON that are not UTF-8
// become '?' in `bytes`, which is what strings hold in their place, and are added to the defects.
// Errors: bad_input, unsupported.
Result<GltfParts> check_gltf(const std::filesystem::path& path, FileBytes& bytes, bool textures,
                             DefectReport& defects);

// Returns the member `key` of a JSON object; null if there is none, or `of` is null or no object.
template <class Json>  // json or const json
Json* member_at(Json* of, const char* key) {
  if (of == nullptr || !of->is_object()) return nullptr;
  const auto at = of->find(key);
  return at == of->end() ? nullptr : &*at;
}

// Gives images in data URIs of types that tinygltf does not decode, and would take for file names,
// a type that it does. Their mimeType then is what the URI said. Returns whether there are any.
bool retype_data_images(nlohmann::json& document);

}  // namespace atlas
