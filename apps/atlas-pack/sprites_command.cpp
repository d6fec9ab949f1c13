#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <set>
#include <tuple>

#include "apps/atlas-pack/commands.h"
#include "apps/atlas-pack/frame_names.h"
#include "apps/atlas-pack/preview.h"
#include "apps/common/depfile.h"
#include "apps/common/files.h"
#include "libatlas/files/atomic_file.h"
#include "libatlas/files/file_extension.h"
#include "libatlas/image/image_io.h"
#include "libatlas/image/image_sides.h"

namespace atlas::app {
namespace {

namespace fs = std::filesystem;

struct Sprite {
  std::string name;  // path below the folder, with '/'
  Image8 image;      // RGBA, trimmed
  Extent source;
  std::int32_t trim_x = 0, trim_y = 0;  // from the upper left corner
  std::int32_t alias_of = -1;           // earlier sprite with the same texels
};

bool is_image(const fs::path& path) {
  static const char* const known[] = {".png", ".jpg",  ".jpeg", ".tga", ".bmp",
                                      ".tif", ".tiff", ".gif",  ".webp"};
  const std::string ending = lower_extension(path);
  return std::find(std::begin(known), std::end(known), ending) != std::end(known);
}

// Whether an ending is that of images for graphics hardware or browsers, or of a format of sprite
// data, that this program does not write. Other endings may be part of a name ("hero.v2").
bool is_other_format(const std::string& ending) {
  static const char* const known[] = {".ktx", ".ktx2",  ".basis", ".dds", ".pvr",   ".avif",
                                      ".jxl", ".heic",  ".heif",  ".jp2", ".exr",   ".hdr",
                                      ".svg", ".plist", ".xml",   ".csv", ".atlas", ".tpsheet"};
  return std::find(std::begin(known), std::end(known), ending) != std::end(known);
}

Image8 to_rgba(const Image8& in) {
  Image8 out(in.width, in.height, 4, std::uint8_t{255});
  for (int y = 0; y < in.height; ++y)
    for (int x = 0; x < in.width; ++x) {
      const std::uint8_t* from = in.at(x, y);
      std::uint8_t* to = out.at(x, y);
      for (int k = 0; k < 3; ++k) to[k] = from[in.channels >= 3 ? k : 0];
      if (in.channels == 2 || in.channels >= 4) to[3] = from[in.channels == 2 ? 1 : 3];
    }
  return out;
}

// Cuts the image to the box of texels whose alpha is above the threshold; at least one texel stays.
void trim(Sprite& sprite, int threshold) {
  const Image8& in = sprite.image;
  int x0 = in.width, x1 = -1, y0 = in.height, y1 = -1;
  for (int y = 0; y < in.height; ++y)
    for (int x = 0; x < in.width; ++x) {
      if (in.at(x, y)[3] <= threshold) continue;
      x0 = std::min(x0, x);
      x1 = std::max(x1, x);
      y0 = std::min(y0, y);
      y1 = std::max(y1, y);
    }
  if (x1 < 0) x0 = x1 = 0, y0 = y1 = in.height - 1;
  Image8 out(x1 - x0 + 1, y1 - y0 + 1, 4);
  for (int y = y0; y <= y1; ++y)
    std::copy_n(in.at(x0, y), std::size_t(out.width) * 4, out.at(0, y - y0));
  sprite.trim_x = x0;
  sprite.trim_y = in.height - 1 - y1;
  sprite.image = std::move(out);
}

struct SpriteFolder {
  std::vector<fs::path> images;   // in natural order
  std::vector<fs::path> folders;  // those that were listed
};

// Lists the images of the folder and its subfolders, and says what is left out.
Result<SpriteFolder> list_sprites(const fs::path& folder, const Context& context) {
  std::error_code error;
  if (!fs::is_directory(folder, error))
    return Status(ErrorCode::not_found,
                  fmt::format("{}: is no folder (give the folder of images)", folder.string()));
  SpriteFolder found;
  found.folders.push_back(folder);
  for (fs::recursive_directory_iterator it(folder, error), end; it != end; it.increment(error)) {
    if (error) break;
    std::error_code unknown;
    const fs::path& path = it->path();
    const auto left_out = [&](const char* why) {
      context.say(fmt::format("{}: left out, {}", path.string(), why));
    };
    const bool is_folder = it->is_directory(unknown);
    if (is_folder && !it->is_symlink(unknown))
      found.folders.push_back(path);
    else if (is_folder)
      left_out("a link to a folder");
    else if (!it->is_regular_file(unknown))
      left_out("no file to read (a broken link, a pipe or a device)");
    else if (path.filename().string().starts_with("._"))
      left_out("what macOS keeps beside a file");
    else if (is_image(path))
      found.images.push_back(path);
    else
      left_out("no image by its ending");
  }
  if (error) return Status(ErrorCode::io, fmt::format("{}: {}", folder.string(), error.message()));
  if (found.images.empty())
    return Status(
        ErrorCode::bad_input,
        fmt::format("{}: holds no image (png, jpg, tga, bmp, tif, gif or webp)", folder.string()));
  std::sort(found.images.begin(), found.images.end(), natural_less);
  std::sort(found.folders.begin(), found.folders.end());
  return found;
}

// Refuses an image that is larger than the page, before memory is taken to decode it: a file of a
// megabyte can state a gigabyte. One whose borders are trimmed may become smaller, but not from any
// size.
Status check_sides(const fs::path& path, const PackCommand& c) {
  constexpr double kFewTexels = 1 << 24, kMostPages = 16;
  const std::optional<ImageSides> sides = image_sides(path);
  if (!sides) return {};
  const Extent& page = c.options.page;  // a height of 0 is any height
  const double width = page.width, height = page.height > 0 ? page.height : HUGE_VAL;
  const double w = double(sides->width), h = double(sides->height);
  const bool fits =
      (w <= width && h <= height) || (c.options.allow_rotation && h <= width && w <= height);
  if (fits || (c.trim && w * h <= std::max(kFewTexels, kMostPages * width * height))) return {};
  return {
      ErrorCode::no_solution,
      fmt::format("{}: {} x {} texels are more than the page of {} x {} can hold (give a larger "
                  "--page, or a smaller image)",
                  path.string(), sides->width, sides->height, page.width,
                  page.height > 0 ? fmt::format("{}", page.height) : "any height")};
}

Result<std::vector<Sprite>> read_sprites(const PackCommand& c, const SpriteFolder& folder,
                                         const Context& context) {
  const std::vector<fs::path>& paths = folder.images;
  std::vector<Sprite> sprites;
  std::set<std::string> names;
  for (std::size_t i = 0; i < paths.size(); ++i) {
    if (context.cancelled()) return Status::cancelled();
    context.report("read", double(i) / double(paths.size()));
    if (Status s = check_sides(paths[i], c); !s.ok()) return s;
    Result<Image8> image = read_image8(paths[i]);
    if (!image.ok()) return image.status();
    Sprite s;
    s.name = fs::relative(paths[i], c.input).generic_string();
    if (!names.insert(name_in_json(s.name)).second)
      return Status(
          ErrorCode::bad_input,
          fmt::format("{}: its name is not UTF-8, and another image has the same name once "
                      "such bytes are replaced (rename one)",
                      paths[i].string()));
    s.source = {image->width, image->height};
    s.image = to_rgba(*image);
    if (c.trim) trim(s, c.trim_threshold);
    sprites.push_back(std::move(s));
  }
  return sprites;
}

// Finds images with the same texels. The first by name keeps them; the others become its aliases.
void find_aliases(std::vector<Sprite>& sprites) {
  const auto before = [&](std::int32_t a, std::int32_t b) {
    const Image8 &x = sprites[std::size_t(a)].image, &y = sprites[std::size_t(b)].image;
    return std::tie(x.width, x.height, x.texels) < std::tie(y.width, y.height, y.texels);
  };
  std::set<std::int32_t, decltype(before)> seen(before);
  for (std::size_t i = 0; i < sprites.size(); ++i) {
    const auto [at, fresh] = seen.insert(static_cast<std::int32_t>(i));
    if (!fresh) sprites[i].alias_of = *at;
  }
}

// Copies a sprite to its frame (y down), turned clockwise if rotated, and repeats its edge texels
// outwards.
void blit(const Sprite& sprite, const Placement& at, int extrude, Image8& page) {
  const Image8& in = sprite.image;
  const int w = at.rotated ? in.height : in.width, h = at.rotated ? in.width : in.height;
  for (int y = -extrude; y < h + extrude; ++y)
    for (int x = -extrude; x < w + extrude; ++x) {
      const int cx = std::clamp(x, 0, w - 1), cy = std::clamp(y, 0, h - 1);  // frame, y down
      // Clockwise: the source's upper left corner comes to the upper right.
      const int sx = at.rotated ? cy : cx, sy = at.rotated ? in.height - 1 - cx : cy;
      const int px = at.x + x, py = at.y + y;
      std::copy_n(in.at(sx, in.height - 1 - sy), 4, page.at(px, page.height - 1 - py));
    }
}

// Returns the command with the base name of the outputs: NAME.png and NAME.json both mean NAME.
// Refuses the names of other formats, because pages are PNG images and their data are JSON.
Result<PackCommand> with_base_name(const PackCommand& command) {
  const std::string ending = lower_extension(command.output);
  PackCommand c = command;
  if (ending == ".png" || ending == ".json")
    c.output.replace_extension();
  else if (is_image(c.output) || is_other_format(ending))
    return Status(ErrorCode::bad_option,
                  fmt::format("{}: pages are PNG images, and their data are JSON (name them NAME, "
                              "NAME.png or NAME.json)",
                              c.output.string()));
  return c;
}

// Refuses pages of more than 2^30 texels (4 GiB), because no program reads larger images.
Status check_sizes(const PackedAtlas& atlas) {
  constexpr std::int64_t kMostTexels = std::int64_t{1} << 30;
  for (const Extent& page : atlas.pages)
    if (page.area() > kMostTexels)
      return {ErrorCode::bad_option,
              fmt::format("--page: an image of {} x {} texels takes {:.0f} GiB (give a smaller "
                          "--page, or --crop)",
                          page.width, page.height, double(page.area()) / (1 << 28))};
  return {};
}

std::string page_image(const PackCommand& c, std::size_t page, std::size_t pages) {
  const std::string base = c.output.filename().string();
  return pages == 1 ? base + ".png" : fmt::format("{}-{}.png", base, page);
}

// Names the pages that an earlier run to the same name, with more or fewer pages, has left: they
// are not part of this atlas.
void name_old_pages(const PackCommand& c, std::size_t pages, const Context& context) {
  const fs::path folder = c.output.parent_path();
  std::vector<fs::path> old = files_there(
      pages == 1 ? 0 : pages, [&](std::size_t p) { return folder / page_image(c, p, 2); });
  std::error_code error;
  const fs::path single = folder / page_image(c, 0, 1);
  if (pages > 1 && fs::exists(single, error)) old.insert(old.begin(), single);
  if (old.empty()) return;
  context.say(old_pages_text(old, "run with other pages", "this atlas"));
}

// Returns whether a path lies in a folder, after following links.
bool lies_in(const fs::path& path, const fs::path& folder) {
  std::error_code error;
  for (fs::path up = fs::weakly_canonical(path, error);; up = up.parent_path()) {
    if (fs::equivalent(up, folder, error)) return true;
    if (!up.has_relative_path()) return false;
  }
}

Status check_links(const PackCommand& c, const fs::path& page) {
  std::error_code error;
  if (!fs::is_symlink(page, error) || !lies_in(page, c.input)) return {};
  return {ErrorCode::bad_option,
          fmt::format("{}: leads into the folder that is read (remove the link, or give the output "
                      "another name)",
                      page.string())};
}

// Returns the rule that tells what the sheet was made from; empty if none is asked for. Its target
// is the first page, or with `of_data` the data of that page. Folders are inputs, too, because they
// change when an image is added or removed.
Result<std::string> rule_of(const PackCommand& c, const SpriteFolder& read, bool of_data,
                            std::size_t pages) {
  if (c.depfile.empty()) return std::string();
  const std::string image = page_image(c, 0, pages);
  std::vector<fs::path> inputs = read.folders;
  inputs.insert(inputs.end(), read.images.begin(), read.images.end());
  return dependency_rule(c.output.parent_path() / (of_data ? data_of_page(image) : image), inputs);
}

// Writes the pages, the data of the frames on them, and the preview.
Status write_files(const PackCommand& c, const std::vector<Sprite>& sprites, PackedAtlas& atlas,
                   AtomicFiles& files) {
  for (std::size_t p = 0; p < atlas.pages.size(); ++p)
    atlas.images.push_back(page_image(c, p, atlas.pages.size()));
  for (std::uint32_t p = 0; p < atlas.pages.size(); ++p) {
    Image8 page(atlas.pages[p].width, atlas.pages[p].height, 4);
    for (std::size_t i = 0; i < sprites.size(); ++i)
      if (sprites[i].alias_of < 0 && atlas.items[i].at.page == p)
        blit(sprites[i], atlas.items[i].at, c.extrude, page);
    const fs::path image = c.output.parent_path() / atlas.images[p];
    const fs::path data = c.output.parent_path() / data_of_page(atlas.images[p]);
    // Only now is it known how many pages there are, whose names the preview must not have.
    if (Status s = check_output(image, {c.preview, c.depfile}); !s.ok()) return s;
    if (Status s = check_output(data, {c.preview, c.depfile}); !s.ok()) return s;
    for (const fs::path& file : {image, data})
      if (Status s = check_links(c, file); !s.ok()) return s;
    if (Status s = write_png(files.path_for(image), page, {}); !s.ok())
      return files.told_by_target(s);
    if (Status s = files.write(data, to_json(atlas, c.format, p)); !s.ok()) return s;
  }
  atlas.files = files.targets();
  if (!c.preview.empty())
    if (Status s = write_preview(c.preview, atlas, files); !s.ok()) return s;
  return {};
}

// Refuses outputs that cannot be written or lie in the folder that is read: there, pages could
// replace a sprite, and would be read as sprites the next time.
Status check_pages(const PackCommand& c) {
  if (!c.output.has_filename())
    return {ErrorCode::bad_option,
            fmt::format("{}: is a folder (add the pages' base name)", c.output.string())};
  const fs::path folder = c.output.has_parent_path() ? c.output.parent_path() : fs::path(".");
  if (lies_in(folder, c.input))
    return {ErrorCode::bad_option,
            fmt::format("{}: lies in the folder that is read (name another folder)",
                        c.output.string())};
  if (Status s = check_output(fs::path(c.output) += ".png", {c.preview, c.depfile}); !s.ok())
    return s;
  if (c.depfile.empty()) return {};
  const fs::path beside = c.depfile.has_parent_path() ? c.depfile.parent_path() : fs::path(".");
  if (lies_in(beside, c.input))
    return {ErrorCode::bad_option,
            fmt::format("{}: lies in the folder that is read, which every run would change (name "
                        "another folder)",
                        c.depfile.string())};
  return check_output(c.depfile, {c.preview});
}

}  // namespace

Result<PackedAtlas> run_images(const PackCommand& command, const Context& context) {
  const Result<PackCommand> named = with_base_name(command);
  if (!named.ok()) return named.status();
  const PackCommand& c = *named;
  if (Status s = check_pages(c); !s.ok()) return s;
  if (Status s = check_preview(c); !s.ok()) return s;
  const Result<SpriteFolder> folder = list_sprites(c.input, context);
  if (!folder.ok()) return folder.status();
  const bool of_data = lower_extension(command.output) != ".png";
  // A name that no rule can hold is refused before the work.
  if (const auto rule = rule_of(c, *folder, of_data, 1); !rule.ok()) return rule.status();
  Result<std::vector<Sprite>> read = read_sprites(c, *folder, context);
  if (!read.ok()) return read.status();
  std::vector<Sprite>& sprites = *read;
  if (c.alias) find_aliases(sprites);
  std::vector<Extent> sizes;
  std::vector<PackedItem> items;
  std::size_t aliases = 0;
  for (const Sprite& s : sprites) {
    PackedItem item;
    item.name = s.name;
    item.size = {s.image.width, s.image.height};
    item.source = s.source;
    item.trim_x = s.trim_x;
    item.trim_y = s.trim_y;
    items.push_back(item);
    // Aliases take no space: items with sides of 0 are placed at a corner, and get their original's
    // place below.
    const bool stored = s.alias_of < 0;
    aliases += !stored;
    sizes.push_back(stored ? Extent{s.image.width + 2 * c.extrude, s.image.height + 2 * c.extrude}
                           : Extent{});
  }
  Result<PackResult> packed = pack_rects(sizes, c.options, context);
  if (!packed.ok()) return packed.status();
  if (!packed->unplaced.empty()) {
    const UnplacedItem& u = packed->unplaced.front();
    return Status(ErrorCode::no_solution,
                  fmt::format("{}: {} of {} images have no room, first {} ({} x {}) (give a "
                              "larger --page or more --max-pages)",
                              c.input.string(), packed->unplaced.size(), sprites.size(),
                              sprites[u.item].name, sizes[u.item].width, sizes[u.item].height));
  }
  for (std::size_t i = 0; i < items.size(); ++i) {  // from the extruded box to the frame
    packed->placements[i].x += c.extrude;
    packed->placements[i].y += c.extrude;
  }
  PackedAtlas atlas = make_atlas(std::move(items), *packed);
  for (std::size_t i = 0; i < sprites.size(); ++i)
    if (sprites[i].alias_of >= 0) atlas.items[i].at = atlas.items[sprites[i].alias_of].at;
  atlas.aliases = aliases;
  if (Status s = check_sizes(atlas); !s.ok()) return s;
  AtomicFiles files;  // so that all appear together
  if (Status s = write_files(c, sprites, atlas, files); !s.ok()) return s;
  const Result<std::string> rule = rule_of(c, *folder, of_data, atlas.pages.size());
  if (!rule.ok()) return rule.status();
  if (!rule->empty())
    if (Status s = files.write(c.depfile, *rule); !s.ok()) return s;
  if (Status s = files.commit(); !s.ok()) return s;
  name_old_pages(c, atlas.pages.size(), context);
  return atlas;
}

}  // namespace atlas::app
