// Lit scenes for pipeline tests, made of tests/support shapes.
#pragma once

#include "libatlas/scene/reader.h"
#include "tests/support/shapes.h"

namespace atlas::test {

// The shape as a scene of one white material, lit by a smooth positive function of the position,
// different in every channel and in no way symmetric.
LoadedScene lit_scene(const Shape& shape);

// A furnished box seen from inside: walls of n x n quads, 4 x 3 x 2.5 m, z up, and a ball in it.
LoadedScene lit_room(int n);

}  // namespace atlas::test
