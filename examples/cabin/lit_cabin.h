// The whole cabin, as atlas-make-cabin writes it.
#pragma once

#include "examples/cabin/refine.h"

namespace cabin {

// Shadow rays a vertex. Larger meshes get fewer: their triangles average them anyway.
int default_samples(std::size_t triangles);

// The cabin that light_cabin() refines to `triangles`, unlit.
Mesh coarse_cabin(std::size_t triangles);

// Lights it and refines it; the context is told of each step that is done. Once it is cancelled the
// mesh is left half made.
void light_cabin(Mesh& mesh, std::size_t triangles, const LightingOptions& options,
                 const atlas::Context& context);

}  // namespace cabin
