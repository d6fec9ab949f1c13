#include "libatlas/scene/uv_page.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>

namespace atlas {
namespace {

constexpr std::string_view kSquare = "uvs of a square page", kPacked = ", packed for ",
                           kPage = "uvs of a page of ", kNumbered = "uvs of page ", kTimes = " x ",
                           kSet = "TEXCOORD_";
constexpr std::int64_t kUnnamed = -1;  // the set of a line that names none

// Removes the beginning if the text has it, and returns whether it had.
bool take_text(std::string_view& text, std::string_view beginning) {
  if (!text.starts_with(beginning)) return false;
  text.remove_prefix(beginning.size());
  return true;
}

// Reads a whole number from the start of the text, and removes it. Returns -1 if there is none.
std::int32_t take_number(std::string_view& text) {
  std::int32_t number = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
  if (error != std::errc()) return -1;
  text.remove_prefix(static_cast<std::size_t>(end - text.data()));
  return number;
}

// Reads width and height from the start of the text. Both are 0 if there are none.
UvPage extent_at(std::string_view text) {
  const std::int32_t width = take_number(text);
  if (width < 1 || !take_text(text, kTimes)) return {};
  const std::int32_t height = take_number(text);
  // Longer pages than these do not exist, and charts of other ratios would be refused.
  constexpr std::int32_t kLongest = 1 << 17;
  return height < 1 || std::max(width, height) > kLongest ? UvPage{} : UvPage{0, width, height};
}

// Returns the number of the page that a material's name ends in, or -1.
std::int32_t page_number(std::string_view material) {
  for (const std::string_view end : {".png", "_one_sided"})
    if (material.ends_with(end)) material.remove_suffix(end.size());
  std::size_t digits = 0;
  while (digits < material.size() && material[material.size() - 1 - digits] >= '0' &&
         material[material.size() - 1 - digits] <= '9')
    ++digits;
  std::string_view number = material.substr(material.size() - digits);
  material.remove_suffix(digits);
  return material.ends_with('.') ? -1 : take_number(number);  // "page1.001" is a copy of page1
}

// What one line says.
struct PageLine {
  std::int64_t set = kUnnamed;
  std::optional<std::uint32_t> page = {};  // nothing: of the only one
  double aspect = 0;                       // 0: the line says no page
  UvPage extent = {};

  void take_extent(std::string_view text) {
    extent = extent_at(text);
    if (extent.height > 0) aspect = double(extent.width) / extent.height;
  }
};

PageLine parse(std::string_view line) {
  PageLine said;
  while (!line.empty() && (line[0] == '#' || line[0] == ' ' || line[0] == '"'))
    line.remove_prefix(1);
  if (take_text(line, kSet)) {
    said.set = take_number(line);
    if (said.set < 0 || !take_text(line, ": ")) return {};
  }
  if (take_text(line, kSquare)) {
    if (take_text(line, kPacked)) said.take_extent(line);
    said.aspect = 1;
  } else if (take_text(line, kPage)) {
    said.take_extent(line);
  } else if (take_text(line, kNumbered)) {
    const std::int32_t page = take_number(line);
    if (page < 0 || !take_text(line, ": ")) return {};
    said.page = static_cast<std::uint32_t>(page);
    said.take_extent(line);
    said.extent.number = *said.page;
  }
  return said;
}

}  // namespace

std::string uv_page_text(std::int32_t width, std::int32_t height) {
  return width == height ? fmt::format("{}{}{}{}{} texels", kSquare, kPacked, width, kTimes, height)
                         : fmt::format("{}{}{}{} texels: textures must have this shape", kPage,
                                       width, kTimes, height);
}

std::string uv_page_text(std::size_t page, std::int32_t width, std::int32_t height) {
  return fmt::format("{}{}: {}{}{} texels", kNumbered, page, width, kTimes, height);
}

std::string of_uv_set(std::int64_t set, const std::string& line) {
  return line.starts_with(kSet) ? line : fmt::format("{}{}: {}", kSet, set, line);
}

std::optional<std::int64_t> uv_set_of_page(std::string_view line) {
  const PageLine said = parse(line);
  if (said.aspect == 0) return {};
  return said.set == kUnnamed ? 0 : said.set;
}

void UvPages::take(std::string_view line) {
  const PageLine said = parse(line);
  if (said.aspect == 0) return;
  Pages& pages = sets_[said.set];
  if (said.page)
    pages.by_number.try_emplace(*said.page, Page{said.aspect, said.extent});
  else if (pages.single.aspect == 0)
    pages.single = {said.aspect, said.extent};
}

const UvPages::Pages* UvPages::of_set(std::int64_t set) const {
  auto at = sets_.find(set);
  if (at == sets_.end()) at = sets_.find(kUnnamed);
  return at == sets_.end() ? nullptr : &at->second;
}

UvPages::Page UvPages::find(std::string_view material, std::int64_t set) const {
  if (!of_set(set)) return {};
  const Pages& pages = *of_set(set);
  if (pages.by_number.empty()) return pages.single;
  const std::int32_t page = page_number(material);
  const auto found = page < 0 ? pages.by_number.end() : pages.by_number.find(std::uint32_t(page));
  return found == pages.by_number.end() ? pages.single : found->second;
}

double UvPages::aspect_of(std::string_view material, std::int64_t set) const {
  return find(material, set).aspect;
}

UvPage UvPages::page_of(std::string_view material, std::int64_t set) const {
  return find(material, set).page;
}

std::vector<UvPage> UvPages::pages_of(std::int64_t set) const {
  std::vector<UvPage> all;
  const Pages* pages = of_set(set);
  if (pages && pages->by_number.empty()) all.push_back(pages->single.page);
  if (pages)
    for (const auto& [number, page] : pages->by_number) all.push_back(page.page);
  return all;
}

}  // namespace atlas
