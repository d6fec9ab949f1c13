// The whole cabin, as atlas-make-cabin writes it.
#pragma once

#include <functional>
#include <string>

#include "examples/cabin/refine.h"

namespace cabin {

// Shadow rays a vertex. Larger meshes get fewer: their triangles average them anyway.
int default_samples(std::size_t triangles);

// The cabin that light_cabin() refines to `triangles`, unlit.
Mesh coarse_cabin(std::size_t triangles);

// Lights it and refines it; `say` hears of each step that is done. Once the context is cancelled
// the mesh is left half made.
void light_cabin(
    Mesh& mesh, std::size_t triangles, const LightingOptions& options,
    const atlas::Context& context,
    const std::function<void(const std::string&)>& say = [](const std::string&) {});

}  // namespace cabin
