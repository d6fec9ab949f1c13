// atlas-pack: rectangles, images or uv charts in, densely packed pages out.
#include <fmt/format.h>

#include "apps/atlas-pack/commands.h"
#include "apps/common/program.h"
#include "libatlas/core/clock.h"

namespace {

int main_of(int argc, char** argv) {
  using namespace atlas;
  app::PackCommand command;
  if (const int code = app::parse_command_line(argc, argv, command); code >= 0) return code;
  app::Terminal terminal("atlas-pack", command.quiet || command.json);
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
  if (command.json) app::print(stdout, fmt::format("{}\n", app::to_summary(*atlas)));
  terminal.line(fmt::format(
      "{}: {} item{} on {} page{}, {:.2f} % used{}, {:.3f} CPU s", command.output.string(),
      atlas->items.size(), atlas->items.size() == 1 ? "" : "s", atlas->pages.size(),
      atlas->pages.size() == 1 ? "" : "s", 100 * atlas->utilization,
      atlas->aliases ? fmt::format(", {} aliases", atlas->aliases) : "", atlas->cpu_seconds));
  // Whatever was left out has been named; scripts need to know as well.
  if (atlas->unplaced > 0) {
    terminal.error(fmt::format("{} of {} items were not placed (allow larger or more pages)",
                               atlas->unplaced, atlas->items.size()));
    return 1;
  }
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  return atlas::app::run_program("atlas-pack", argc, argv, main_of);
}
