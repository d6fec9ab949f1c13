// How files say which pages their uvs were made for. Uvs run from 0 to 1 across a page of any
// shape, so a file must say that shape, or its charts would be read as stretched.
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace atlas {

// Returns the line for a single page of this many texels, for which textures are still to be made.
std::string uv_page_text(std::int32_t width, std::int32_t height);

// Returns the line for one of several pages, or for a page whose texture is part of the file. The
// materials of its triangles have names that end in its number, before `_one_sided` or the
// extension of an image if they have those.
std::string uv_page_text(std::size_t page, std::int32_t width, std::int32_t height);

// Returns such a line for a file that may have several sets of uvs: it names the set TEXCOORD_<set>
// that it is about. A line that names a set already is returned as it is.
std::string of_uv_set(std::int64_t set, const std::string& line);

// Returns the set that a line says a page of: the one that it names, else 0. Returns nothing if the
// line says no page.
std::optional<std::int64_t> uv_set_of_page(std::string_view line);

// A page of a file's uvs.
struct UvPage {
  std::uint32_t number = 0;            // 0 if there is only one
  std::int32_t width = 0, height = 0;  // texels; 0: the file does not say it
  bool operator==(const UvPage&) const = default;
};

// What the lines of a file say of its pages.
class UvPages {
 public:
  // Takes a line of any kind, which may have a comment's mark or a quotation mark before it. The
  // first line for a page of a set counts.
  void take(std::string_view line);

  // Returns width / height of the page of the material's uvs, which are those of this set, or 0 if
  // no line says it. Lines that name no set are about all sets that no other line names.
  double aspect_of(std::string_view material, std::int64_t set = 0) const;
  // Returns that page.
  UvPage page_of(std::string_view material, std::int64_t set = 0) const;
  // Returns all pages of the set, or the only one, ascending by number.
  std::vector<UvPage> pages_of(std::int64_t set = 0) const;

 private:
  struct Page {
    double aspect = 0;  // 0: not said
    UvPage page = {};
  };
  struct Pages {
    Page single;                              // the only page
    std::map<std::uint32_t, Page> by_number;  // several pages
  };
  const Pages* of_set(std::int64_t set) const;
  Page find(std::string_view material, std::int64_t set) const;

  std::map<std::int64_t, Pages> sets_;
};

}  // namespace atlas
