#include "libatlas/scene/vrml/vrml_shape.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <utility>

#include "libatlas/core/bounds.h"
#include "libatlas/core/glm_bridge.h"
#include "libatlas/scene/building/scene_builder.h"

namespace atlas {

void add_default_uvs(VrmlShape& shape) {
  Bounds<glm::dvec3> box;
  for (const std::int32_t i : shape.corners)
    if (i >= 0 && std::size_t(i) < shape.points.size() && usable_position(shape.points[i]))
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
  std::vector<Vec3f> of_points(shape.points.size(), kNone);
  if (shape.colour_corners.empty()) {
    std::copy_n(shape.colours.begin(), std::min(shape.colours.size(), of_points.size()),
                of_points.begin());
    shape.colours = std::move(of_points);
    return;
  }
  const auto inside = [](std::int32_t i, std::size_t count) {
    return i >= 0 && std::size_t(i) < count;
  };
  const std::size_t points = shape.points.size();
  const std::size_t corners = std::min(shape.corners.size(), shape.colour_corners.size());
  // Points may be divided below, but keep their texture coordinates.
  if (!shape.uvs.empty() && shape.uv_corners.empty()) shape.uv_corners = shape.corners;
  std::map<std::pair<std::int32_t, std::array<float, 3>>, std::int32_t> copies;
  for (std::size_t k = 0; k < corners; ++k) {
    const std::int32_t point = shape.corners[k], number = shape.colour_corners[k];
    if (!inside(point, points) || !inside(number, shape.colours.size())) continue;
    const Vec3f c = shape.colours[number];
    Vec3f& first = of_points[point];
    if (std::isnan(c.x + c.y + c.z)) continue;  // it would never be equal to itself
    if (std::isnan(first.x)) first = c;
    if (first.x == c.x && first.y == c.y && first.z == c.z) continue;
    const auto next = static_cast<std::int32_t>(shape.points.size());
    const auto [at, is_new] = copies.try_emplace({point, {c.x, c.y, c.z}}, next);
    if (is_new) {
      shape.points.push_back(Vec3d(shape.points[point]));
      of_points.push_back(c);
    }
    shape.corners[k] = at->second;
  }
  shape.colours = std::move(of_points);
}

}  // namespace atlas
