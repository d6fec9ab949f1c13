// Internal: data of a glTF file that was read, on its way into one that is written. Includes
// tinygltf, so it is for .cpp files only.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <span>

#include "libatlas/exporters/gltf_document.h"
#include "libatlas/scene/gltf_source.h"

namespace atlas {

// Numbers are those of accessors: in the source they are asked for, in the document they are given.
// Nothing is given for those that do not exist or leave their buffers.
class GltfData {
 public:
  // Both must outlive it.
  GltfData(const GltfSource& source, GltfDocument& document)
      : source_(source), document_(document) {}

  // The accessor as it is, sparse parts and all; each is copied once.
  std::optional<std::size_t> accessor(std::int64_t number);
  // The same where `holder[key]` is such a number, which becomes the new one. False where there is
  // none; the key is gone then.
  bool renumber(nlohmann::json& holder, const char* key);

  // A new accessor of the values of these vertices, in the types of the source. Nothing is given
  // where one of them is beyond the accessor's end, either. `bounds`: with its least and largest
  // values.
  std::optional<std::size_t> rows(int number, std::span<const std::uint32_t> vertices, bool bounds);

 private:
  bool renumber_view(nlohmann::json& holder);
  std::optional<std::size_t> view(std::int64_t number);
  const GltfRows* source_rows(int number);

  const GltfSource& source_;
  GltfDocument& document_;
  std::map<std::int64_t, std::optional<std::size_t>> accessors_, views_;  // those that are copied
  std::map<int, std::optional<GltfRows>> rows_;
};

}  // namespace atlas
