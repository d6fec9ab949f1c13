// Internal: parses the header of a PLY file.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "libatlas/core/status.h"
#include "libatlas/scene/files/file_bytes.h"

namespace atlas {

enum class PlyFormat { ascii, little, big };
enum class PlyType : std::uint8_t { i8, u8, i16, u16, i32, u32, f32, f64 };

constexpr std::size_t ply_size(PlyType type) {
  constexpr std::size_t kSizes[] = {1, 1, 2, 2, 4, 4, 4, 8};
  return kSizes[static_cast<std::size_t>(type)];
}

struct PlyProperty {
  std::string name;
  PlyType type{};
  bool list = false;
  PlyType length_type{};  // of a list's length
};

struct PlyElement {
  std::string name;
  std::uint64_t count = 0;
  std::vector<PlyProperty> properties;

  int find(std::string_view property) const;  // -1: none
  // Returns how many bytes one element takes at least: with empty lists, and in ascii with one
  // character and a blank for each number.
  std::size_t least_bytes(PlyFormat format) const;
};

struct PlyHeader {
  PlyFormat format{};
  std::vector<PlyElement> elements;
  std::vector<std::string> texture_files;  // `comment TextureFile NAME`, as MeshLab writes it
  std::size_t bytes = 0;                   // length of the header: the data begin here
  std::uint32_t lines = 0;
};

// Parses the header. If its lines end in lone carriage returns, turns these into newlines, and in
// an ascii file also those of the data. Errors: bad_input, naming the line.
Result<PlyHeader> read_ply_header(FileBytes& bytes, const std::string& file);

}  // namespace atlas
