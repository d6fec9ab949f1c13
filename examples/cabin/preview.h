// Renders a picture of the lit cabin.
#pragma once

#include <filesystem>

#include "examples/cabin/cabin_mesh.h"
#include "libatlas/core/context.h"
#include "libatlas/core/status.h"

namespace cabin {

struct PreviewOptions {
  int width = 1280, height = 720;
  int samples = 3;  // per side of a pixel
};

// Renders the mesh as a viewer of the exported world would show it: illuminance times reflectance,
// interpolated over triangles, through a global tone curve.
atlas::Status write_preview(const std::filesystem::path& path, const Mesh& mesh,
                            const PreviewOptions& options, const atlas::Context& context);

}  // namespace cabin
