// atlas-pack: rectangles, images or uv charts in, densely packed pages out.
#include <fmt/format.h>

#include <algorithm>
#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <string_view>

#include "apps/atlas-pack/commands.h"
#include "apps/common/options.h"
#include "apps/common/program.h"
#include "libatlas/core/clock.h"
#include "libatlas/core/counted.h"
#include "libatlas/pack/larger_pages.h"

namespace {

using namespace atlas;

// Warns of many pages, each of which is a file to load and a texture to bind, and names larger ones
// that would do.
void advise_on_pages(const app::PackCommand& command, const app::PackedAtlas& atlas,
                     const Context& context) {
  if (atlas.pages.size() <= kManyPages) return;
  double texels = 0;
  std::int32_t largest = 1;
  for (const Extent& page : atlas.pages) {
    texels += double(page.area());
    largest = std::max({largest, page.width, page.height});
  }
  if (largest > kCommonSide / 2) return;
  const auto [side, count] = larger_pages(texels, 2 * largest);
  const std::string wanted = command.kind == app::PackCommand::Kind::mesh
                                 ? fmt::format("--page {} --pages {}", side, count)
                                 : fmt::format("--page {0}x{0}", side);
  context.say(fmt::format(
      "{} pages, each a texture of its own, are slow to load and to draw ({} takes about {})",
      atlas.pages.size(), wanted, count));
}

// Warns if the last page, which is the emptiest, is mostly empty: sprites rarely fill the 2048 x
// 2048 texels of a page.
void advise_on_room(const app::PackCommand& command, const app::PackedAtlas& atlas,
                    const Context& context) {
  constexpr double kMostlyEmpty = 0.25;
  if (command.kind != app::PackCommand::Kind::images || command.options.crop) return;
  if (atlas.pages.empty() || atlas.last_page_fill >= kMostlyEmpty) return;
  const Extent& last = atlas.pages.back();
  context.say(fmt::format("{}{} x {} texels are mostly empty (--crop cuts them to what is used)",
                          atlas.images.size() > 1 ? atlas.images.back() + ": " : "", last.width,
                          last.height));
}

// "3 items on 1 page", "2 of 3 items on 1 page".
std::string counts_of(const app::PackedAtlas& atlas) {
  const std::size_t items = atlas.items.size(), pages = atlas.pages.size();
  return fmt::format("{}{} on {}",
                     atlas.unplaced > 0 ? fmt::format("{} of ", items - atlas.unplaced) : "",
                     counted(items, "item"), counted(pages, "page"));
}

// "sheet.png, sheet.json", "sheet-0.png, sheet-0.json, ... sheet-8.json".
std::string names_of(std::span<const std::filesystem::path> files) {
  constexpr std::size_t kNamed = 4;
  std::string names;
  for (const auto& file : files.first(std::min(files.size(), kNamed) - 1))
    names += file.string() + ", ";
  return names + (files.size() > kNamed ? "... " : "") + files.back().string();
}

int main_of(int argc, char** argv) {
  app::PackCommand command;
  if (const int code = app::parse_command_line(argc, argv, command); code >= 0) return code;
  app::name_input(command.input);
  app::Terminal terminal("atlas-pack", command.quiet || command.json);
  terminal.reword([](std::string_view text) { return app::with_flags(text, app::kTrustFlags); });
  const Context context = terminal.context(command.threads);
  const double start = cpu_seconds();
  Result<app::PackedAtlas> atlas =
      command.kind == app::PackCommand::Kind::rects    ? app::run_rects(command, context)
      : command.kind == app::PackCommand::Kind::images ? app::run_images(command, context)
                                                       : app::run_mesh(command, context);
  if (!atlas.ok()) {
    terminal.error(atlas.status().message());
    return app::exit_code(atlas.status());
  }
  atlas->cpu_seconds = cpu_seconds() - start;
  if (!command.preview.empty()) atlas->files.push_back(command.preview);
  if (command.json) app::print(stdout, fmt::format("{}\n", app::to_summary(*atlas)));
  terminal.line(
      fmt::format("{}: {}, {:.2f} % used{}, {:.3f} CPU s", names_of(atlas->files),
                  counts_of(*atlas), 100 * atlas->utilization,
                  atlas->aliases ? fmt::format(", {} sharing another's place", atlas->aliases) : "",
                  atlas->cpu_seconds));
  if (atlas->unplaced == 0) advise_on_pages(command, *atlas, context);
  advise_on_room(command, *atlas, context);
  // The items that were left out have been named; the exit code tells it to scripts.
  if (atlas->unplaced > 0) {
    terminal.error(
        fmt::format("no place for {} of {} items (give a larger --page or more --max-pages)",
                    atlas->unplaced, atlas->items.size()));
    return 1;
  }
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  return atlas::app::run_program("atlas-pack", argc, argv, main_of);
}
