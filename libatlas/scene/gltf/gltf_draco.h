// Internal: decodes the primitives of a glTF file that KHR_draco_mesh_compression has compressed.
// Includes tinygltf, so only the reader's .cpp files may include it.
//
// Such a primitive names a buffer view of compressed bytes, and says which of its accessors stand
// for what is in them. If these accessors have no buffer views of their own, the data exist only in
// compressed form; else the plain data are read, and the compressed copy is ignored. See the
// extension's specification in the Khronos glTF repository.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "libatlas/scene/gltf/gltf_file.h"

namespace atlas {

inline constexpr const char* kGltfDraco = "KHR_draco_mesh_compression";

// What is compressed together: the indices of a primitive, and some of its attributes.
struct GltfDracoPart {
  // An accessor, and the view that is made for its data.
  struct Target {
    std::uint32_t id = 0;  // of the attribute in the compressed data; indices have none
    std::size_t accessor = 0, view = 0;
  };
  std::string primitive;  // its name in messages
  std::size_t view = 0;   // of the compressed bytes
  std::vector<Target> attributes;
  std::vector<Target> indices;  // one, or none if those of an earlier part are shared
};

// Lists in `parts` what exists only in compressed form, and describes in the file's JSON what will
// take its place: the accessors get buffer views, still of one byte each, and the primitives lose
// the extension. Error: bad_input if a description is malformed.
Status describe_draco(const std::filesystem::path& path, nlohmann::json& document,
                      std::vector<GltfDracoPart>& parts);

// Decodes the parts into buffers of the model, which has been parsed from the described JSON, and
// makes views and accessors fit, in the model and, unless it is null, in the document. They may
// decode to more than the budget only without GltfLoading::limits. Error: bad_input if compressed
// data are damaged, or do not hold what the description says.
Status decode_draco_parts(const std::filesystem::path& path,
                          const std::vector<GltfDracoPart>& parts, const GltfLoading& loading,
                          tinygltf::Model& model);

}  // namespace atlas
