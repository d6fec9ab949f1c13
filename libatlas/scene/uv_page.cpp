#include "libatlas/scene/uv_page.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>

namespace atlas {
namespace {

constexpr std::string_view kSquare = "uvs of a square page", kPage = "uvs of a page of ",
                           kTimes = " x ";

// Reads a whole number from the start of the text, and removes it. Returns 0 if there is none.
std::int32_t take_number(std::string_view& text) {
  std::int32_t number = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
  if (error != std::errc()) return 0;
  text.remove_prefix(static_cast<std::size_t>(end - text.data()));
  return number;
}

}  // namespace

std::string uv_page_text(std::int32_t width, std::int32_t height) {
  return width == height ? fmt::format("{}, packed for {} x {} texels", kSquare, width, height)
                         : fmt::format("{}{}{}{} texels: textures must have this shape", kPage,
                                       width, kTimes, height);
}

double uv_aspect_of(std::string_view line) {
  while (!line.empty() && (line[0] == '#' || line[0] == ' ')) line.remove_prefix(1);
  if (line.starts_with(kSquare)) return 1;
  if (!line.starts_with(kPage)) return 0;
  line.remove_prefix(kPage.size());
  const std::int32_t width = take_number(line);
  if (width < 1 || !line.starts_with(kTimes)) return 0;
  line.remove_prefix(kTimes.size());
  const std::int32_t height = take_number(line);
  // Longer pages than these do not exist, and charts of other ratios would be refused.
  constexpr std::int32_t kLongest = 1 << 17;
  return height < 1 || std::max(width, height) > kLongest ? 0 : double(width) / height;
}

}  // namespace atlas
