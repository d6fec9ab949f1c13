#include "libatlas/exporters/viewing/view_grid.h"

#include <algorithm>
#include <cmath>
#include <tuple>

namespace atlas {
namespace {

// Fine enough for rooms and doors. Scenes of at most kMostCells cells of that size get them.
constexpr double kCellMetres = 0.25;
constexpr double kMostCells = 1e6;
constexpr double kMostAlong = 1024;  // of the longest side, which bounds the samples of a sliver
// Nor are cells so fine that the surface has more squares of their size than this: each of them
// takes about two samples.
constexpr double kMostSquares = 1e6;
// What lies across itself again and again, as noise does, gets cells coarser than asked for.
constexpr double kMostSquaresOfNoise = 8e6;
constexpr double kSampleDistance = 0.7;  // cells
constexpr int kLeastRows = 8;            // of samples, unless the triangle is shorter, see mark()
// A cell whose triangles face both ways has a front on either side. Their normals cancel, up to
// this share of their area.
constexpr double kBothWays = 0.1;

}  // namespace

ViewGrid::ViewGrid(std::span<const Vec3f> positions, std::span<const std::uint32_t> indices,
                   const ViewpointOptions& options, const Context& context)
    : up_(options.up), lit_(!options.light.empty()) {
  const auto corners = [&](std::size_t t) {
    const auto at = [&](int k) { return to_frame(to_dvec(positions[indices[t + k]])); };
    return Corners{at(0), at(1), at(2)};
  };
  double area = 0;
  for (std::size_t t = 0; t + 2 < indices.size(); t += 3) {
    const auto [a, b, c] = corners(t);
    for (const glm::dvec3& p : {a, b, c}) box_.add(p);
    area += glm::length(glm::cross(b - a, c - a)) / 2;
  }
  const glm::dvec3 size = box_.size();
  const double coarsest =
      std::max(std::max({size.x, size.y, size.z}) / std::clamp(options.cells, 8, 512),
               std::sqrt(area / kMostSquaresOfNoise));
  choose_cells(coarsest,
               std::max(kCellMetres / options.metres_per_unit, std::sqrt(area / kMostSquares)));
  wall_of_.assign(std::size_t(n_[0]) * n_[1] * n_[2], kEmpty);
  walls_.resize(1);
  if (lit_) shown_.resize(1);
  for (std::size_t t = 0; t + 2 < indices.size() && !(t % 65536 == 0 && context.cancelled());
       t += 3) {
    mark(corners(t), lit_ ? float(options.light[t / 3]) / 255 : 0.0f);
  }
}

double ViewGrid::level_diagonal() const {
  return std::hypot(box_.size().x, box_.size().y);
}

// Makes the cells as fine as `finest` if there are not too many then, but not coarser than
// `coarsest`.
void ViewGrid::choose_cells(double coarsest, double finest) {
  const glm::dvec3 size = box_.size();
  const auto along = [&](int axis) { return std::max(1.0, std::ceil(size[axis] / cell_)); };
  if (!(coarsest > 0)) coarsest = finest = 1;
  const double longest = std::max({size.x, size.y, size.z});
  cell_ = std::min(std::max(finest, longest / kMostAlong), coarsest);
  while (cell_ < coarsest && along(0) * along(1) * along(2) > kMostCells)
    cell_ = std::min(1.05 * cell_, coarsest);
  for (int a = 0; a < 3; ++a) n_[a] = int(along(a));
}

// Samples the triangle in rows along its longest side, so that slivers take few samples.
void ViewGrid::mark(const Corners& triangle, float light) {
  auto [a, b, c] = triangle;  // c becomes the corner opposite the longest side
  if (glm::distance(b, c) > glm::distance(a, b)) std::tie(a, b, c) = std::tuple(b, c, a);
  if (glm::distance(b, c) > glm::distance(a, b)) std::tie(a, b, c) = std::tuple(b, c, a);
  if (glm::distance(c, a) > glm::distance(a, b)) std::tie(a, b, c) = std::tuple(c, a, b);
  const glm::dvec3 normal = glm::cross(b - a, c - a);
  const double longest = glm::distance(a, b), distance = kSampleDistance * cell_;
  const auto steps = [&](double length) { return std::max(1, int(std::ceil(length / distance))); };
  const int along = steps(longest);
  const int rows =
      std::max(longest > 0 ? steps(glm::length(normal) / longest) : 1, std::min(along, kLeastRows));
  const auto samples_of_row = [&](int row) {
    return 1 + int((std::int64_t(along) * (rows - row) + rows - 1) / rows);
  };
  int samples = 0;
  for (int row = 0; row <= rows; ++row) samples += samples_of_row(row);
  const glm::vec3 share = glm::vec3(normal / (cell_ * cell_) / double(samples));
  for (int row = 0; row <= rows; ++row) {
    const double up = double(row) / rows;
    const glm::dvec3 left = a + (c - a) * up, right = b + (c - b) * up;
    const int n = samples_of_row(row);
    for (int i = 0; i < n; ++i)
      mark(left + (right - left) * (double(i) / std::max(1, n - 1)), share, light);
  }
}

void ViewGrid::mark(const glm::dvec3& p, const glm::vec3& normal, float light) {
  int k[3];
  for (int axis = 0; axis < 3; ++axis)
    k[axis] = std::clamp(int((p[axis] - box_.low[axis]) / cell_), 0, n_[axis] - 1);
  std::uint32_t& wall = wall_of_[index(k[0], k[1], k[2])];
  if (wall == kEmpty) {
    wall = std::uint32_t(walls_.size());
    walls_.emplace_back();
    if (lit_) shown_.emplace_back();
  }
  walls_[wall].area += glm::length(normal);
  for (int axis = 0; axis < 3; ++axis) {
    const int side = normal[axis] < 0;
    walls_[wall].normals[axis][side] += std::abs(normal[axis]);
    if (lit_) shown_[wall][axis][side] += light * std::abs(normal[axis]);
  }
}

ViewGrid::Ray ViewGrid::cast(const glm::dvec3& from, const glm::dvec3& direction) const {
  Ray ray;
  const double step = cell_ / 2;
  const glm::dvec3 start = (from - box_.low) / cell_, forward = direction / cell_;
  for (ray.distance = step;; ray.distance += step) {
    const glm::dvec3 at = start + forward * ray.distance;
    int c[3];
    for (int a = 0; a < 3; ++a) {
      if (!(at[a] >= 0 && at[a] < n_[a])) return ray;
      c[a] = int(at[a]);
    }
    const std::uint32_t wall = wall_of_[index(c[0], c[1], c[2])];
    if (wall == kEmpty) continue;
    double towards = 0;
    for (int a = 0; a < 3; ++a) {
      const auto& normals = walls_[wall].normals[a];
      towards += (double(normals[0]) - double(normals[1])) * direction[a];
    }
    ray.hit = towards <= kBothWays * double(walls_[wall].area) ? Hit::front : Hit::back;
    if (lit_) ray.light = light_of(wall, direction, ray.hit);
    return ray;
  }
}

// Returns the mean light of what faces the ray. The back of a surface shows what its front does.
double ViewGrid::light_of(std::uint32_t wall, const glm::dvec3& direction, Hit hit) const {
  double light = 0, area = 0;
  for (int axis = 0; axis < 3; ++axis) {
    for (int side = 0; side < 2; ++side) {
      const bool faces = (direction[axis] < 0) == (side == 0);
      if (faces != (hit == Hit::front)) continue;
      const double weight = std::abs(direction[axis]);
      light += weight * double(shown_[wall][axis][side]);
      area += weight * double(walls_[wall].normals[axis][side]);
    }
  }
  return area > 0 ? std::min(1.0, light / area) : 0;
}

}  // namespace atlas
