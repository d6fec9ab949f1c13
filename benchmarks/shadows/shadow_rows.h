// Error against time of the shadow methods, drawn without a window, with the sun of docs/player.md.
#pragma once

#include <optional>
#include <vector>

#include "benchmarks/support/results.h"
#include "libatlas/scene/scene.h"

namespace atlas::bench {

struct Look {
  Vec3d from, to;
};

struct ShadowRunOptions {
  int width = 320, height = 200, map_resolution = 1024;
  std::vector<int> intervals{2, 4, 8, 16, 32};  // k: frames between key maps
  int frames = 12;           // light positions; the sun moves 0.5 degrees between them
  std::optional<Look> look;  // none: the initial view of a world
  bool software = true;  // no GPU even if there is one, so that results can be repeated anywhere
};

// Measures one row of stage "shadows" for each method and interval. The error is the mean of
// |visibility - that of a classic map of the same light|; the CPU time is the median of a frame;
// the memory is the most that the process has held so far. Errors: unsupported (no OpenGL 4.5);
// those of the renderer.
Result<std::vector<Row>> measure_shadows(const Scene& scene, const std::string& name,
                                         const ShadowRunOptions& options);

}  // namespace atlas::bench
