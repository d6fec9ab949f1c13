// Adaptive refinement where the light changes quickly, as lighting simulations do.
#pragma once

#include "examples/cabin/lighting.h"

namespace cabin {

struct RefineOptions {
  std::size_t triangles = 100000;  // target, reached within what one conforming split adds
  int passes = 12;                 // with relighting between them
};

// Splits edges in descending order of (change of light along the edge) x (its length) until the
// mesh has the wanted size. The result is conforming: every triangle with a split edge has its
// longest edge split, too (Rivara 1984), so no vertex lies inside another triangle's edge. Vertices
// at one position on both sides of a crease move together. New vertices lie on the smooth surface
// (the PN triangle's cubic edge, Vlachos et al. 2001), are lit by `lighting`, and take their
// indirect light from the ends of the edge.
void refine(Mesh& mesh, const RefineOptions& options, const Lighting& lighting,
            const atlas::Context& context);

}  // namespace cabin
