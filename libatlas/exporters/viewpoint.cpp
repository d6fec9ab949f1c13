#include "libatlas/exporters/viewpoint.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <vector>

#include "libatlas/core/bounds.h"
#include "libatlas/core/glm_bridge.h"

namespace atlas {
namespace {

constexpr double kEyeMetres = 1.6, kHeadroomMetres = 1.9;
constexpr double kFov = 1.0;                  // radians
constexpr std::size_t kMaxCandidates = 1500;  // places tried; each costs about seventy rays
constexpr int kHeadings = 24;                 // horizontal directions tried
// The least share of directions that must meet a front face; kTightlyEnclosed is for places where
// nobody can stand. A room without a ceiling has about 0.75; a pocket under an overhanging part of
// a single object has up to 0.6.
constexpr double kEnclosed = 0.68, kTightlyEnclosed = 0.85;  // the latter where nobody can stand
// The factor on the length of a view that ends at the back of a wall: thin shells confuse a coarse
// grid.
constexpr double kBackFace = 0.7;
constexpr double kRoomy = 0.1;  // least mean free horizontal distance, per floor diagonal
// In a building of many rooms none is that roomy. It is told from a part with a bore in it by the
// share of the places where people can stand that are tightly enclosed.
constexpr double kManyRooms = 0.5;
// A cell whose triangles face both ways has a front on either side. Their normals cancel, up to
// this share of their area.
constexpr double kBothWays = 0.1;

// The scene as voxels, in a frame whose third axis points up. Each cell holds the sum of the
// area-weighted normals of the triangles in it, which tells the front of a wall from its back, and
// the sum of these areas.
class Grid {
 public:
  Grid(std::span<const Vec3f> positions, std::span<const std::uint32_t> indices,
       const ViewpointOptions& options, const Context& context)
      : up_(options.up) {
    for (const std::uint32_t i : indices) box_.add(to_frame(to_dvec(positions[i])));
    const glm::dvec3 size = box_.size();
    cell_ = std::max({size.x, size.y, size.z}) / std::clamp(options.cells, 8, 512);
    if (!(cell_ > 0)) cell_ = 1;
    for (int a = 0; a < 3; ++a) n_[a] = std::max(1, int(std::ceil(size[a] / cell_)));
    normals_.assign(std::size_t(n_[0]) * n_[1] * n_[2], glm::vec3(0));
    filled_.assign(normals_.size(), 0);
    areas_.assign(normals_.size(), 0);
    for (std::size_t t = 0; t + 2 < indices.size() && !(t % 65536 == 0 && context.cancelled());
         t += 3) {
      mark(to_frame(to_dvec(positions[indices[t]])), to_frame(to_dvec(positions[indices[t + 1]])),
           to_frame(to_dvec(positions[indices[t + 2]])));
    }
  }

  glm::dvec3 to_frame(const glm::dvec3& p) const {
    return up_ == Up::z ? p : glm::dvec3(p.z, p.x, p.y);
  }
  glm::dvec3 from_frame(const glm::dvec3& p) const {
    return up_ == Up::z ? p : glm::dvec3(p.y, p.z, p.x);
  }

  int size(int axis) const { return n_[axis]; }
  double cell() const { return cell_; }
  const Bounds<glm::dvec3>& box() const { return box_; }
  double level_diagonal() const { return std::hypot(box_.size().x, box_.size().y); }
  bool filled(int x, int y, int z) const { return filled_[index(x, y, z)] != 0; }
  glm::dvec3 centre(int x, int y, int z) const {
    return box_.low + (glm::dvec3(x, y, z) + 0.5) * cell_;
  }

  enum class Hit { nothing, front, back };
  struct Ray {
    double distance = 0;  // to the first filled cell, or to the box's border
    Hit hit = Hit::nothing;
  };

  // Walks in steps of half a cell. A step may miss the corner of a cell, which does not matter
  // here.
  Ray cast(const glm::dvec3& from, const glm::dvec3& direction) const {
    Ray ray;
    const double step = cell_ / 2;
    for (ray.distance = step;; ray.distance += step) {
      const glm::dvec3 at = (from + direction * ray.distance - box_.low) / cell_;
      int c[3];
      for (int a = 0; a < 3; ++a) {
        if (!(at[a] >= 0 && at[a] < n_[a])) return ray;
        c[a] = int(at[a]);
      }
      const std::size_t i = index(c[0], c[1], c[2]);
      if (!filled_[i]) continue;
      const double towards = glm::dot(glm::dvec3(normals_[i]), direction);
      ray.hit = towards <= kBothWays * double(areas_[i]) ? Hit::front : Hit::back;
      return ray;
    }
  }

 private:
  std::size_t index(int x, int y, int z) const { return (std::size_t(z) * n_[1] + y) * n_[0] + x; }

  void mark(const glm::dvec3& a, const glm::dvec3& b, const glm::dvec3& c) {
    const glm::dvec3 normal = glm::cross(b - a, c - a);
    const double longest =
        std::max({glm::distance(a, b), glm::distance(b, c), glm::distance(c, a)});
    const int steps = std::clamp(int(std::ceil(longest / (0.7 * cell_))), 1, 2048);
    const int samples = (steps + 1) * (steps + 2) / 2;
    const glm::vec3 share = glm::vec3(normal / (cell_ * cell_) / double(samples));
    const float area = glm::length(share);
    for (int i = 0; i <= steps; ++i) {
      for (int j = 0; i + j <= steps; ++j) {
        const glm::dvec3 p = a + (b - a) * (double(i) / steps) + (c - a) * (double(j) / steps);
        int k[3];
        for (int axis = 0; axis < 3; ++axis) {
          k[axis] = std::clamp(int((p[axis] - box_.low[axis]) / cell_), 0, n_[axis] - 1);
        }
        const std::size_t at = index(k[0], k[1], k[2]);
        filled_[at] = 1;
        normals_[at] += share;
        areas_[at] += area;
      }
    }
  }

  Up up_;
  Bounds<glm::dvec3> box_;
  double cell_ = 1;
  std::array<int, 3> n_{};
  std::vector<glm::vec3> normals_;
  std::vector<float> areas_;
  std::vector<std::uint8_t> filled_;
};

struct Eye {
  glm::dvec3 position{0};
  int floor = 0;      // cell of the floor below
  bool tall = false;  // a person can stand there
};

// Returns possible positions of the eye: in each column of cells, one above each floor that has at
// least two cells of height to the next filled one.
std::vector<Eye> eyes_of_columns(const Grid& grid, double metres_per_unit) {
  const double eye = kEyeMetres / metres_per_unit, headroom = kHeadroomMetres / metres_per_unit;
  std::vector<Eye> eyes;
  for (int y = 0; y < grid.size(1); ++y) {
    for (int x = 0; x < grid.size(0); ++x) {
      for (int z = 0; z < grid.size(2); ++z) {
        if (!grid.filled(x, y, z)) continue;
        const int floor = z;
        while (z + 1 < grid.size(2) && !grid.filled(x, y, z + 1)) ++z;
        if (z - floor < 2) continue;
        const double air = (z - floor) * grid.cell();
        // From half a cell above the centre of the floor's cell, there is certainly air.
        const double height = air >= headroom ? std::max(eye, grid.cell()) : 0.55 * air;
        glm::dvec3 p = grid.centre(x, y, floor);
        p.z += grid.cell() / 2 + std::min(height, 0.8 * air);
        eyes.push_back({p, floor, air >= headroom});
      }
    }
  }
  return eyes;
}

// Returns the positions where people can stand, on the floor that most such columns share, so that
// nobody starts on a table or under a seat.
std::vector<Eye> standing(const Grid& grid, const std::vector<Eye>& eyes) {
  // For each z, the number of such positions with a floor at z or z + 1.
  std::vector<std::size_t> columns(grid.size(2) + 1, 0);
  for (const Eye& eye : eyes) {
    columns[eye.floor] += eye.tall;
    if (eye.floor > 0) columns[eye.floor - 1] += eye.tall;
  }
  const int common = int(std::max_element(columns.begin(), columns.end()) - columns.begin());
  std::vector<Eye> result;
  for (const Eye& eye : eyes) {
    if (eye.tall && (eye.floor == common || eye.floor == common + 1)) result.push_back(eye);
  }
  return result;
}

// Returns directions that are spread evenly over the sphere (a Fibonacci lattice).
std::vector<glm::dvec3> sphere(int count) {
  std::vector<glm::dvec3> result;
  for (int i = 0; i < count; ++i) {
    const double z = 1 - (2 * i + 1.0) / count, r = std::sqrt(1 - z * z);
    const double angle = std::numbers::pi * (3 - std::sqrt(5.0)) * i;
    result.emplace_back(r * std::cos(angle), r * std::sin(angle), z);
  }
  return result;
}

struct Judged {
  double score = 0;  // 0: unusable
  bool roomy = false;
  bool closed = false;  // people can stand there, tightly enclosed
  glm::dvec3 direction{1, 0, 0};
};

// Scores a position. The best ones see front faces all around, and have air on every side and a
// long view.
Judged judge(const Grid& grid, const Eye& candidate, const std::vector<glm::dvec3>& around) {
  const glm::dvec3& eye = candidate.position;
  Judged result;
  // Most positions in a scene that is seen from outside are not enclosed, which a few rays show.
  double enclosed = 1;
  std::size_t open = 0;
  for (const glm::dvec3& d : around) {
    if (grid.cast(eye, d).hit == Grid::Hit::front) continue;
    enclosed = double(around.size() - ++open) / double(around.size());
    if (enclosed < (candidate.tall ? kEnclosed : kTightlyEnclosed)) return result;
  }
  result.closed = candidate.tall && enclosed >= kTightlyEnclosed;
  std::array<double, kHeadings> free{};
  double nearest = INFINITY, mean = 0;
  for (int i = 0; i < kHeadings; ++i) {
    const double angle = 2 * std::numbers::pi * i / kHeadings;
    const auto ray = grid.cast(eye, {std::cos(angle), std::sin(angle), 0});
    free[i] = ray.hit == Grid::Hit::front ? ray.distance : kBackFace * ray.distance;
    nearest = std::min(nearest, ray.distance);
    mean += ray.distance / kHeadings;
  }
  // A pocket between parts of an object is not a room.
  result.roomy = mean >= kRoomy * grid.level_diagonal();
  if (nearest < 1.5 * grid.cell() || !(result.roomy || result.closed)) return result;
  double best = -1;
  for (int i = 0; i < kHeadings; ++i) {
    // The shorter of the two neighbouring directions counts for both, so that the view leads down
    // the middle of an aisle, not along its wall.
    const double side = std::min(free[(i + kHeadings - 1) % kHeadings], free[(i + 1) % kHeadings]);
    const double view = 2 * free[i] + 2 * side;
    if (view <= best) continue;
    best = view;
    const double angle = 2 * std::numbers::pi * i / kHeadings;
    result.direction = {std::cos(angle), std::sin(angle), 0};
  }
  // A long view counts more than the middle of the room: people stand near a wall to see it all.
  result.score = enclosed * (best / 4 + mean / 4 + std::min(nearest, 0.05 * best));
  return result;
}

struct Best : Judged {
  glm::dvec3 eye{0};
};

// Returns the best of at most kMaxCandidates positions, which are spread over all of them. If none
// is roomy, that is the best small room of a building that consists of such rooms.
Best best_of(const Grid& grid, const std::vector<Eye>& eyes, const Context& context) {
  const std::vector<glm::dvec3> around = sphere(48);
  Best roomy, small;
  const std::size_t tried = std::min(eyes.size(), kMaxCandidates);
  std::size_t closed = 0;
  for (std::size_t i = 0; i < tried && !context.cancelled(); ++i) {
    const Eye& eye = eyes[i * eyes.size() / tried];
    const Judged judged = judge(grid, eye, around);
    closed += judged.closed;
    Best& best = judged.roomy ? roomy : small;
    if (judged.score <= best.score) continue;
    static_cast<Judged&>(best) = judged;
    best.eye = eye.position;
  }
  if (roomy.score > 0) return roomy;
  return double(closed) >= kManyRooms * double(tried) ? small : Best{};
}

Viewpoint from_outside(const Grid& grid) {
  const glm::dvec3 centre = (grid.box().low + grid.box().high) / 2.0;
  const double radius = std::max(glm::distance(grid.box().low, grid.box().high) / 2, 1e-30);
  const glm::dvec3 towards = glm::normalize(glm::dvec3(0.75, 0.55, 0.4));  // shows three sides
  const glm::dvec3 eye = centre + towards * (radius / std::sin(kFov / 2));
  Viewpoint view;
  const glm::dvec3 position = grid.from_frame(eye), direction = grid.from_frame(-towards);
  view.position = from_glm(position);
  view.direction = from_glm(direction);
  view.fov = kFov;
  return view;
}

}  // namespace

Viewpoint choose_viewpoint(std::span<const Vec3f> positions, std::span<const std::uint32_t> indices,
                           const ViewpointOptions& options, const Context& context) {
  if (indices.empty()) return {};
  const Grid grid(positions, indices, options, context);
  const std::vector<Eye> eyes = eyes_of_columns(grid, options.metres_per_unit);
  Best best = best_of(grid, standing(grid, eyes), context);
  if (best.score == 0) best = best_of(grid, eyes, context);
  if (best.score == 0) return from_outside(grid);
  Viewpoint view;
  view.position = from_glm(grid.from_frame(best.eye));
  view.direction = from_glm(grid.from_frame(best.direction));
  view.fov = kFov;
  view.inside = true;
  return view;
}

}  // namespace atlas
