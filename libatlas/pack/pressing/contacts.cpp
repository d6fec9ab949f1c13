#include "libatlas/pack/pressing/contacts.h"

#include <algorithm>
#include <cmath>

namespace atlas::pack {
namespace {

double length(double x, double y) {
  return std::sqrt(x * x + y * y);
}

// Returns how far a point of the body may have moved by rotation alone.
double turned(const Body& body, const Pose& now, const Pose& then) {
  return body.radius * length(now.cosine - then.cosine, now.sine - then.sine);
}

double moved(const Body& body, const Pose& now, const Pose& then) {
  return length(now.at.x - then.at.x, now.at.y - then.at.y) + turned(body, now, then);
}

}  // namespace

Contacts::Contacts(std::span<const Body> bodies, const SqueezeOptions& options)
    : bodies_(bodies), options_(options), walls_(bodies.size()) {
  const auto n = static_cast<std::uint32_t>(bodies.size());
  pairs_.resize(std::size_t{n} * (n - 1) / 2);
  std::size_t k = 0;
  for (std::uint32_t i = 0; i < n; ++i)
    for (std::uint32_t j = i + 1; j < n; ++j, ++k) {
      pairs_[k].i = i;
      pairs_[k].j = j;
    }
}

void Contacts::set_page(const SqueezePage& page, std::span<const Pose> poses) {
  page_ = page;
  for (std::uint32_t i = 0; i < bodies_.size(); ++i) look_at_wall(i, poses[i]);
}

void Contacts::update(std::span<const Pose> poses) {
  double farthest = 0;
  for (std::uint32_t i = 0; i < bodies_.size(); ++i) {
    walls_[i].moved = moved(bodies_[i], poses[i], walls_[i].seen);
    if (walls_[i].moved > kSkin) look_at_wall(i, poses[i]);
    if (!listed_.empty()) farthest = std::max(farthest, moved(bodies_[i], poses[i], listed_[i]));
  }
  if (listed_.empty() || 2 * farthest > kFarSkin) list_near_pairs(poses);
  for (const std::uint32_t k : near_) {
    Pair& pair = pairs_[k];
    const Pose &i = poses[pair.i], &j = poses[pair.j];
    const Pose &then_i = pair.seen_i, &then_j = pair.seen_j;
    pair.moved = length((i.at.x - j.at.x) - (then_i.at.x - then_j.at.x),
                        (i.at.y - j.at.y) - (then_i.at.y - then_j.at.y)) +
                 turned(bodies_[pair.i], i, then_i) + turned(bodies_[pair.j], j, then_j);
    if (!pair.known || pair.moved > kSkin) look_at(pair, poses);
  }
}

void Contacts::list_near_pairs(std::span<const Pose> poses) {
  near_.clear();
  listed_.assign(poses.begin(), poses.end());
  for (std::uint32_t k = 0; k < pairs_.size(); ++k) {
    Pair& pair = pairs_[k];
    const Vec2d a = poses[pair.i].at, b = poses[pair.j].at;
    const double reach =
        bodies_[pair.i].radius + bodies_[pair.j].radius + kSkin + options_.clearance + kFarSkin;
    if (length(a.x - b.x, a.y - b.y) < reach)
      near_.push_back(k);
    else
      pair.known = false;
  }
}

void Contacts::look_at_wall(std::uint32_t i, const Pose& pose) {
  Wall& wall = walls_[i];
  wall.points.clear();
  wall.seen = pose;
  wall.moved = 0;
  const double m = options_.margin + kSkin, r = bodies_[i].radius;
  if (pose.at.x - r > m && pose.at.y - r > m && pose.at.x + r < page_.width - m &&
      pose.at.y + r < page_.height - m)
    return;
  for (const Vec2d& local : bodies_[i].outline) {
    const Vec2d p = pose.to_page(local);
    const double room = std::min({p.x, p.y, page_.width - p.x, page_.height - p.y});
    if (room < m) wall.points.push_back({local, room - options_.margin});
  }
}

void Contacts::look_at(Pair& pair, std::span<const Pose> poses) const {
  pair.of_i.clear();
  pair.of_j.clear();
  pair.seen_i = poses[pair.i];
  pair.seen_j = poses[pair.j];
  pair.moved = 0;
  pair.known = true;
  const Vec2d a = pair.seen_i.at, b = pair.seen_j.at;
  const double reach = bodies_[pair.i].radius + bodies_[pair.j].radius + kSkin + options_.clearance;
  if (length(a.x - b.x, a.y - b.y) >= reach) return;
  find_points(pair.i, pair.j, poses, pair.of_i);
  find_points(pair.j, pair.i, poses, pair.of_j);
}

void Contacts::find_points(std::uint32_t i, std::uint32_t j, std::span<const Pose> poses,
                           std::vector<Contact>& found) const {
  // Between its samples the field is at most as steep as sqrt(2).
  constexpr double kSteepest = 1.5;
  const double skin = kSkin + options_.clearance;
  DistanceField::Sample s;
  const Body &body = bodies_[i], &other = bodies_[j];
  // Maps i's coordinates to those of j's field.
  Pose to_field;
  to_field.cosine = poses[i].cosine * poses[j].cosine + poses[i].sine * poses[j].sine;
  to_field.sine = poses[i].sine * poses[j].cosine - poses[i].cosine * poses[j].sine;
  to_field.at = poses[j].to_body(poses[i].at);
  to_field.at = {to_field.at.x + other.center.x, to_field.at.y + other.center.y};
  for (std::size_t a = 0; a < body.arcs.size(); ++a) {
    const Body::Arc& arc = body.arcs[a];
    const Vec2d center = to_field.to_page(arc.center);
    if (!other.field.near_grid(center, arc.radius)) continue;
    if (other.field.sample(center, s) && s.distance > skin + kSteepest * arc.radius) continue;
    const std::size_t end = std::min(body.outline.size(), (a + 1) * Body::kArc);
    for (std::size_t k = a * Body::kArc; k < end; ++k)
      if (other.field.sample(to_field.to_page(body.outline[k]), s) && s.distance < skin)
        found.push_back({body.outline[k], s.distance - options_.clearance});
  }
}

}  // namespace atlas::pack
