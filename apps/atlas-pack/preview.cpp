#include "apps/atlas-pack/preview.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "apps/common/files.h"
#include "libatlas/files/atomic_file.h"
#include "libatlas/files/file_extension.h"
#include "libatlas/image/image_io.h"

namespace atlas::app {
namespace {

constexpr std::int32_t kGap = 16;

std::string xml_text(const std::string& text) {
  std::string safe;
  for (char c : text)
    safe += static_cast<unsigned char>(c) < 0x20 ? "?"  // XML does not allow these
            : c == '&'                           ? "&amp;"
            : c == '<'                           ? "&lt;"
            : c == '>'                           ? "&gt;"
            : c == '"'                           ? "&quot;"
                                                 : std::string(1, c);
  return safe;
}

// Returns the box of an item on its page, y down. Items without area may be longer than the page:
// they end where numbers do.
Rect box_of(const PackedItem& item) {
  constexpr std::int32_t kEnd = std::numeric_limits<std::int32_t>::max();
  const auto [x, y] = std::pair(item.at.x, item.at.y);
  Extent e = item.size;
  if (item.at.rotated) std::swap(e.width, e.height);
  return {x, y, std::min(e.width, kEnd - std::max(x, 0)),
          std::min(e.height, kEnd - std::max(y, 0))};
}

// Returns the colour of a number. The hue advances in golden-ratio steps, and the brightness
// alternates.
Rgb numbered_color(std::size_t number) {
  const double hue = std::fmod(static_cast<double>(number) * 0.61803398875, 1.0) * 6;
  const double value = 0.7 + 0.1 * static_cast<double>(number % 4);
  Rgb rgb;
  for (int c = 0; c < 3; ++c) {
    const double distance = std::abs(std::fmod(hue + 6 - 2 * c, 6.0) - 3);
    const double channel = std::clamp(distance - 0.5, 0.25, 1.0);
    rgb[std::size_t(c)] = static_cast<std::uint8_t>(255 * value * channel);
  }
  return rgb;
}

int difference(const Rgb& a, const Rgb& b) {
  int sum = 0;
  for (std::size_t c = 0; c < 3; ++c) sum += std::abs(a[c] - b[c]);
  return sum;
}

bool neighbours(const PackedItem& a, const PackedItem& b) {
  constexpr std::int64_t kNear = 16;  // gutters are narrower; a box may end at the largest integer
  if (!a.at.placed() || a.at.page != b.at.page) return false;
  const Rect p = box_of(a), q = box_of(b);
  return p.x <= q.right() + kNear && q.x <= p.right() + kNear && p.y <= q.top() + kNear &&
         q.y <= p.top() + kNear;
}

std::string to_svg(const PackedAtlas& atlas) {
  const PageRow row(atlas.pages);
  const std::vector<Rgb> colors = item_colors(atlas);
  std::string items;
  for (std::size_t i = 0; i < atlas.items.size(); ++i) {
    const PackedItem& item = atlas.items[i];
    if (!item.at.placed() || item.at.page >= row.left.size()) continue;
    const Rect box = box_of(item);
    const Rgb& rgb = colors[i];
    items += fmt::format(
        "<rect x=\"{}\" y=\"{}\" width=\"{}\" height=\"{}\" fill=\"#{:02x}{:02x}{:02x}\">"
        "<title>{}</title></rect>\n",
        row.left[item.at.page] + box.x, box.y, box.width, box.height, rgb[0], rgb[1], rgb[2],
        xml_text(item.name));
  }
  return to_svg(row, atlas.pages, items);
}

}  // namespace

std::vector<Rgb> item_colors(const PackedAtlas& atlas) {
  constexpr std::size_t kColors = 12, kMostCompared = 5000;
  std::vector<Rgb> colors(atlas.items.size());
  const bool few = colors.size() <= kMostCompared;
  for (std::size_t i = 0; i < colors.size(); ++i) {
    std::array<int, kColors> least;  // the least difference from a neighbour, for each colour
    least.fill(std::numeric_limits<int>::max());
    for (std::size_t j = 0; few && j < i; ++j) {
      if (!neighbours(atlas.items[i], atlas.items[j])) continue;
      for (std::size_t k = 0; k < kColors; ++k)
        least[k] = std::min(least[k], difference(numbered_color(i + k), colors[j]));
    }
    const auto best = std::max_element(least.begin(), least.end()) - least.begin();
    colors[i] = numbered_color(i + std::size_t(best));
  }
  return colors;
}

PageRow::PageRow(std::span<const Extent> pages) {
  std::int64_t at = 0;
  for (const Extent& page : pages) {
    left.push_back(at);
    width = at + page.width;
    height = std::max<std::int64_t>(height, page.height);
    at = width + kGap;
  }
}

std::string to_svg(const PageRow& row, std::span<const Extent> pages, const std::string& items) {
  std::string svg = fmt::format(
      "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {} {}\">\n", row.width, row.height);
  for (std::size_t p = 0; p < pages.size(); ++p)
    svg += fmt::format("<rect x=\"{}\" y=\"0\" width=\"{}\" height=\"{}\" fill=\"#333\"/>\n",
                       row.left[p], pages[p].width, pages[p].height);
  return svg + items + "</svg>\n";
}

PreviewSheet::PreviewSheet(std::span<const Extent> pages) {
  constexpr std::int64_t kLargest = 4096;
  const PageRow row(pages);
  const std::int64_t width = row.width, height = row.height;
  const std::int64_t step =
      std::clamp<std::int64_t>((std::max(width, height) + kLargest - 1) / kLargest, 1, 1 << 30);
  step_ = static_cast<std::int32_t>(step);
  image_ = Image8(static_cast<int>((width + step - 1) / step),
                  static_cast<int>((height + step - 1) / step), 3, 255);
  constexpr Rgb kFree{51, 51, 51};
  for (std::uint32_t p = 0; p < pages.size(); ++p) {
    const Extent page = pages[p];
    const auto at = static_cast<std::int32_t>(row.left[p] / step);
    pages_.push_back({at, std::min(page.width / step_, image_.width - at), page.height / step_});
    fill(p, {0, 0, page.width, page.height}, kFree,
         [](std::int32_t, std::int32_t) { return true; });
  }
}

Status PreviewSheet::write(const std::filesystem::path& path, AtomicFiles& files) const {
  return files.told_by_target(write_png(files.path_for(path), image_, {}));
}

Status check_preview(const PackCommand& command) {
  const std::filesystem::path& preview = command.preview;
  const std::string ending = lower_extension(preview);
  if (!preview.empty() && ending != ".svg" && ending != ".png")
    return {ErrorCode::bad_option,
            fmt::format("{}: unknown preview format (use .svg or .png)", preview.string())};
  return check_output(preview, {command.input});
}

Status write_preview(const std::filesystem::path& path, const PackedAtlas& atlas,
                     AtomicFiles& files) {
  if (lower_extension(path) == ".svg") return files.write(path, to_svg(atlas));
  PreviewSheet sheet(atlas.pages);
  const std::vector<Rgb> colors = item_colors(atlas);
  for (std::size_t i = 0; i < atlas.items.size(); ++i) {
    const PackedItem& item = atlas.items[i];
    if (!item.at.placed() || item.at.page >= atlas.pages.size()) continue;
    const Rect box = box_of(item);
    const std::int32_t bottom = atlas.pages[item.at.page].height - box.top();
    sheet.fill(item.at.page, {box.x, bottom, box.width, box.height}, colors[i],
               [](std::int32_t, std::int32_t) { return true; });
  }
  return sheet.write(path, files);
}

}  // namespace atlas::app
