// Internal: the light that scenes bring along.
#pragma once

#include "libatlas/core/image.h"
#include "libatlas/core/vec.h"
#include "libatlas/view/view_scene.h"

namespace atlas {

// Returns the light of a lightmap's page there, interpolated between texels, and beyond its edges
// that of the edge, as it is drawn.
Vec3f light_on_page(const ImageF& page, const Vec2f& uv);

// Returns ViewScene::light_scale: 1 / the white of the lightmap, and where it names none, 1 / the
// 99th percentile of the light at the vertices, which is that of the lightmap where a vertex lies
// on it. Returns 1 if the scene brings no light.
double light_scale_of(const ViewScene& view);

}  // namespace atlas
