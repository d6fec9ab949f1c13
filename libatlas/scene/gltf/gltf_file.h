// Internal: loads a glTF file and reads its accessors with range checks. Includes tinygltf, so only
// the reader's .cpp files may include it.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <span>
#include <vector>

// In a namespace of its own, so that programs that link libatlas may have a tinygltf, too.
#define tinygltf atlas_tinygltf
#define TINYGLTF_NO_STB_IMAGE
#define TINYGLTF_NO_STB_IMAGE_WRITE
#define TINYGLTF_NO_EXTERNAL_IMAGE
#define TINYGLTF_NO_INCLUDE_STB_IMAGE
#define TINYGLTF_NO_INCLUDE_STB_IMAGE_WRITE
#define TINYGLTF_NO_INCLUDE_JSON
#define TINYGLTF_NO_FS
#include <nlohmann/json.hpp>
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wshadow"
#include <tiny_gltf.h>
#pragma GCC diagnostic pop

#include "libatlas/core/status.h"
#include "libatlas/scene/defects.h"

namespace atlas {

// The largest count of an accessor without a buffer view. Its values are zeros, which a sparse part
// can replace; the file need not hold any data for the count.
inline constexpr std::size_t kMostGltfZeros = std::size_t{1} << 24;

// What load_gltf() is asked for, and where it puts what is not in the model.
struct GltfLoading {
  bool textures = true;   // false: formats of textures that are not read are no error
  DefectReport& defects;  // gets bytes that are not UTF-8
  std::vector<std::filesystem::path>& buffers;  // gets the paths of buffers that are files
  nlohmann::json* document = nullptr;           // if not null, becomes the file's JSON, an object
  // Says which buffers that are files may be read.
  std::function<bool(const std::filesystem::path&)> may_read = {};
  bool limits = true;     // ReadOptions::limits
  bool lightmap = false;  // whether what the file says of a lightmap is read, see gltf_lightmap.h
};

// Parses .gltf and .glb and loads the buffers. Images stay encoded: those in data URIs are in
// image.image, those in buffer views stay there, and the others keep their uri. Errors: not_found
// (the file or a buffer), bad_input, unsupported (the file is larger than 4 GiB, of another
// version, or requires an extension that is not read, which the message names).
Result<tinygltf::Model> load_gltf(const std::filesystem::path& path, const GltfLoading& loading);

// Returns how many bytes all buffers hold.
std::size_t gltf_buffer_bytes(const tinygltf::Model& model);

// Returns the bytes of a buffer view. Error: bad_input if it reaches beyond its buffer.
Result<std::span<const std::uint8_t>> gltf_view(const tinygltf::Model& model, int view);

// Returns all values of an accessor, `components` per row: normalised integers as fractions, with
// the sparse part filled in. The accessor may have more components than `components`, but not
// fewer.
Result<std::vector<float>> gltf_floats(const tinygltf::Model& model, int accessor, int components);

// Returns the values of a scalar accessor of unsigned integers.
Result<std::vector<std::uint32_t>> gltf_integers(const tinygltf::Model& model, int accessor);

// The values of an accessor as the file has them: rows of `row_bytes` bytes, whose beginnings are
// `stride` bytes apart.
struct GltfRows {
  const std::uint8_t* data = nullptr;  // points into the model, or into `filled`
  std::size_t stride = 0, row_bytes = 0, count = 0;
  std::vector<std::uint8_t> filled;  // the rows, if the accessor is sparse or has no buffer view
};

// Returns the rows of an accessor. The columns of matrices are padded to 4 bytes, as in the file.
// The result must not outlive the model. Errors: bad_input if rows reach beyond their buffer or
// have no data.
Result<GltfRows> gltf_rows(const tinygltf::Model& model, int accessor);

// Returns a number of a row, not normalised; `type` is the accessor's componentType.
double gltf_component(const std::uint8_t* at, int type);

}  // namespace atlas
