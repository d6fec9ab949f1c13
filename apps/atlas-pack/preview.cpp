#include "apps/atlas-pack/preview.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "apps/common/files.h"
#include "libatlas/core/atomic_file.h"
#include "libatlas/image/image_io.h"

namespace atlas::app {
namespace {

constexpr std::int32_t kGap = 16;

std::string xml_text(const std::string& text) {
  std::string safe;
  for (char c : text)
    safe += c == '&'   ? "&amp;"
            : c == '<' ? "&lt;"
            : c == '>' ? "&gt;"
            : c == '"' ? "&quot;"
                       : std::string(1, c);
  return safe;
}

std::string to_svg(const PackedAtlas& atlas) {
  std::int64_t width = 0, height = 1;
  for (Extent p : atlas.pages) {
    width += p.width + kGap;
    height = std::max<std::int64_t>(height, p.height);
  }
  std::string svg =
      fmt::format("<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {} {}\">\n",
                  std::max<std::int64_t>(1, width - kGap), height);
  std::vector<std::int64_t> left;
  std::int64_t x = 0;
  for (Extent p : atlas.pages) {
    left.push_back(x);
    svg += fmt::format("<rect x=\"{}\" y=\"0\" width=\"{}\" height=\"{}\" fill=\"#333\"/>\n", x,
                       p.width, p.height);
    x += p.width + kGap;
  }
  for (std::size_t i = 0; i < atlas.items.size(); ++i) {
    const PackedItem& item = atlas.items[i];
    if (!item.at.placed() || item.at.page >= left.size()) continue;
    Extent e = item.size;
    if (item.at.rotated) std::swap(e.width, e.height);
    std::uint8_t rgb[3];
    item_color(i, rgb);
    svg += fmt::format(
        "<rect x=\"{}\" y=\"{}\" width=\"{}\" height=\"{}\" fill=\"#{:02x}{:02x}{:02x}\">"
        "<title>{}</title></rect>\n",
        left[item.at.page] + item.at.x, item.at.y, e.width, e.height, rgb[0], rgb[1], rgb[2],
        xml_text(item.name));
  }
  return svg + "</svg>\n";
}

}  // namespace

void item_color(std::size_t i, std::uint8_t rgb[3]) {
  // Golden-ratio steps through the hues, brightness alternating.
  const double hue = std::fmod(static_cast<double>(i) * 0.61803398875, 1.0) * 6;
  const double value = 0.7 + 0.1 * static_cast<double>(i % 4);
  for (int c = 0; c < 3; ++c) {
    const double distance = std::abs(std::fmod(hue + 6 - 2 * c, 6.0) - 3);
    const double channel = std::clamp(distance - 0.5, 0.25, 1.0);
    rgb[c] = static_cast<std::uint8_t>(255 * value * channel);
  }
}

Status write_preview_png(const std::filesystem::path& path, std::span<const Image8> pages) {
  std::int64_t width = 0;
  int height = 1;
  for (const Image8& p : pages) {
    width += p.width + kGap;
    height = std::max(height, p.height);
  }
  const auto step = static_cast<int>(
      std::max<std::int64_t>(1, (std::max<std::int64_t>(width, height) + 4095) / 4096));
  Image8 sheet(static_cast<int>(std::max<std::int64_t>(1, width / step)),
               (height + step - 1) / step, 3, 255);
  std::int64_t left = 0;
  for (const Image8& p : pages) {
    for (int y = 0; y < p.height / step; ++y)
      for (int x = 0; x < p.width / step && left / step + x < sheet.width; ++x)
        std::copy_n(p.at(x * step, y * step), 3, sheet.at(static_cast<int>(left / step) + x, y));
    left += p.width + kGap;
  }
  AtomicFiles files;
  if (Status s = write_png(files.path_for(path), sheet, {}); !s.ok())
    return files.told_by_target(s);
  return files.commit();
}

Status check_preview(const PackCommand& command) {
  const std::filesystem::path& preview = command.preview;
  const std::string ending = lower_extension(preview);
  if (!preview.empty() && ending != ".svg" && ending != ".png")
    return {ErrorCode::bad_option,
            fmt::format("{}: unknown preview format (use .svg or .png)", preview.string())};
  return check_output(preview, {command.input});
}

Status write_preview(const std::filesystem::path& path, const PackedAtlas& atlas) {
  if (lower_extension(path) == ".svg") return write_file(path, to_svg(atlas));
  std::vector<Image8> pages;
  for (Extent p : atlas.pages) pages.emplace_back(p.width, p.height, 3, std::uint8_t{51});
  for (std::size_t i = 0; i < atlas.items.size(); ++i) {
    const PackedItem& item = atlas.items[i];
    if (!item.at.placed() || item.at.page >= pages.size()) continue;
    Extent e = item.size;
    if (item.at.rotated) std::swap(e.width, e.height);
    Image8& page = pages[item.at.page];
    std::uint8_t rgb[3];
    item_color(i, rgb);
    for (int y = 0; y < e.height; ++y)
      for (int x = 0; x < e.width; ++x)
        std::copy_n(rgb, 3, page.at(item.at.x + x, page.height - 1 - item.at.y - y));
  }
  return write_preview_png(path, pages);
}

}  // namespace atlas::app
