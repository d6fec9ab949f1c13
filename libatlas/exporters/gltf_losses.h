// Internal: what of a glTF file formats without its parts cannot hold.
#pragma once

#include "libatlas/exporters/losses.h"

namespace atlas {

struct GltfSource;

// Adds what the file has beside meshes at rest with names, normals, colours, and materials of plain
// base colours.
void count_losses(const GltfSource& source, Losses& losses);

}  // namespace atlas
