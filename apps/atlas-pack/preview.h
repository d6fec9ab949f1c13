// Pictures of a layout: items in distinct colours, free space in dark grey.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "apps/atlas-pack/packed_atlas.h"
#include "libatlas/core/image.h"
#include "libatlas/core/rect.h"
#include "libatlas/core/status.h"
#include "libatlas/files/atomic_file.h"

namespace atlas::app {

using Rgb = std::array<std::uint8_t, 3>;

// Returns a colour for every item. Of a few colours, each item gets the one that differs most from
// those of its neighbours on the page before it in the list. Items are neighbours if their boxes
// nearly touch. In lists too long to compare all pairs, colours only differ from those of the
// neighbours in the list.
std::vector<Rgb> item_colors(const PackedAtlas& atlas);

// The positions of pages side by side with gaps between them, in texels.
struct PageRow {
  std::vector<std::int64_t> left;      // 1 per page
  std::int64_t width = 1, height = 1;  // of the whole row

  explicit PageRow(std::span<const Extent> pages);
};

// Returns a picture of the pages, with `items` drawn upon it: SVG elements, y down.
std::string to_svg(const PageRow& row, std::span<const Extent> pages, const std::string& items);

// A picture of pages side by side with gaps. It shows every step-th texel, so that it has at most
// about 4096 pixels per side, however large the pages are.
class PreviewSheet {
 public:
  explicit PreviewSheet(std::span<const Extent> pages);

  // Calls inside(x, y) for the texels drawn in this part of a page, with coordinates from its lower
  // left corner, and colours those for which it returns true.
  template <class Inside>
  void fill(std::uint32_t page, const Rect& part, const Rgb& rgb, const Inside& inside) {
    const Drawn& to = pages_[page];
    // An item without area may have one side of any length, and so begin far below its page.
    const auto first = [this](std::int64_t texel) {
      return static_cast<std::int32_t>((std::max<std::int64_t>(texel, 0) + step_ - 1) / step_);
    };
    for (std::int32_t y = first(part.y); y < std::min(to.height, first(part.top())); ++y)
      for (std::int32_t x = first(part.x); x < std::min(to.width, first(part.right())); ++x)
        if (inside(x * step_, y * step_)) std::copy_n(rgb.data(), 3, image_.at(to.left + x, y));
  }

  // Writes the picture as one of `files`.
  Status write(const std::filesystem::path& path, AtomicFiles& files) const;

 private:
  struct Drawn {
    std::int32_t left = 0, width = 0, height = 0;  // pixels
  };
  std::int32_t step_ = 1;  // texels per pixel
  std::vector<Drawn> pages_;
  Image8 image_;
};

// Checks that the command's preview, if any, has a known format and can be written.
Status check_preview(const PackCommand& command);

// Draws the frames as one of `files`; the extension (.svg or .png) chooses the format.
Status write_preview(const std::filesystem::path& path, const PackedAtlas& atlas,
                     AtomicFiles& files);

}  // namespace atlas::app
