// Internal: a glTF file and checked access to its accessors. Includes tinygltf, so it is for the
// reader's .cpp files only.
#pragma once

#include <cstdint>
#include <filesystem>
#include <span>
#include <vector>

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

namespace atlas {

// Accessors without a view are zeros that a sparse part fills; their count has no data behind it.
inline constexpr std::size_t kMostGltfZeros = std::size_t{1} << 24;

// Parses .gltf and .glb and loads the buffers, the files of which `buffers` names. Images stay
// encoded: embedded ones keep their bytes in image.image, others their uri. `document`, where it is
// not null, becomes the file's JSON, an object. Errors: not_found (the file or a buffer),
// bad_input, unsupported (the file requires an extension other than those that are read; the
// message names it).
Result<tinygltf::Model> load_gltf(const std::filesystem::path& path,
                                  std::vector<std::filesystem::path>& buffers,
                                  nlohmann::json* document = nullptr);

// The bytes of a buffer view; bad_input where it leaves its buffer.
Result<std::span<const std::uint8_t>> gltf_view(const tinygltf::Model& model, int view);

// All values of an accessor, `components` a row, normalised integers as fractions, sparse ones
// filled in. The accessor may have more components than asked for, not fewer.
Result<std::vector<float>> gltf_floats(const tinygltf::Model& model, int accessor, int components);

// The values of a scalar accessor of unsigned integers.
Result<std::vector<std::uint32_t>> gltf_integers(const tinygltf::Model& model, int accessor);

// The values of an accessor as the file has them, a row of `row_bytes` each, `stride` apart.
struct GltfRows {
  const std::uint8_t* data = nullptr;  // of the model, or of `filled`
  std::size_t stride = 0, row_bytes = 0, count = 0;
  std::vector<std::uint8_t> filled;  // where a sparse part, or nothing, stands for them
};

// The columns of matrices are padded to 4 bytes, as in the file. Must not outlive the model.
// Errors: bad_input, for what leaves its buffer or has no data.
Result<GltfRows> gltf_rows(const tinygltf::Model& model, int accessor);

// A number of a row, not normalised; `type` is the accessor's componentType.
double gltf_component(const std::uint8_t* at, int type);

}  // namespace atlas
