#include "apps/atlas-pack/packed_atlas.h"

#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "apps/atlas-pack/frame_names.h"

namespace atlas::app {
namespace {

using Json = nlohmann::ordered_json;

// Returns a name as a CSV field, quoted if it must be.
std::string csv_field(const std::string& name) {
  if (name.find_first_of(",\"\n\r") == std::string::npos) return name;
  std::string quoted = "\"";
  for (char c : name) quoted += c == '"' ? std::string("\"\"") : std::string(1, c);
  return quoted + "\"";
}

Json frame_of(const PackedItem& item, bool with_page) {
  Json frame;
  frame["frame"] = {
      {"x", item.at.x}, {"y", item.at.y}, {"w", item.size.width}, {"h", item.size.height}};
  frame["rotated"] = item.at.rotated;
  frame["trimmed"] = item.trimmed();
  frame["spriteSourceSize"] = {
      {"x", item.trim_x}, {"y", item.trim_y}, {"w", item.size.width}, {"h", item.size.height}};
  frame["sourceSize"] = {{"w", item.source.width}, {"h", item.source.height}};
  if (with_page) frame["page"] = item.at.page;
  return frame;
}

// Returns the names of the other pages' data, from which loaders find all pages when they are given
// one of them.
Json other_pages(const PackedAtlas& atlas, std::uint32_t page) {
  Json names = Json::array();
  for (std::uint32_t p = 0; p < atlas.images.size(); ++p)
    if (p != page) names.push_back(data_of_page(atlas.images[p]));
  return names;
}

// Returns the animations of all pages, since their frames may lie on several.
Json animations_in(const PackedAtlas& atlas) {
  std::vector<std::string_view> names;
  for (const PackedItem& item : atlas.items) names.push_back(item.name);
  Json animations = Json::object();
  for (Animation& a : animations_of(names))
    animations.get_ref<Json::object_t&>().emplace_back(a.name, std::move(a.frames));
  return animations;
}

}  // namespace

std::string data_of_page(const std::string& image) {
  return std::filesystem::path(image).replace_extension(".json").string();
}

PackedAtlas make_atlas(std::vector<PackedItem> items, const PackResult& result) {
  PackedAtlas atlas;
  atlas.pages = result.pages;
  atlas.utilization = result.utilization;
  double before_last = 0;
  for (std::size_t p = 0; p + 1 < atlas.pages.size(); ++p)
    before_last += double(atlas.pages[p].area());
  if (!atlas.pages.empty()) {
    const double filled = double(result.placed_area) - result.fill_without_last * before_last;
    atlas.last_page_fill = filled / double(atlas.pages.back().area());
  }
  atlas.unplaced = result.unplaced.size();
  for (std::size_t i = 0; i < items.size(); ++i) items[i].at = result.placements[i];
  atlas.items = std::move(items);
  return atlas;
}

std::string to_csv(const PackedAtlas& atlas) {
  std::string text = "name,page,x,y,width,height,rotated\n";
  for (const PackedItem& item : atlas.items) {
    Extent e = item.size;
    if (item.at.rotated) std::swap(e.width, e.height);
    if (item.at.placed())
      text += fmt::format("{},{},{},{},{},{},{}\n", csv_field(item.name), item.at.page, item.at.x,
                          item.at.y, e.width, e.height, int(item.at.rotated));
    else
      text += fmt::format("{},-1,,,{},{},0\n", csv_field(item.name), e.width, e.height);
  }
  return text;
}

std::string name_in_json(const std::string& name) {
  return Json(name).dump(-1, ' ', false, Json::error_handler_t::replace);
}

std::string to_json(const PackedAtlas& atlas, DataFormat format, std::uint32_t page) {
  Json root;
  Json& frames = root["frames"];
  frames = format == DataFormat::hash ? Json::object() : Json::array();
  for (const PackedItem& item : atlas.items) {
    if (!item.at.placed() || (page != kAllPages && item.at.page != page)) continue;
    Json frame = frame_of(item, page == kAllPages);
    if (format == DataFormat::hash) {
      // The members are searched from front to back when one is set by name. Names are unique.
      frames.get_ref<Json::object_t&>().emplace_back(item.name, std::move(frame));
    } else {
      Json named{{"filename", item.name}};
      named.update(frame);
      frames.push_back(std::move(named));
    }
  }
  // Lists of rectangles have none, even if their names end in numbers.
  if (page != kAllPages)
    if (Json animations = animations_in(atlas); !animations.empty())
      root["animations"] = std::move(animations);
  Json& meta = root["meta"];
  meta["app"] = "atlas-pack";
  meta["version"] = "1.0";
  meta["format"] = "RGBA8888";
  meta["scale"] = "1";
  const auto size = [](Extent e) { return Json{{"w", e.width}, {"h", e.height}}; };
  if (page != kAllPages) {
    if (page < atlas.images.size()) meta["image"] = atlas.images[page];
    meta["size"] = size(atlas.pages[page]);
    if (atlas.images.size() > 1) meta["related_multi_packs"] = other_pages(atlas, page);
  } else {
    meta["pages"] = Json::array();
    for (Extent e : atlas.pages) meta["pages"].push_back(size(e));
  }
  // Names come from files and lists, so bytes that are not UTF-8 are replaced.
  return root.dump(1, ' ', false, Json::error_handler_t::replace) + "\n";
}

std::string to_summary(const PackedAtlas& atlas) {
  Json root;
  root["items"] = atlas.items.size();
  root["unplaced"] = atlas.unplaced;
  root["aliases"] = atlas.aliases;
  root["pages"] = Json::array();
  for (Extent e : atlas.pages) root["pages"].push_back({{"width", e.width}, {"height", e.height}});
  root["files"] = Json::array();
  for (const std::filesystem::path& file : atlas.files) root["files"].push_back(file.string());
  root["utilization"] = atlas.utilization;
  root["cpu_seconds"] = atlas.cpu_seconds;
  return root.dump(-1, ' ', false, Json::error_handler_t::replace);
}

}  // namespace atlas::app
