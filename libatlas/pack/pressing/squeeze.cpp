#include "libatlas/pack/pressing/squeeze.h"

#include <algorithm>
#include <cmath>

#include "libatlas/core/clock.h"
#include "libatlas/core/portable_math.h"
#include "libatlas/core/sort_total.h"
#include "libatlas/pack/pressing/contacts.h"

namespace atlas::pack {
namespace {

class Solver {
 public:
  Solver(std::span<Body> bodies, const SqueezeOptions& options)
      : bodies_(bodies), options_(options), poses_(bodies.size()), contacts_(bodies, options) {
    for (std::size_t i = 0; i < bodies.size(); ++i) {
      poses_[i].at = bodies[i].at;
      turn(poses_[i], bodies[i].angle);
    }
  }

  // Removes overlaps until none is deeper than the tolerance. Returns false if this fails.
  bool relax(const SqueezePage& page, std::uint32_t sweeps) {
    double before = 1e300;
    contacts_.set_page(page, poses_);
    for (std::uint32_t s = 0; s < sweeps; ++s) {
      contacts_.update(poses_);
      const double deepest = sweep(page);
      if (deepest <= options_.tolerance) return true;
      if (s % 16 == 15) {
        if (deepest > 0.98 * before) return false;
        before = deepest;
      }
    }
    return false;
  }

  const std::vector<Pose>& poses() const { return poses_; }
  void set_poses(const std::vector<Pose>& poses) { poses_ = poses; }
  double work() const { return work_; }  // in words
  void stretch(double x, double y) {
    for (Pose& p : poses_) {
      p.at.x *= x;
      p.at.y *= y;
    }
  }

 private:
  static void turn(Pose& pose, double by) {
    const double c = portable::cos(by), s = portable::sin(by);
    const double cosine = pose.cosine * c - pose.sine * s;
    pose.sine = pose.sine * c + pose.cosine * s;
    pose.cosine = cosine;
  }

  static constexpr std::uint32_t kWall = 0xffffffffu;

  bool sample(std::uint32_t j, Vec2d p, DistanceField::Sample& s) const {
    const Vec2d q = poses_[j].to_body(p);
    return bodies_[j].field.sample({q.x + bodies_[j].center.x, q.y + bodies_[j].center.y}, s);
  }

  double sweep(const SqueezePage& page) {
    double deepest = 0;
    for (std::uint32_t i = 0; i < bodies_.size(); ++i) {
      const Contacts::Wall& wall = contacts_.walls()[i];
      work_ += double(wall.points.size());
      for (const Contacts::Contact& c : wall.points)
        if (wall.moved >= c.room)
          deepest = std::max(deepest, push_in(i, poses_[i].to_page(c.point), page));
    }
    for (std::size_t k = 0; k < contacts_.near_count(); ++k) {
      const Contacts::Pair& pair = contacts_.near(k);
      work_ += double(pair.of_i.size() + pair.of_j.size());
      for (const Contacts::Contact& c : pair.of_i)
        if (pair.moved >= c.room) deepest = std::max(deepest, push_out(pair.i, pair.j, c.point));
      for (const Contacts::Contact& c : pair.of_j)
        if (pair.moved >= c.room) deepest = std::max(deepest, push_out(pair.j, pair.i, c.point));
    }
    return deepest;
  }

  // Pushes point `local` of i out of j. Returns how deep it was.
  double push_out(std::uint32_t i, std::uint32_t j, Vec2d local) {
    work_ += kWordsAContact;
    DistanceField::Sample s;
    const Vec2d p = poses_[i].to_page(local);
    if (!sample(j, p, s)) return 0;
    const double depth = options_.clearance - s.distance;
    if (depth <= 0) return 0;
    const double length = std::sqrt(s.gradient.x * s.gradient.x + s.gradient.y * s.gradient.y);
    if (length < 1e-12) return 0;
    const Pose& pose = poses_[j];
    const double gx = s.gradient.x / length, gy = s.gradient.y / length;
    const Vec2d n{pose.cosine * gx - pose.sine * gy, pose.sine * gx + pose.cosine * gy};
    resolve(i, j, {p, n, depth});
    return depth;
  }

  double push_in(std::uint32_t i, Vec2d p, const SqueezePage& page) {
    const double m = options_.margin;
    if (p.x >= m && p.x <= page.width - m && p.y >= m && p.y <= page.height - m) return 0;
    const double depth[4] = {m - p.x, p.x - (page.width - m), m - p.y, p.y - (page.height - m)};
    constexpr Vec2d normal[4] = {{1, 0}, {-1, 0}, {0, 1}, {0, -1}};
    double deepest = 0;
    for (int k = 0; k < 4; ++k) {
      if (depth[k] <= 0) continue;
      deepest = std::max(deepest, depth[k]);
      resolve(i, kWall, {p, normal[k], depth[k]});
    }
    return deepest;
  }

  // The point at which one body lies in another, the direction in which it must move out, and the
  // depth.
  struct Overlap {
    Vec2d point, normal;
    double depth;
  };

  // Moves i along the normal, and j in the opposite direction unless it is kWall. Lighter bodies
  // move more.
  void resolve(std::uint32_t i, std::uint32_t j, const Overlap& overlap) {
    work_ += kWordsAPush;
    const Vec2d n = overlap.normal;
    const auto lever = [&](std::uint32_t b) {
      const Vec2d r{overlap.point.x - poses_[b].at.x, overlap.point.y - poses_[b].at.y};
      return r.x * n.y - r.y * n.x;
    };
    const double wi = 1 / bodies_[i].area, li = lever(i);
    const double ai = li / bodies_[i].gyration;
    double sum = wi * (1 + ai * li), wj = 0, aj = 0;
    if (j != kWall) {
      const double lj = lever(j);
      wj = 1 / bodies_[j].area;
      aj = lj / bodies_[j].gyration;
      sum += wj * (1 + aj * lj);
    }
    constexpr double kRelaxation = 0.6;  // because neighbouring points push as well
    // A body that lies deep in another is pushed both ways. Resolving the whole depth at once would
    // throw it and its neighbours across the page.
    const double step = kRelaxation * std::min(overlap.depth, kMostPush) / sum;
    move(i, n, step * wi, ai);
    if (j != kWall) move(j, n, -step * wj, aj);
  }

  void move(std::uint32_t b, Vec2d n, double step, double lever) {
    Pose& pose = poses_[b];
    pose.at.x += n.x * step;
    pose.at.y += n.y * step;
    const double most = kMostPush / bodies_[b].radius;
    const double by = std::clamp(lever * step, -most, most);
    if (by == 0) return;
    // The rotation is computed to second order and normalised. A sine per contact would take more
    // time than all the rest.
    const double c = 1 - by * by / 2, s = by;
    const double cosine = pose.cosine * c - pose.sine * s;
    const double sine = pose.sine * c + pose.cosine * s;
    const double length = 1 / std::sqrt(cosine * cosine + sine * sine);
    pose.cosine = cosine * length;
    pose.sine = sine * length;
  }

  std::span<Body> bodies_;
  const SqueezeOptions& options_;
  std::vector<Pose> poses_;
  Contacts contacts_;
  double work_ = 0;
  static constexpr double kMostPush = 4;
  static constexpr double kWordsAContact = 5, kWordsAPush = 15;
};

// Orders points such that every kArc consecutive ones lie close together, by splitting the set
// across its longer side recursively.
void sort_into_arcs(std::span<Vec2d> points) {
  if (points.size() <= Body::kArc) return;
  Vec2d low = points[0], high = low;
  for (const Vec2d p : points) {
    low = {std::min(low.x, p.x), std::min(low.y, p.y)};
    high = {std::max(high.x, p.x), std::max(high.y, p.y)};
  }
  const bool wide = high.x - low.x > high.y - low.y;
  sort_total(points.begin(), points.end(), [wide](Vec2d a, Vec2d b) {
    const Vec2d c = wide ? a : Vec2d{a.y, a.x}, d = wide ? b : Vec2d{b.y, b.x};
    return c.x != d.x ? c.x < d.x : c.y < d.y;
  });
  const std::size_t arcs = (points.size() + Body::kArc - 1) / Body::kArc;
  const std::size_t half = arcs / 2 * Body::kArc;
  sort_into_arcs(points.first(half));
  sort_into_arcs(points.subspan(half));
}

}  // namespace

void make_arcs(Body& body) {
  sort_into_arcs(body.outline);
  body.arcs.clear();
  for (std::size_t k = 0; k < body.outline.size(); k += Body::kArc) {
    const std::size_t end = std::min(body.outline.size(), k + Body::kArc);
    Vec2d low = body.outline[k], high = low;
    for (std::size_t i = k; i < end; ++i) {
      const Vec2d p = body.outline[i];
      low = {std::min(low.x, p.x), std::min(low.y, p.y)};
      high = {std::max(high.x, p.x), std::max(high.y, p.y)};
    }
    body.arcs.push_back({{(low.x + high.x) / 2, (low.y + high.y) / 2},
                         portable::hypot(high.x - low.x, high.y - low.y) / 2});
  }
}

Body make_body(const Mask& mask, double cell, double reach, double spacing) {
  Body body;
  body.field = DistanceField(mask, cell, reach);
  double x = 0, y = 0, square = 0, cells = 0;
  for (std::int32_t r = 0; r < mask.height; ++r)
    for (const Run& run : mask.row(r)) {
      const double n = run.end - run.begin, mid = 0.5 * (run.begin + run.end);
      cells += n;
      x += n * mid;
      y += n * (r + 0.5);
      square += n * (mid * mid + n * n / 12 + (r + 0.5) * (r + 0.5));
    }
  x /= cells;
  y /= cells;
  body.center = {x * cell, y * cell};
  body.area = cells * cell * cell;
  body.gyration = std::max(square / cells - x * x - y * y, 0.1) * cell * cell;
  body.outline = body.field.outline(spacing);
  for (Vec2d& p : body.outline) {
    p = {p.x - body.center.x, p.y - body.center.y};
    body.radius = std::max(body.radius, portable::hypot(p.x, p.y));
  }
  make_arcs(body);
  return body;
}

SqueezePage squeeze(std::span<Body> bodies, SqueezePage page, const SqueezeOptions& options) {
  Solver solver(bodies, options);
  if (options.square) {
    const double side = std::max(page.width, page.height);
    solver.stretch(side / page.width, side / page.height);
    page = {side, side};
  }
  // The bodies may overlap a little at the start. Then the page is enlarged as little as necessary.
  constexpr double kMostRoom = 0.05;  // maximum enlargement of a side in one step
  for (double more = 0.5 * options.first_step; !solver.relax(page, 100); more *= 1.5) {
    if (more > kMostRoom || solver.work() > options.work) return {};
    page = {page.width * (1 + more), page.height * (1 + more)};
    solver.stretch(1 + more, 1 + more);
  }
  std::vector<Pose> kept = solver.poses();
  // Shrinks both sides at once while that works, then one side at a time, in ever smaller steps.
  double step = options.first_step;
  {
    int failed = 0;
    const auto over = [&] {
      return (options.context && options.context->cancelled()) ||
             wall_seconds() >= options.deadline;
    };
    for (int turn = 0; solver.work() < options.work && step > options.last_step && !over();) {
      const double fx = turn == 2 ? 1 : 1 - step, fy = turn == 1 ? 1 : 1 - step;
      const SqueezePage smaller{page.width * fx, page.height * fy};
      solver.stretch(fx, fy);
      if (solver.relax(smaller, 100)) {
        page = smaller;
        kept = solver.poses();
        failed = 0;
        continue;
      }
      solver.set_poses(kept);
      if (!options.square) turn = (turn + 1) % 3;
      if (++failed == (options.square ? 1 : 3)) {
        step /= 2;
        failed = 0;
      }
    }
  }
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    bodies[i].at = kept[i].at;
    bodies[i].angle = portable::atan2(kept[i].sine, kept[i].cosine);
  }
  return page;
}

}  // namespace atlas::pack
