// Names texture coordinates that are so far from the others that their charts cannot be packed.
#pragma once

#include "apps/atlas-pack/commands.h"
#include "apps/atlas-pack/uv_charts.h"
#include "libatlas/core/context.h"
#include "libatlas/core/status.h"

namespace atlas::app {

// Checks that all corners of the charts are within what the packer takes (UvCharts::corners, below
// 1e9 texels). Error: bad_input, with the file, the texture coordinate as the file has it, and its
// line in an OBJ file.
Status check_corners(const PackCommand& command, const UvCharts& charts, const Context& context);

}  // namespace atlas::app
