// Internal: GltfData, which copies data of a glTF file that was read into one that is written.
// Includes tinygltf, so it is for .cpp files only.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "libatlas/exporters/gltf/gltf_document.h"
#include "libatlas/scene/gltf/gltf_source.h"

namespace atlas {

// Numbers are accessor numbers: parameters count the accessors of the source, results those of the
// document. Functions return nothing for accessors that do not exist or exceed their buffers.
class GltfData {
 public:
  // Both must outlive it.
  GltfData(const GltfSource& source, GltfDocument& document)
      : source_(source), document_(document) {}

  // Copies the accessor unchanged, including its sparse part. Each is copied only once.
  std::optional<std::size_t> accessor(std::int64_t number);
  // Copies the accessor that `holder[key]` names, and replaces the number by the new one. Returns
  // false if there is no such accessor; the key is erased then.
  bool renumber(nlohmann::json& holder, const char* key);

  // Adds an accessor with the values of these vertices only, in the types of the source. Returns
  // nothing also if there are no vertices, or one is beyond the accessor's end. `bounds`: whether
  // the smallest and largest values are stored. Asked for the same again, as by copies of a mesh
  // whose seams lie alike, it returns the same accessor.
  std::optional<std::size_t> rows(int number, const std::vector<std::uint32_t>& vertices,
                                  bool bounds);
  // Adds indices, or returns those that are there.
  std::size_t indices(const std::vector<std::uint32_t>& values);

 private:
  bool renumber_view(nlohmann::json& holder);
  std::optional<std::size_t> view(std::int64_t number);
  const GltfRows* source_rows(int number);
  std::optional<std::size_t> add_rows(int number, std::span<const std::uint32_t> vertices,
                                      bool bounds);

  const GltfSource& source_;
  GltfDocument& document_;
  // The new number of each accessor and view that was copied.
  std::map<std::int64_t, std::optional<std::size_t>> accessors_, views_;
  std::map<int, std::optional<GltfRows>> rows_;
  // By vertices, what was added of each accessor; by indices, theirs.
  std::map<std::vector<std::uint32_t>, std::map<std::pair<int, bool>, std::optional<std::size_t>>>
      added_;
  std::map<std::vector<std::uint32_t>, std::size_t> indices_;
};

}  // namespace atlas
