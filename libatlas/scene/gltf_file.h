// Internal: a glTF file and checked access to its accessors. Includes tinygltf, so it is for the
// reader's .cpp files only.
#pragma once

#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
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

// Parses .gltf and .glb and loads the buffers, the files of which `buffers` names. Images stay
// encoded: embedded ones keep their bytes in image.image, others their uri. Errors: not_found (the
// file or a buffer), bad_input, unsupported (the file requires an extension other than
// those that are read; the message names it).
Result<tinygltf::Model> load_gltf(const std::filesystem::path& path,
                                  std::vector<std::filesystem::path>& buffers);

// The bytes of a buffer view; bad_input where it leaves its buffer.
Result<std::span<const std::uint8_t>> gltf_view(const tinygltf::Model& model, int view);

// All values of an accessor, `components` a row, normalised integers as fractions, sparse ones
// filled in. The accessor may have more components than asked for, not fewer.
Result<std::vector<float>> gltf_floats(const tinygltf::Model& model, int accessor, int components);

// The values of a scalar accessor of unsigned integers.
Result<std::vector<std::uint32_t>> gltf_integers(const tinygltf::Model& model, int accessor);

}  // namespace atlas
