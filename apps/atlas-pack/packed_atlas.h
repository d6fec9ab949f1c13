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
  std::vector<std::string> images;           // file name a page; empty where no images were written
  std::vector<std::filesystem::path> files;  // all that were written, a preview last
  std::size_t unplaced = 0, aliases = 0;
  double utilization = 0;
  double cpu_seconds = 0;
};

// Takes the library's placements with y down instead of up: turned round, items would no longer
// begin at multiples of the alignment where blocks of texels are counted, from the upper edge.
PackedAtlas make_atlas(std::vector<PackedItem> items, const PackResult& result);

std::string to_csv(const PackedAtlas& atlas);

// The layouts that game tools read. Page kAllPages lists everything, each frame with its page.
inline constexpr std::uint32_t kAllPages = 0xffffffffu;
std::string to_json(const PackedAtlas& atlas, DataFormat format, std::uint32_t page);

// The one-object summary for --json.
std::string to_summary(const PackedAtlas& atlas);

}  // namespace atlas::app
