// The subcommands of atlas-pack.
#pragma once

#include "apps/atlas-pack/command_line.h"
#include "apps/atlas-pack/packed_atlas.h"
#include "apps/common/terminal.h"
#include "libatlas/core/status.h"

namespace atlas::app {

// Each reads its input, packs, writes its files (whole or not at all), and returns the layout for
// the summary. Items that cannot be placed are an error for images; for rects they are reported in
// the atlas.
Result<PackedAtlas> run_rects(const PackCommand& command, const Context& context);
Result<PackedAtlas> run_images(const PackCommand& command, const Context& context);
Result<PackedAtlas> run_mesh(const PackCommand& command, const Context& context);

}  // namespace atlas::app
