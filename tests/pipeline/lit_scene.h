// Lit scenes for pipeline tests, made from shapes of tests/support.
#pragma once

#include "libatlas/scene/reader.h"
#include "tests/support/shapes.h"

namespace atlas::test {

// Returns the shape as a scene with one white material. It is lit by a smooth positive function of
// the position that differs between channels and has no symmetry.
LoadedScene lit_scene(const Shape& shape);

// Returns a box seen from inside, 4 x 3 x 2.5 m with walls of n x n quads and z up, with a ball in
// it.
LoadedScene lit_room(int n);

}  // namespace atlas::test
