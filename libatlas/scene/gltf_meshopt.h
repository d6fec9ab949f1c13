// Internal: decodes the buffer views of a glTF file that EXT_meshopt_compression has compressed.
// Includes tinygltf, so only the reader's .cpp files may include it.
//
// Such a view names two places: a range of compressed bytes, and a range of a buffer for readers
// that do not know the extension. If that is a fallback buffer without data, the data exist
// only in compressed form; else the view is read as any other, and the compressed copy is ignored.
// See the extension's specification in the Khronos glTF repository.
#pragma once

#include "libatlas/scene/gltf_file.h"

namespace atlas {

inline constexpr const char* kGltfMeshopt = "EXT_meshopt_compression";

// Gives fallback buffers in the JSON of a file one byte of data, since tinygltf refuses buffers
// without any. Returns whether there were such buffers.
bool fill_fallback_buffers(nlohmann::json& document);

// Decodes each view of a fallback buffer into a buffer of its own, which is added to the model.
// Errors: bad_input if a view's compressed data or its description is damaged.
Status decode_meshopt_views(const std::filesystem::path& path, tinygltf::Model& model);

}  // namespace atlas
