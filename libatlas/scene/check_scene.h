// Scenes that a program builds by itself, instead of reading them from a file.
#pragma once

#include "libatlas/core/status.h"
#include "libatlas/scene/scene.h"

namespace atlas {

// Checks that the scene keeps what scene.h promises of its arrays: their lengths, the ranges of
// indices, finite numbers, and images as large as their sizes say. Scenes from the readers always
// pass, and every function that takes a Scene relies on it. Takes linear time. Error: bad_input,
// naming array and element.
Status check_scene(const Scene& scene);

// Checks that every texture has a decoded image, which all functions that sample textures rely on.
// Error: bad_input, naming the first texture without one.
Status check_images(const Scene& scene);

// Completes a scene that has only positions and indices: where the arrays of materials or objects
// are empty, all triangles get one white material or one object. Then returns check_scene().
Status complete_scene(Scene& scene);

}  // namespace atlas
