#include "libatlas/shadow/schedule.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>

#include "libatlas/core/degrees.h"
#include "libatlas/core/glm_bridge.h"
#include "libatlas/shadow/blend.h"

namespace atlas {
namespace {

// Two directions closer than this (radians) draw the same map. On a map of 4096 texels a side the
// difference is a hundredth of a texel.
constexpr double kSameAngle = 2e-6;

bool same(const Vec3d& a, const Vec3d& b) {
  return angle_between(a, b) < kSameAngle;
}

double degrees_between(const Vec3d& a, const Vec3d& b) {
  return degrees(angle_between(a, b));
}

// A light bends its way by at least so much where a key is put. Smaller bends, such as those of a
// curve that is given by many directions, leave the light close to the arc between its keys.
constexpr double kTurnDegrees = 30;

// Bends that differ by less than this are equal: those of a steady curve differ by rounding.
constexpr double kBendRounding = 1e-3;

// Returns the way from `here` to `there` on the sphere, as it begins: a tangent at `here`, about as
// long as the way.
glm::dvec3 tangent(const Vec3d& here, const Vec3d& there) {
  const glm::dvec3 a = to_glm(here) / std::hypot(here.x, here.y, here.z);
  const glm::dvec3 b = to_glm(there) / std::hypot(there.x, there.y, there.z);
  return (b - a) - a * glm::dot(a, b - a);
}

bool at_rest(const Vec3d& here, const Vec3d& there) {
  constexpr double kRest = 1e-9;  // shorter ways (radians) are mostly rounding
  return angle_between(here, there) < kRest;
}

// Returns by how many degrees the way of a light bends at `here`: none on a great circle, 180 where
// it turns back, stops or starts.
double bend(const Vec3d& before, const Vec3d& here, const Vec3d& after) {
  const bool rested = at_rest(before, here), rests = at_rest(here, after);
  if (rested || rests) return rested && rests ? 0 : 180;
  return degrees_between(from_glm(-tangent(here, before)), from_glm(tangent(here, after)));
}

}  // namespace

KeySchedule::KeySchedule(const ScheduleOptions& options) : options_(options) {
  options_.interval_frames = std::max(1, options_.interval_frames);
  options_.max_frames = std::max(1, options_.max_frames);
  if (!(options_.max_key_degrees > 0 && options_.max_key_degrees <= kMaxKeyDegrees))
    options_.max_key_degrees = kMaxKeyDegrees;
}

// Returns the number of frames from the key that is `start` frames ahead to the first place where
// the light turns, or most + 1 if it does not within `most` frames or jumps before.
int KeySchedule::frames_to_turn(int start, int most, const Ahead& ahead) const {
  Vec3d at = ahead(start), next = ahead(start + 1);
  double before = 0, here = start > 0 ? bend(ahead(start - 1), at, next) : 0;
  bool rested = false;
  for (int n = 0; n <= most; ++n) {
    if (degrees_between(at, next) > options_.jump_degrees) break;
    const Vec3d last = ahead(start + n + 2);
    const bool jumps = degrees_between(next, last) > options_.jump_degrees;
    const double after = jumps ? 0 : bend(at, next, last);
    // A turn between two frames bends the way in both of them; the sharper bend is nearer to it.
    const bool sharpest = here > before + kBendRounding && here >= after - kBendRounding;
    const bool turns = here > 90 || (sharpest && here + std::max(before, after) > kTurnDegrees);
    if (n > 1 && turns) return n;
    // A turn in the frame after a key is the one that this key is for, if frames have become
    // shorter since. But the light turns in both if it goes back to the start of a short path.
    if (n == 1 && here > 90 && before > 90 && !rested) return n;
    before = here;
    here = after;
    rested = at_rest(at, next);
    at = next;
    next = last;
  }
  return most + 1;
}

// Returns the number of frames from the key that is `start` frames ahead to the one after it. Where
// the light turns, keys on both sides would be nearer to each other than to the light, and blends
// would never show the turn. It therefore has a key of its own. If the turn is in the interval
// after this one, both are made equally long, so that no frame draws much more than others.
int KeySchedule::interval_from(int start, const Ahead& ahead) const {
  const int straight = straight_interval_from(start, ahead);
  if (!ahead) return straight;
  const int turn = frames_to_turn(start, 2 * straight - 1, ahead);
  if (turn <= straight) return turn;
  return turn < 2 * straight ? turn / 2 : straight;
}

// Returns the same for a light that does not turn.
int KeySchedule::straight_interval_from(int start, const Ahead& ahead) const {
  const bool by_degrees = options_.interval_degrees > 0;
  const int longest = by_degrees ? options_.max_frames : options_.interval_frames;
  if (!ahead) return options_.interval_frames;
  const double most = options_.max_key_degrees;
  const double limit = by_degrees ? std::min(options_.interval_degrees, most) : most;
  const Vec3d first = ahead(start);
  Vec3d previous = first;
  for (int n = 1; n <= longest; ++n) {
    const Vec3d d = ahead(start + n);
    const double moved = degrees_between(first, d);
    if (n > 1 &&
        (moved > most * (1 + 1e-9) || degrees_between(previous, d) > options_.jump_degrees))
      return n - 1;
    if (moved >= limit * (1 - 1e-9)) return n;
    previous = d;
  }
  return longest;
}

// Returns whether the light is at a place that the keys were not drawn for. If frames last longer
// or shorter than was predicted, the light is ahead of or behind its time between the keys, but not
// as far away as this.
bool KeySchedule::left_keys(const Vec3d& now, const Ahead& ahead) const {
  const double away = degrees_between(from_.direction, now);
  if (!ahead) return away > options_.max_key_degrees;
  if (away > 1.5 * options_.max_key_degrees) return true;
  const bool at_key = same(from_.direction, now);
  if (from_.slot == to_.slot) return !at_key && !coming_needs_work_;
  // A light at rest never reaches the next key, so blends must not go on to it. The test is exact
  // equality and not same(), because same() would also hold for a slow light.
  for (int n = 1; n <= length_; ++n)
    if (!(ahead(n) == now)) return false;
  return !at_key || !same(to_.direction, now);
}

int KeySchedule::free_slot() const {
  for (int slot = 0; slot < kSlots; ++slot)
    if (slot != from_.slot && slot != to_.slot) return slot;
  return 0;  // not reached: two keys cannot hold three slots
}

void KeySchedule::draw_whole(int slot, const Vec3d& direction, FramePlan& plan) {
  plan.work.push_back({slot, direction, 0, 1});
  ++passes_;
}

void KeySchedule::refresh(const Vec3d& now, const Ahead& ahead, FramePlan& plan) {
  plan.refreshed = true;
  from_ = to_ = {0, now};
  draw_whole(0, now, plan);
  length_ = interval_from(0, ahead);
  // A light that jumps in every frame gets one map a frame, as with the classic method, and not
  // two.
  if (!ahead || degrees_between(ahead(1), now) > options_.jump_degrees) return;
  const Vec3d end = ahead(length_);
  if (!same(end, now)) {
    to_ = {1, end};
    draw_whole(1, end, plan);
  }
}

// Chooses what to draw during this interval for the next one. from_ and to_ must be set.
void KeySchedule::begin_interval(const Vec3d& now, const Ahead& ahead) {
  frame_ = 0;
  coming_ = to_;
  coming_needs_work_ = false;
  next_length_ = interval_from(length_, ahead);
  // If the light jumps before the interval ends or in the frame after it, everything will be
  // refreshed. Nothing that was drawn now would be sampled, or only by frames before a jump that
  // comes late, where it would be wrong.
  for (int n = 0; ahead && n <= length_; ++n)
    if (degrees_between(ahead(n), ahead(n + 1)) > options_.jump_degrees) return;
  const Vec3d target = ahead ? ahead(length_ + next_length_) : now;
  coming_needs_work_ = !same(target, to_.direction);
  if (coming_needs_work_) coming_ = {free_slot(), target};
}

FramePlan KeySchedule::next_unblended(const Vec3d& now) {
  FramePlan plan;
  plan.refreshed = !valid_ || degrees_between(last_, now) > options_.jump_degrees;
  const bool by_degrees = options_.interval_degrees > 0;
  const bool late = ++frame_ >= (by_degrees ? options_.max_frames : options_.interval_frames);
  const double most = options_.max_key_degrees;
  const double limit = by_degrees ? std::min(options_.interval_degrees, most) : most;
  const bool far = degrees_between(from_.direction, now) >= limit * (1 - 1e-9);
  if (plan.refreshed || ((late || far) && !same(from_.direction, now))) {
    from_ = {0, now};
    draw_whole(0, now, plan);
    frame_ = 0;
  }
  valid_ = true;
  last_ = now;
  plan.from_direction = plan.to_direction = from_.direction;
  return plan;
}

FramePlan KeySchedule::next(const Vec3d& now, const Ahead& ahead) {
  if (!options_.blend) return next_unblended(now);
  FramePlan plan;
  const bool ends = frame_ + 1 >= length_;
  // A light that stops at a key needs no other, though it is not at the interval's first one.
  const bool arrives = ends && ahead && same(to_.direction, now);
  const bool jumped = valid_ && (degrees_between(last_, now) > options_.jump_degrees ||
                                 (!arrives && left_keys(now, ahead)));
  if (!valid_ || jumped) {
    refresh(now, ahead, plan);
    begin_interval(now, ahead);
    valid_ = true;
  } else if (++frame_; ends) {
    from_ = to_;
    to_ = coming_;
    length_ = next_length_;
    begin_interval(now, ahead);
  }
  last_ = now;
  if (coming_needs_work_) {
    const double n = length_;
    if (frame_ == 0) ++passes_;
    if (options_.sliced)
      plan.work.push_back({coming_.slot, coming_.direction, frame_ / n, (frame_ + 1) / n});
    else if (frame_ == 0)
      plan.work.push_back({coming_.slot, coming_.direction, 0, 1});
  }
  plan.from = from_.slot;
  plan.to = to_.slot;
  plan.from_direction = from_.direction;
  plan.to_direction = to_.direction;
  plan.t = plan.from == plan.to ? 0 : double(frame_) / length_;
  return plan;
}

}  // namespace atlas
