// Internal: seams where the light jumps. Walls that meet at a crease often have vertices of their
// own there, with other light: illuminance depends on the normal. A chart that continues across
// such an edge would blur the jump over a texel.
#pragma once

#include <cstdint>
#include <vector>

#include "libatlas/core/context.h"
#include "libatlas/texture/luminance.h"
#include "libatlas/texture/tone.h"

namespace atlas {

struct LightSeamOptions {
  // Display values (0..1) that differ by more on the two sides of an edge, on average over its
  // ends, are a visible jump.
  double visible_jump = 0.05;
  // Only edges sharper than this become seams, degrees, and those of smooth surfaces on which
  // something stands at an angle above this. On smooth surfaces, light that is constant per
  // triangle jumps at every edge.
  double crease_degrees = 20;
  // The length of a texel, scene units. Faces thinner than kThinTexels of them are not cut off:
  // gutters would take more texels than they save. What is within a texel of an edge stands on it.
  double texel = 0;
};

struct LightSeams {
  std::vector<std::uint8_t> edges;  // as MeshView::seams; empty if there are none
  double length = 0;                // scene units
};

// Finds the creases of the sampler's scene at which the light jumps visibly, and the edges of
// smooth surfaces at which it does so below something that stands there. The edges that vertices
// hang on, closed by triangles without area, become seams together, if on a quarter of their length
// the light of the vertex differs visibly from that of the edge at its place. Takes linear time,
// except for a sort of the edges where vertices at one place have different light, and for a search
// of what stands on them. Returns nothing useful once cancelled.
LightSeams find_light_seams(const LuminanceSampler& sampler, const ToneMapping& tone,
                            const LightSeamOptions& options, const Context& context);

}  // namespace atlas
