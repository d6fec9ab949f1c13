// Pictures of a layout: items in distinct colours, free space in dark grey.
#pragma once

#include <filesystem>

#include "apps/atlas-pack/packed_atlas.h"
#include "libatlas/core/image.h"
#include "libatlas/core/status.h"

namespace atlas::app {

// A colour for item i, RGB; neighbours in the list differ in hue.
void item_color(std::size_t i, std::uint8_t rgb[3]);

// Pages of any drawing, side by side with a gap, scaled down to at most 4096 pixels.
Status write_preview_png(const std::filesystem::path& path, std::span<const Image8> pages);

// Whether the command's preview, if any, has a format that is known and can be written.
Status check_preview(const PackCommand& command);

// Draws the frames; the extension (.svg or .png) chooses the format.
Status write_preview(const std::filesystem::path& path, const PackedAtlas& atlas);

}  // namespace atlas::app
