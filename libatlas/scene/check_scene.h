// Scenes that a program builds by itself, instead of reading them from a file.
#pragma once

#include "libatlas/core/status.h"
#include "libatlas/scene/scene.h"

namespace atlas {

// Whether the scene keeps what scene.h says of its arrays: their lengths, the ranges of indices,
// finite numbers, images as large as their sizes say. What a reader gives always does; all that
// takes a Scene presumes it. Linear. Error: bad_input, naming array and element.
Status check_scene(const Scene& scene);

// Whether every texture has its image, and none is encoded: what samples textures presumes it.
// Error: bad_input, naming the first.
Status check_images(const Scene& scene);

// Fills in what positions and indices alone leave open, one white material and one object for all
// triangles, each where its arrays are empty; then check_scene().
Status complete_scene(Scene& scene);

}  // namespace atlas
