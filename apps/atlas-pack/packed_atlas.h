// A finished atlas as the writers see it: coordinates from the upper left corner, as in images.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "apps/atlas-pack/command_line.h"

namespace atlas::app {

struct PackedItem {
  std::string name;
  Placement at;                         // x, y of the upper left corner of the frame
  Extent size;                          // before rotation, trimmed
  Extent source;                        // before trimming
  std::int32_t trim_x = 0, trim_y = 0;  // of the frame in the source, from its upper left corner
  bool trimmed() const { return !(size == source); }
};

struct PackedAtlas {
  std::vector<PackedItem> items;
  std::vector<Extent> pages;
  std::vector<std::string> images;  // one file name per page; empty if no images are written
  std::vector<std::filesystem::path> files;  // all files written, the preview last
  std::size_t unplaced = 0, aliases = 0;
  double utilization = 0;
  double last_page_fill = 0;  // the same of the last page alone
  double cpu_seconds = 0;
};

// Uses the library's placements with y down instead of up. If they were converted, items would no
// longer begin at multiples of the alignment, which blocks of texels count from the upper edge.
PackedAtlas make_atlas(std::vector<PackedItem> items, const PackResult& result);

std::string to_csv(const PackedAtlas& atlas);

// Returns the name of the file that holds the frames of a page, from that of the page's image.
std::string data_of_page(const std::string& image);

// Returns a name as JSON writes it, in quotes. Bytes that are not UTF-8 are replaced, so different
// names may become equal.
std::string name_in_json(const std::string& name);

// Returns the layout as JSON that game tools read. For the page kAllPages it lists all pages, each
// frame with its page. Otherwise it names the data of the other pages, if there are any.
inline constexpr std::uint32_t kAllPages = 0xffffffffu;
std::string to_json(const PackedAtlas& atlas, DataFormat format, std::uint32_t page);

// Returns the summary for --json, a single object.
std::string to_summary(const PackedAtlas& atlas);

}  // namespace atlas::app
