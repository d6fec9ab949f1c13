// The subcommands of atlas-pack.
#pragma once

#include "apps/atlas-pack/command_line.h"
#include "apps/atlas-pack/packed_atlas.h"
#include "apps/common/terminal.h"
#include "libatlas/core/status.h"

namespace atlas::app {

// Each reads its input, packs, writes its files (whole or not at all), and returns the layout for
// the summary. Not everything placed is an error for images, and reported in the atlas for rects.
Result<PackedAtlas> run_rects(const PackCommand& command, const Context& context);
Result<PackedAtlas> run_images(const PackCommand& command, const Context& context);
Result<PackedAtlas> run_mesh(const PackCommand& command, const Context& context);

}  // namespace atlas::app
