// Internal: a picture of a scene's light in false colours.
#pragma once

#include "libatlas/charts/charts.h"
#include "libatlas/core/image.h"
#include "libatlas/exporters/world.h"
#include "libatlas/scene/scene.h"
#include "libatlas/unwrap/page_layout.h"

namespace atlas {

// Draws the scene from above, cut kPlanCutMetres above its lowest point, its pages below, and the
// colours' values beside it. Values are the luma of the light at the vertices (Rec. 709), without
// reflectance, in its unit; each colour stands for a range from one value of the series 1, 2, 5 to
// the next. Surfaces without light are grey. Precondition: the scene is lit.
Image8 draw_false_colours(const Scene& scene, Up up, const ChartSet& charts,
                          const PageLayout& layout);

inline constexpr double kPlanCutMetres = 1;

}  // namespace atlas
