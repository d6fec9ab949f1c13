// How files say which pages their uvs were made for. Uvs run from 0 to 1 across a page of any
// shape, so a file must say that shape, or its charts would be read as stretched.
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <string>
#include <string_view>

namespace atlas {

// Returns the line for a single page of this many texels, for which textures are still to be made.
std::string uv_page_text(std::int32_t width, std::int32_t height);

// Returns the line for one of several pages, or for a page whose texture is part of the file. The
// materials of its triangles have names that end in its number, before `_one_sided` or the
// extension of an image if they have those.
std::string uv_page_text(std::size_t page, std::int32_t width, std::int32_t height);

// What the lines of a file say of its pages.
class UvPages {
 public:
  // Takes a line of any kind, which may have a comment's mark or a quotation mark before it. The
  // first line for a page counts.
  void take(std::string_view line);

  // Returns width / height of the page of the material's uvs, or 0 if no line says it.
  double aspect_of(std::string_view material) const;

 private:
  double single_ = 0;                          // the ratio of a file's only page; 0: not said
  std::map<std::uint32_t, double> by_number_;  // ratios of several pages
};

}  // namespace atlas
