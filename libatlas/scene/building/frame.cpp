#include "libatlas/scene/building/frame.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <limits>

#include "libatlas/core/bounds.h"
#include "libatlas/core/drop_rounding.h"
#include "libatlas/core/glm_bridge.h"

namespace atlas {
namespace {

// Limit on the distance from 0, in box diagonals. Farther away, floats would lose to the offset
// those digits that decide ties: at distances of 2 to 8 diagonals, a third of the cases measured on
// three meshes gave other charts.
constexpr double kFarDiagonals = 1;
constexpr double kOriginStep = 0.25;  // relative to the power of two above the diagonal
constexpr double kMoved = 1e-3;       // typical edges by which rounding may move a vertex

using Box = Bounds<glm::dvec3>;

double diagonal_of(const Box& box) {
  double diagonal = 0;
  for (int i = 0; i < 3; ++i) diagonal = std::hypot(diagonal, box.size()[i]);
  return diagonal;
}

Box box_of_used(const FilePositions& file) {
  Box box;
  for (std::size_t i = 0; i < file.positions.size(); ++i) {
    if (file.used[i]) box.add(to_glm(file.positions[i]));
  }
  return box;
}

// Returns the point, rounded to multiples of a part of the power of two above `size`.
Vec3d round_point(const glm::dvec3& point, double size) {
  const double step = kOriginStep * std::exp2(std::ceil(std::log2(size)));
  return from_glm(glm::dvec3(std::round(point.x / step) * step, std::round(point.y / step) * step,
                             std::round(point.z / step) * step));
}

Vec3d origin_of_box(const Box& box) {
  const double diagonal = diagonal_of(box);
  glm::dvec3 centre;
  double distance = 0;
  for (int i = 0; i < 3; ++i) {
    centre[i] = box.low[i] + box.size()[i] / 2;
    distance = std::hypot(distance, centre[i]);
  }
  if (!(diagonal > 0) || distance <= kFarDiagonals * diagonal) return {};
  return round_point(centre, diagonal);
}

double median(std::vector<double>& values) {
  const auto middle = values.begin() + std::ptrdiff_t(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

// Returns the median of the longest edges of triangles, of up to 2^16 that are spread evenly over
// the file. Unlike a mean, it does not grow by a few edges that reach to a stray vertex.
double typical_edge(const FilePositions& file) {
  const std::size_t count = file.indices.size() / 3, step = count / 65536 + 1;
  std::vector<double> edges;
  for (std::size_t t = 0; t < count; t += step) {
    double longest = 0;
    for (std::size_t c = 0; c < 3; ++c) {
      const Vec3d& a = file.positions[file.indices[3 * t + c]];
      const Vec3d& b = file.positions[file.indices[3 * t + (c + 1) % 3]];
      longest = std::max(longest, std::hypot(a.x - b.x, a.y - b.y, a.z - b.z));
    }
    edges.push_back(longest);
  }
  return edges.empty() ? 0 : median(edges);
}

// Returns how far rounding moves a position along the axis where that is most.
double moved_by(const Vec3d& position, const Frame& frame) {
  const Vec3f stored = frame.stored(position);
  const Vec3d& origin = frame.origin;
  return std::max({std::abs(position.x - origin.x - stored.x),
                   std::abs(position.y - origin.y - stored.y),
                   std::abs(position.z - origin.z - stored.z)});
}

// Returns a bound on moved_by() for all positions in the box. It saves rounding them.
double most_moved(const Box& box, const Frame& frame) {
  double farthest = 0;
  for (int i = 0; i < 3; ++i) {
    const double origin = to_glm(frame.origin)[i];
    farthest = std::max({farthest, std::abs(box.low[i] - origin), std::abs(box.high[i] - origin)});
  }
  if (farthest > double(std::numeric_limits<float>::max()))
    return std::numeric_limits<double>::infinity();
  constexpr double kHalfUlp = 0x1p-24, kLeast = 0x1p-150;
  return std::max({kHalfUlp * farthest, kLeast, kRoundingDropped * frame.size});
}

std::vector<std::uint32_t> moved_positions(const FilePositions& file, const Frame& frame,
                                           double limit) {
  std::vector<std::uint32_t> moved;
  for (std::size_t i = 0; i < file.positions.size(); ++i) {
    if (file.used[i] && moved_by(file.positions[i], frame) > limit)
      moved.push_back(static_cast<std::uint32_t>(i));
  }
  return moved;
}

// Returns a frame around the median of the used positions, as large as their median distance from
// it, and at least as the edge.
Frame median_frame(const FilePositions& file, double edge) {
  glm::dvec3 centre;
  double spread = 0;
  std::vector<double> values;
  for (int axis = 0; axis < 3; ++axis) {
    values.clear();
    for (std::size_t i = 0; i < file.positions.size(); ++i) {
      if (file.used[i]) values.push_back(to_glm(file.positions[i])[axis]);
    }
    centre[axis] = median(values);
    for (double& value : values) value = std::abs(value - centre[axis]);
    spread = std::hypot(spread, median(values));
  }
  spread = std::max(spread, edge);
  return {round_point(centre, spread), spread};
}

}  // namespace

Vec3f Frame::stored(const Vec3d& position) const {
  return {drop_rounding(position.x - origin.x, size), drop_rounding(position.y - origin.y, size),
          drop_rounding(position.z - origin.z, size)};
}

double diagonal_of_used(const FilePositions& file) {
  return diagonal_of(box_of_used(file));
}

Frame choose_frame(const FilePositions& file) {
  const Box box = box_of_used(file);
  const Frame whole{origin_of_box(box), diagonal_of(box)};
  const double edge = typical_edge(file);
  if (!(edge > 0) || most_moved(box, whole) <= kMoved * edge) return whole;
  const std::size_t moved = moved_positions(file, whole, kMoved * edge).size();
  if (moved == 0) return whole;
  const Frame middle = median_frame(file, edge);
  return moved_positions(file, middle, kMoved * edge).size() < moved ? middle : whole;
}

RoundingLoss rounding_loss(const FilePositions& file, const Frame& frame) {
  RoundingLoss loss;
  const double edge = typical_edge(file), most = most_moved(box_of_used(file), frame);
  if (edge > 0 && most > kMoved * edge) loss.moved = moved_positions(file, frame, kMoved * edge);
  const auto closed = [&](std::uint32_t v, std::uint32_t w) {
    const Vec3d &a = file.positions[v], &b = file.positions[w];
    const double apart = std::max({std::abs(a.x - b.x), std::abs(a.y - b.y), std::abs(a.z - b.z)});
    constexpr double kBoth = 2.001;  // both move, and the difference is rounded
    return apart > 0 && apart <= kBoth * most && frame.stored(a) == frame.stored(b);
  };
  for (std::size_t t = 0; t < file.indices.size() / 3; ++t) {
    const std::uint32_t* v = &file.indices[3 * t];
    if (closed(v[0], v[1]) || closed(v[1], v[2]) || closed(v[2], v[0]))
      loss.closed.push_back(static_cast<std::uint32_t>(t));
  }
  return loss;
}

}  // namespace atlas
