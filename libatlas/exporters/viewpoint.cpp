#include "libatlas/exporters/viewpoint.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <vector>

#include "libatlas/core/glm_bridge.h"
#include "libatlas/exporters/viewing/view_grid.h"

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
// Rooms have level floors: the least share of the scene's floor plan that enclosed places on one
// level must take; kCrawlPlan is for places where nobody can stand. Hollows of single objects, such
// as the folds of a statue, have up to 0.08, a gazebo has 0.14. Where nobody can stand, a truck has
// 0.12, and a small model of a house 0.4.
constexpr double kLeastPlan = 0.1, kCrawlPlan = 0.2;
// Of a view: the light (display values, 0..1) from which on more does not count, and the factor on
// the score of one that shows none.
constexpr double kBright = 0.25, kBlack = 0.05;
// A place shows at least so many times the light of another one before it is taken although it is
// worse otherwise.
constexpr double kMuchLighter = 2;
// The cosine of the angle from the middle of a view within which its light counts.
constexpr double kWithinView = 0.6;
// The distance from walls that people keep who are 0.25 m wide (visitor.h), but at most a share of
// the view; and the factor on the score at a wall.
constexpr double kClearMetres = 0.5, kClearShare = 0.15, kAtWall = 0.7;
constexpr std::size_t kMaxNearby = 300;  // places tried around the best one

struct Eye {
  glm::dvec3 position{0};
  int floor = 0;      // cell of the floor below
  bool tall = false;  // a person can stand there
};

// Returns possible positions of the eye: in each column of cells, one above each floor that has at
// least two cells of height to the next filled one.
std::vector<Eye> eyes_of_columns(const ViewGrid& grid, double metres_per_unit) {
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
        // The floor is half a cell below that, more or less.
        const double height =
            air >= headroom ? std::max(eye - grid.cell() / 2, grid.cell()) : 0.55 * air;
        glm::dvec3 p = grid.centre(x, y, floor);
        p.z += grid.cell() / 2 + std::min(height, 0.8 * air);
        eyes.push_back({p, floor, air >= headroom});
      }
    }
  }
  return eyes;
}

// Counts places by their floors. Floors at z and z + 1 are one, since a level floor between two
// layers of cells may lie in both.
class FloorCounts {
 public:
  explicit FloorCounts(const ViewGrid& grid) : counts_(std::size_t(grid.size(2)) + 1, 0) {}
  void add(const Eye& eye) {
    ++counts_[std::size_t(eye.floor)];
    if (eye.floor > 0) ++counts_[std::size_t(eye.floor) - 1];
  }
  // Returns the lower z of the floor with most places.
  int common() const {
    return int(std::max_element(counts_.begin(), counts_.end()) - counts_.begin());
  }
  std::size_t most() const { return counts_[std::size_t(common())]; }

 private:
  std::vector<std::size_t> counts_;
};

struct Places {
  std::vector<Eye> eyes;
  bool main_floor = false;  // they are standing()
};

// Returns the positions where people can stand, on the floor that most such columns share, so that
// nobody starts on a table or under a seat.
Places standing(const ViewGrid& grid, const std::vector<Eye>& eyes) {
  FloorCounts floors(grid);
  for (const Eye& eye : eyes)
    if (eye.tall) floors.add(eye);
  const int common = floors.common();
  Places result{{}, true};
  for (const Eye& eye : eyes) {
    if (eye.tall && (eye.floor == common || eye.floor == common + 1)) result.eyes.push_back(eye);
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
  double light = 1;  // of the view, in 0..1: kBright and more is 1, and so is a scene without light
  bool enclosed = false;
  bool roomy = false;
  bool closed = false;  // people can stand there, tightly enclosed
  glm::dvec3 direction{1, 0, 0};
};

glm::dvec3 heading(int i) {
  const double angle = 2 * std::numbers::pi * i / kHeadings;
  return {std::cos(angle), std::sin(angle), 0};
}

class Judge {
 public:
  Judge(const ViewGrid& grid, double metres_per_unit)
      : grid_(grid), clear_(kClearMetres / metres_per_unit), around_(sphere(48)) {}

  // Scores a position. The best ones see front faces all around, and have air on every side and a
  // long view of something lit.
  Judged judge(const Eye& candidate) {
    Judged result;
    const double enclosed = look_around(candidate);
    if (enclosed < least_enclosed(candidate)) return result;
    result.enclosed = true;
    result.closed = candidate.tall && enclosed >= kTightlyEnclosed;
    double nearest = INFINITY, mean = 0;
    for (int i = 0; i < kHeadings; ++i) {
      level_[i] = grid_.cast(candidate.position, headings_[i]);
      nearest = std::min(nearest, level_[i].distance);
      mean += level_[i].distance / kHeadings;
    }
    // A pocket between parts of an object is not a room.
    result.roomy = mean >= kRoomy * grid_.level_diagonal();
    if (nearest < 1.5 * grid_.cell() || !(result.roomy || result.closed)) return result;
    const double view = best_view(result);
    // A long view counts more than the middle of the room: people stand near a wall to see it all.
    // But they keep clear of it.
    const double clear = std::min(clear_, kClearShare * view);
    const double kept = kAtWall + (1 - kAtWall) * std::min(1.0, nearest / clear);
    const double light = grid_.lit() ? kBlack + (1 - kBlack) * result.light : 1;
    result.score = enclosed * kept * light * (view + mean / 4 + std::min(nearest, 0.2 * view));
    return result;
  }

 private:
  static double least_enclosed(const Eye& candidate) {
    return candidate.tall ? kEnclosed : kTightlyEnclosed;
  }

  // Returns the share of all directions that meet a front face, or less than needed once it is
  // less: most positions in a scene that is seen from outside are not enclosed, which a few rays
  // show.
  double look_around(const Eye& candidate) {
    double enclosed = 1;
    std::size_t open = 0;
    for (std::size_t i = 0; i < around_.size(); ++i) {
      const auto ray = grid_.cast(candidate.position, around_[i]);
      light_[i] = ray.light;
      if (ray.hit == ViewGrid::Hit::front) continue;
      enclosed = double(around_.size() - ++open) / double(around_.size());
      if (enclosed < least_enclosed(candidate)) break;
    }
    return enclosed;
  }

  // Returns the length of the best view, and sets its direction and light.
  double best_view(Judged& result) const {
    double length = 0, best = -1;
    for (int i = 0; i < kHeadings; ++i) {
      const int left = (i + kHeadings - 1) % kHeadings, right = (i + 1) % kHeadings;
      // The shorter of the two neighbouring directions counts for both, so that the view leads
      // down the middle of an aisle, not along its wall.
      const double view = (free(i) + std::min(free(left), free(right))) / 2;
      const double light = grid_.lit() ? light_of_view(i) : 1;
      const double worth = grid_.lit() ? view * (kBlack + light) : view;
      if (worth <= best) continue;
      best = worth;
      length = view;
      result.light = light;
      result.direction = headings_[i];
    }
    return length;
  }

  double free(int i) const {
    return level_[i].hit == ViewGrid::Hit::front ? level_[i].distance
                                                 : kBackFace * level_[i].distance;
  }

  // What is straight ahead counts twice as much as what is around it.
  double light_of_view(int i) const {
    double ahead = 0, beside = 0;
    for (const int k : {i, (i + 1) % kHeadings, (i + kHeadings - 1) % kHeadings})
      ahead += level_[k].light / 3;
    int rays = 0;
    for (std::size_t k = 0; k < around_.size(); ++k) {
      if (glm::dot(around_[k], headings_[i]) < kWithinView) continue;
      beside += light_[k];
      ++rays;
    }
    return std::min(1.0, (2 * ahead + beside / std::max(1, rays)) / 3 / kBright);
  }

  const ViewGrid& grid_;
  const double clear_;
  const std::vector<glm::dvec3> around_;
  std::vector<double> light_ = std::vector<double>(around_.size());  // one for each of around_
  std::array<glm::dvec3, kHeadings> headings_ = all_headings();
  std::array<ViewGrid::Ray, kHeadings> level_{};  // one for each heading

  static std::array<glm::dvec3, kHeadings> all_headings() {
    std::array<glm::dvec3, kHeadings> result;
    for (int i = 0; i < kHeadings; ++i) result[i] = heading(i);
    return result;
  }
};

struct Best : Judged {
  Eye eye = {};

  void take(const Judged& judged, const Eye& where) {
    if (judged.score <= score) return;
    static_cast<Judged&>(*this) = judged;
    eye = where;
  }
};

// Takes a better place around the best one, if only every `stride`th has been tried.
void look_nearby(const ViewGrid& grid, const std::vector<Eye>& eyes, Judge& judge, Best& best) {
  const double stride = double(eyes.size()) / double(kMaxCandidates);
  if (stride <= 1) return;
  const double reach = 1.5 * std::sqrt(stride) * grid.cell();
  std::vector<Eye> near;
  for (const Eye& eye : eyes) {
    const glm::dvec3 way = eye.position - best.eye.position;
    if (std::hypot(way.x, way.y) <= reach && std::abs(eye.floor - best.eye.floor) <= 1)
      near.push_back(eye);
  }
  const std::size_t tried = std::min(near.size(), kMaxNearby);
  const bool roomy = best.roomy;
  for (std::size_t i = 0; i < tried; ++i) {
    const Eye& eye = near[i * near.size() / tried];
    const Judged judged = judge.judge(eye);
    if (judged.roomy == roomy) best.take(judged, eye);
  }
}

// Returns the best of about kMaxCandidates positions, which are spread over all of them. If none
// is roomy, or those are dark, that is the best small room of a building that consists of such
// rooms. Returns none if the scene has neither many rooms nor a large floor among walls. Beside the
// main floor, such as on ledges and in holes, places where people can stand must be tightly
// enclosed to count as such a floor.
Best best_of(const ViewGrid& grid, const Places& places, Judge& judge, const Context& context) {
  const std::vector<Eye>& eyes = places.eyes;
  Best roomy, small;
  const std::size_t tried = std::min(eyes.size(), kMaxCandidates);
  std::size_t closed = 0;
  FloorCounts walked(grid), crawled(grid);
  for (std::size_t i = 0; i < tried && !context.cancelled(); ++i) {
    const Eye& eye = eyes[i * eyes.size() / tried];
    const Judged judged = judge.judge(eye);
    closed += judged.closed;
    if (!eye.tall && judged.enclosed) crawled.add(eye);
    if (eye.tall && (places.main_floor ? judged.enclosed : judged.closed)) walked.add(eye);
    (judged.roomy ? roomy : small).take(judged, eye);
  }
  if (double(closed) < kManyRooms * double(tried)) {
    const double plan = double(grid.size(0)) * grid.size(1) * double(tried) / double(eyes.size());
    if (double(walked.most()) < kLeastPlan * plan && double(crawled.most()) < kCrawlPlan * plan)
      return {};
    small = {};
  }
  const bool lighter = small.score > 0 && small.light > kMuchLighter * roomy.light;
  Best& best = roomy.score > 0 && !lighter ? roomy : small;
  if (best.score > 0) look_nearby(grid, eyes, judge, best);
  return best;
}

Viewpoint from_outside(const ViewGrid& grid) {
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
  const ViewGrid grid(positions, indices, options, context);
  const Places all{eyes_of_columns(grid, options.metres_per_unit)};
  Judge judge(grid, options.metres_per_unit);
  Best best = best_of(grid, standing(grid, all.eyes), judge, context);
  // Another floor may be lit.
  if (best.score == 0 || kMuchLighter * best.light < 1) {
    const Best other = best_of(grid, all, judge, context);
    if (best.score == 0 || other.light > kMuchLighter * best.light) best = other;
  }
  if (best.score == 0) return from_outside(grid);
  Viewpoint view;
  view.position = from_glm(grid.from_frame(best.eye.position));
  view.direction = from_glm(grid.from_frame(best.direction));
  view.fov = kFov;
  view.inside = true;
  return view;
}

}  // namespace atlas
