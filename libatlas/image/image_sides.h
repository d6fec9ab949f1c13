// The sides of an image file, without decoding it.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>

namespace atlas {

struct ImageSides {
  std::int64_t width = 0, height = 0;  // texels, from 1 to 2^31 - 1
};

// Returns the sides that the header of a PNG, JPEG, GIF, BMP, WebP or TIFF file states, or nothing
// if the file is of another format or its first 64 KiB do not state them. Whether the file holds as
// much shows only when it is decoded.
std::optional<ImageSides> image_sides(const std::filesystem::path& path);

// The same for the beginning of a file.
std::optional<ImageSides> sides_in_header(std::span<const std::uint8_t> head);

}  // namespace atlas
