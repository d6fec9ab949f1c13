#include "libatlas/pack/squeeze.h"

#include <algorithm>
#include <cmath>

namespace atlas::pack {
namespace {

struct Pose {
  Vec2d at;
  double cosine = 1, sine = 0;

  Vec2d to_page(Vec2d d) const {
    return {at.x + cosine * d.x - sine * d.y, at.y + sine * d.x + cosine * d.y};
  }
  Vec2d to_body(Vec2d q) const {
    const double x = q.x - at.x, y = q.y - at.y;
    return {cosine * x + sine * y, cosine * y - sine * x};
  }
};

class Solver {
 public:
  Solver(std::span<Body> bodies, const SqueezeOptions& options)
      : bodies_(bodies), options_(options), poses_(bodies.size()) {
    for (std::size_t i = 0; i < bodies.size(); ++i) {
      poses_[i].at = bodies[i].at;
      turn(poses_[i], bodies[i].angle);
    }
  }

  // Takes overlaps out until none is deeper than the tolerance. Only points that were near another
  // chart when last looked at are followed from sweep to sweep, until charts have moved so far that
  // others may have come near (the neighbour lists of Verlet 1967).
  bool relax(const SqueezePage& page, std::uint32_t sweeps) {
    double before = 1e300;
    find_contacts(page);
    for (std::uint32_t s = 0; s < sweeps; ++s) {
      if (2 * farthest_move() > kSkin) find_contacts(page);
      const double deepest = sweep(page);
      ++sweeps_;
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
  std::uint64_t sweeps() const { return sweeps_; }
  void stretch(double x, double y) {
    for (Pose& p : poses_) {
      p.at.x *= x;
      p.at.y *= y;
    }
  }

 private:
  static void turn(Pose& pose, double by) {
    const double c = std::cos(by), s = std::sin(by);
    const double cosine = pose.cosine * c - pose.sine * s;
    pose.sine = pose.sine * c + pose.cosine * s;
    pose.cosine = cosine;
  }

  // A point of body i's outline near body j or, where j is kWall, near an edge of the page.
  struct Contact {
    std::uint32_t i, j;
    Vec2d point;
  };
  static constexpr std::uint32_t kWall = 0xffffffffu;

  // How far a point of any chart has moved since contacts were looked for.
  double farthest_move() const {
    double square = 0;
    for (std::size_t i = 0; i < poses_.size(); ++i) {
      const Pose &now = poses_[i], &then = seen_[i];
      const double turned =
          bodies_[i].radius * (std::abs(now.cosine - then.cosine) + std::abs(now.sine - then.sine));
      const double dx = std::abs(now.at.x - then.at.x) + turned;
      const double dy = std::abs(now.at.y - then.at.y) + turned;
      square = std::max(square, dx * dx + dy * dy);
    }
    return std::sqrt(square);
  }

  void find_contacts(const SqueezePage& page) {
    contacts_.clear();
    seen_ = poses_;
    const double skin = kSkin + options_.clearance;
    for (std::uint32_t i = 0; i < bodies_.size(); ++i) {
      const double m = options_.margin + kSkin, r = bodies_[i].radius;
      const Vec2d at = poses_[i].at;
      if (at.x - r > m && at.y - r > m && at.x + r < page.width - m && at.y + r < page.height - m)
        continue;
      for (const Vec2d& local : bodies_[i].outline) {
        const Vec2d p = poses_[i].to_page(local);
        if (p.x < m || p.y < m || p.x > page.width - m || p.y > page.height - m)
          contacts_.push_back({i, kWall, local});
      }
    }
    for (std::uint32_t i = 0; i < bodies_.size(); ++i)
      for (std::uint32_t j = i + 1; j < bodies_.size(); ++j) {
        const double dx = poses_[i].at.x - poses_[j].at.x, dy = poses_[i].at.y - poses_[j].at.y;
        const double reach = bodies_[i].radius + bodies_[j].radius + skin;
        if (dx * dx + dy * dy >= reach * reach) continue;
        near_points(i, j, skin);
        near_points(j, i, skin);
      }
  }

  void near_points(std::uint32_t i, std::uint32_t j, double skin) {
    DistanceField::Sample s;
    const Body &body = bodies_[i], &other = bodies_[j];
    const double reach = other.radius + skin;
    for (std::size_t a = 0; a < body.arcs.size(); ++a) {
      const Body::Arc& arc = body.arcs[a];
      const Vec2d m = poses_[j].to_body(poses_[i].to_page(arc.center));
      if (m.x * m.x + m.y * m.y > (reach + arc.radius) * (reach + arc.radius)) continue;
      if (!other.field.near_grid({m.x + other.center.x, m.y + other.center.y}, arc.radius))
        continue;
      const std::size_t end = std::min(body.outline.size(), (a + 1) * Body::kArc);
      for (std::size_t k = a * Body::kArc; k < end; ++k)
        if (sample(j, poses_[i].to_page(body.outline[k]), s) && s.distance < skin)
          contacts_.push_back({i, j, body.outline[k]});
    }
  }

  bool sample(std::uint32_t j, Vec2d p, DistanceField::Sample& s) const {
    const Vec2d q = poses_[j].to_body(p);
    return bodies_[j].field.sample({q.x + bodies_[j].center.x, q.y + bodies_[j].center.y}, s);
  }

  double sweep(const SqueezePage& page) {
    double deepest = 0;
    for (const Contact& c : contacts_) {
      const Vec2d p = poses_[c.i].to_page(c.point);
      deepest = std::max(deepest, c.j == kWall ? push_in(c.i, p, page) : push_out(c, p));
    }
    return deepest;
  }

  double push_out(const Contact& c, Vec2d p) {
    DistanceField::Sample s;
    if (!sample(c.j, p, s)) return 0;
    const double depth = options_.clearance - s.distance;
    const double length = std::sqrt(s.gradient.x * s.gradient.x + s.gradient.y * s.gradient.y);
    if (depth <= 0 || length < 1e-12) return 0;
    const Pose& pose = poses_[c.j];
    const double gx = s.gradient.x / length, gy = s.gradient.y / length;
    resolve(c, p, {pose.cosine * gx - pose.sine * gy, pose.sine * gx + pose.cosine * gy}, depth);
    return depth;
  }

  double push_in(std::uint32_t i, Vec2d p, const SqueezePage& page) {
    const double m = options_.margin;
    const double depth[4] = {m - p.x, p.x - (page.width - m), m - p.y, p.y - (page.height - m)};
    constexpr Vec2d normal[4] = {{1, 0}, {-1, 0}, {0, 1}, {0, -1}};
    double deepest = 0;
    for (int k = 0; k < 4; ++k) {
      if (depth[k] <= 0) continue;
      deepest = std::max(deepest, depth[k]);
      resolve({i, kWall, {}}, p, normal[k], depth[k]);
    }
    return deepest;
  }

  // Moves i along n at point p and j, if any, the other way, lighter ones more.
  void resolve(const Contact& contact, Vec2d p, Vec2d n, double depth) {
    const auto lever = [&](std::uint32_t b) {
      const Vec2d r{p.x - poses_[b].at.x, p.y - poses_[b].at.y};
      return r.x * n.y - r.y * n.x;
    };
    const std::uint32_t i = contact.i, j = contact.j;
    const double turning = options_.turn ? 1 : 0;
    const double wi = 1 / bodies_[i].area, li = lever(i);
    const double ai = turning * li / bodies_[i].gyration;
    double sum = wi * (1 + ai * li), wj = 0, aj = 0;
    if (j != kWall) {
      const double lj = lever(j);
      wj = 1 / bodies_[j].area;
      aj = turning * lj / bodies_[j].gyration;
      sum += wj * (1 + aj * lj);
    }
    constexpr double kRelaxation = 0.6;  // neighbouring points push as well
    const double step = kRelaxation * depth / sum;
    move(i, n, step * wi, ai);
    if (j != kWall) move(j, n, -step * wj, aj);
  }

  void move(std::uint32_t b, Vec2d n, double step, double lever) {
    Pose& pose = poses_[b];
    pose.at.x += n.x * step;
    pose.at.y += n.y * step;
    const double by = std::clamp(lever * step, -0.05, 0.05);
    if (by == 0) return;
    // To second order, and normalised: a sine each contact would cost more than all the rest.
    const double c = 1 - by * by / 2, s = by;
    const double cosine = pose.cosine * c - pose.sine * s;
    const double sine = pose.sine * c + pose.cosine * s;
    const double length = 1 / std::sqrt(cosine * cosine + sine * sine);
    pose.cosine = cosine * length;
    pose.sine = sine * length;
  }

  std::span<Body> bodies_;
  const SqueezeOptions& options_;
  std::vector<Pose> poses_, seen_;
  std::vector<Contact> contacts_;
  std::uint64_t sweeps_ = 0;
  static constexpr double kSkin = 16;
};

// Increases with the angle of p, from 0 to 4.
double angle_like(Vec2d p) {
  const double sum = std::abs(p.x) + std::abs(p.y);
  const double share = sum > 0 ? p.y / sum : 0;
  return p.x >= 0 ? 1 + share : 3 - share;
}

}  // namespace

void make_arcs(Body& body) {
  std::stable_sort(body.outline.begin(), body.outline.end(),
                   [](Vec2d a, Vec2d b) { return angle_like(a) < angle_like(b); });
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
                         std::hypot(high.x - low.x, high.y - low.y) / 2});
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
    body.radius = std::max(body.radius, std::hypot(p.x, p.y));
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
  // The start may overlap a little: more room then, as little as will do.
  for (int k = 0; !solver.relax(page, 100); ++k) {
    if (k == 10) return {};
    const double more = 1 + 0.5 * options.first_step;
    page = {page.width * more, page.height * more};
    solver.stretch(more, more);
  }
  std::vector<Pose> kept = solver.poses();
  // Both sides at once while that works, then one at a time, in ever smaller steps.
  double step = options.first_step;
  {
    int failed = 0;
    for (int turn = 0; solver.sweeps() < options.sweeps && step > options.last_step;) {
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
    bodies[i].angle = std::atan2(kept[i].sine, kept[i].cosine);
  }
  return page;
}

}  // namespace atlas::pack
