// The whole cabin as atlas-make-cabin writes it.
#pragma once

#include "examples/cabin/refine.h"

namespace cabin {

// Returns the number of shadow rays per vertex. Larger meshes get fewer, because many vertices
// average out the noise.
int default_samples(std::size_t triangles);

// Returns the unlit cabin that light_cabin() refines to `triangles`; if cancelled, an empty mesh.
Mesh coarse_cabin(std::size_t triangles, const atlas::Context& context = {});

// Lights the mesh and refines it, and reports each completed step to the context. If cancelled, the
// mesh is incomplete.
void light_cabin(Mesh& mesh, std::size_t triangles, const LightingOptions& options,
                 const atlas::Context& context);

}  // namespace cabin
