// Internal: decodes a mesh that the Draco library has compressed.
#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <string>
#include <vector>

namespace atlas {

// The values of an attribute: one row per point of the mesh, in the form that an accessor has.
struct DracoRows {
  std::uint32_t id = 0;  // unique id of the attribute in the compressed data
  std::size_t components = 0;
  int component_type = 0;                // a componentType of glTF
  std::size_t stride = 0;                // bytes from row to row
  std::vector<unsigned char> data = {};  // becomes the rows
};

struct DracoMesh {
  std::size_t points = 0;
  std::vector<std::uint32_t> indices = {};  // three per triangle
};

// How many bytes a file may decode to in all. Without a limit of the sum, a small file that names
// the same data again and again would fill any memory.
class DracoBudget {
 public:
  // For a file whose buffers hold so many bytes.
  explicit DracoBudget(std::size_t file_bytes);
  // For any number of bytes.
  DracoBudget() : left_(std::numeric_limits<std::size_t>::max()) {}

  bool limited() const { return left_ != std::numeric_limits<std::size_t>::max(); }
  // Returns false, and takes nothing, if less is left.
  bool take(std::size_t bytes);

 private:
  std::size_t left_;
};

// Compressed data, and the larger of the numbers of points and triangles that the file promises of
// them; 0: it promises none.
struct DracoBytes {
  std::span<const unsigned char> bytes;
  std::size_t promised = 0;
  bool limited = true;  // false: any counts are believed (ReadOptions::limits)
};

// Decodes a mesh of Draco's bitstream 2.2, the one that glTF allows, and the attributes that are
// asked for. Data that announce much more than is promised are refused before they are decoded.
// Returns what is wrong with the data, or an empty text.
std::string decode_draco(const DracoBytes& data, std::span<DracoRows> asked, DracoMesh& mesh,
                         DracoBudget& budget);

}  // namespace atlas
