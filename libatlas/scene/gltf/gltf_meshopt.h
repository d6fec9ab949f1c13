// Internal: decodes the buffer views of a glTF file that EXT_meshopt_compression, or its successor
// KHR_meshopt_compression, has compressed. Includes tinygltf, so only the reader's .cpp files may
// include it.
//
// Such a view names two places: a range of compressed bytes, and a range of a buffer for readers
// that do not know the extension. If that buffer has no data, it is a fallback buffer, and the data
// exist only in compressed form; else the view is read as any other, and the compressed copy is
// ignored. See the extensions' specifications in the Khronos glTF repository.
#pragma once

#include <set>

#include "libatlas/scene/gltf/gltf_file.h"

namespace atlas {

inline constexpr const char* kGltfMeshopt[] = {"EXT_meshopt_compression",
                                               "KHR_meshopt_compression"};

// Gives fallback buffers in the JSON of a file one byte of data, since tinygltf refuses buffers
// without any, and returns their numbers. `container` says whether the file is a .glb, whose first
// buffer has its data there.
std::set<int> fill_fallback_buffers(nlohmann::json& document, bool container);

// Decodes each compressed view of a fallback buffer into a buffer of its own, which is added to the
// model. Errors: bad_input if a view's compressed data or its description is damaged; unsupported
// if they are of a codec that the library meshoptimizer is too old for.
Status decode_meshopt_views(const std::filesystem::path& path, const std::set<int>& fallbacks,
                            tinygltf::Model& model);

}  // namespace atlas
