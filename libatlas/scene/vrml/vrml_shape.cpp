#include "libatlas/scene/vrml/vrml_shape.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <limits>
#include <utility>

#include "libatlas/core/bounds.h"
#include "libatlas/core/glm_bridge.h"
#include "libatlas/scene/building/coloured_points.h"
#include "libatlas/scene/building/scene_builder.h"

namespace atlas {
namespace {

bool inside(std::int32_t i, std::size_t count) {
  return i >= 0 && std::size_t(i) < count;
}

// Gives each corner the index of its face's colour, which is the next of colour_corners if there
// are any, else the next colour.
void give_corners_face_colours(VrmlShape& shape) {
  std::vector<std::int32_t> of_corners;
  of_corners.reserve(shape.corners.size());
  const auto& of_faces = shape.colour_corners;
  std::size_t face = 0, corners = 0;
  for (const std::int32_t corner : shape.corners) {
    const std::int32_t own = of_faces.empty()         ? static_cast<std::int32_t>(face)
                             : face < of_faces.size() ? of_faces[face]
                                                      : -1;
    of_corners.push_back(own);
    face += corner == -1 && corners > 0;
    corners = corner == -1 ? 0 : corners + 1;
  }
  shape.colour_corners = std::move(of_corners);
}

}  // namespace

void add_default_uvs(VrmlShape& shape) {
  Bounds<glm::dvec3> box;
  for (const std::int32_t i : shape.corners)
    if (inside(i, shape.points.size()) && usable_position(shape.points[i]))
      box.add(to_glm(shape.points[i]));
  const glm::dvec3 size = box.size();
  std::array<int, 3> axes{0, 1, 2};
  std::stable_sort(axes.begin(), axes.end(), [&](int a, int b) { return size[a] > size[b]; });
  const double longest = size[axes[0]];
  if (!(longest > 0)) return;
  for (const Vec3d& point : shape.points) {
    const glm::dvec3 from_low = (to_glm(point) - box.low) / longest;
    shape.uvs.push_back({float(from_low[axes[0]]), float(from_low[axes[1]])});
  }
  shape.uv_corners.clear();
}

void give_points_colours(VrmlShape& shape) {
  constexpr Vec3f kNone{std::numeric_limits<float>::quiet_NaN(), 0, 0};
  if (!shape.colour_per_vertex) give_corners_face_colours(shape);
  if (shape.colour_corners.empty()) {
    shape.colours.resize(shape.points.size(), kNone);
    return;
  }
  const std::size_t points = shape.points.size();
  const std::size_t corners = std::min(shape.corners.size(), shape.colour_corners.size());
  // Points may be divided below, but keep their texture coordinates.
  if (!shape.uvs.empty() && shape.uv_corners.empty()) shape.uv_corners = shape.corners;
  ColouredPoints coloured(points);
  for (std::size_t k = 0; k < corners; ++k) {
    const std::int32_t point = shape.corners[k], number = shape.colour_corners[k];
    if (!inside(point, points)) continue;
    const Vec3f colour = inside(number, shape.colours.size()) ? shape.colours[number] : kNone;
    shape.corners[k] =
        static_cast<std::int32_t>(coloured.coloured(static_cast<std::uint32_t>(point), {colour}));
  }
  for (std::size_t v = points; v < coloured.original().size(); ++v)
    shape.points.push_back(Vec3d(shape.points[coloured.original()[v]]));
  shape.colours.clear();
  for (const auto& colour : coloured.colours())
    shape.colours.push_back(colour ? colour->light : kNone);
}

}  // namespace atlas
