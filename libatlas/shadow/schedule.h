// Which key shadow maps exist when, which of them a frame samples, and which part of the next one
// it draws. Knows no OpenGL: maps are numbered slots, work is a fraction of a map's triangles.
//
// With a scripted light the key after the next is drawn ahead, a slice in each frame of the current
// interval, so that no frame draws a whole map and the keys are exact. A light moved by hand cannot
// be known ahead: its keys are the directions that it had when they were begun, so blended shadows
// follow it with a delay of one to two intervals (nothing is predicted, nothing overshoots).
#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include "libatlas/core/vec.h"
#include "libatlas/shadow/blend.h"

namespace atlas {

struct ScheduleOptions {
  int interval_frames = 8;      // k >= 1; 1 draws a map every frame
  double interval_degrees = 0;  // > 0: keys every so many degrees instead, at most max_frames apart
  int max_frames = 64;          // longest interval when keys go by degrees, >= 1
  // Keys are at most this far apart, (0, kMaxKeyDegrees], however few frames that leaves between
  // them: a fast light, or a slow machine, then costs more of a map a frame instead of shadows
  // interpolated over half the sky.
  double max_key_degrees = kMaxKeyDegrees;
  bool blend = true;         // two keys a frame; false: the last one is held
  bool sliced = true;        // spread each map over the interval; false: one frame draws it all
  double jump_degrees = 20;  // a light that moves more than this in one frame has jumped
};

// One share of drawing a map: triangles [begin, end) as fractions of the whole, all for one
// direction. begin == 0 means: clear the map first; end == 1: the map is complete after this.
struct MapWork {
  int slot = 0;
  Vec3d direction;
  double begin = 0, end = 1;
};

struct FramePlan {
  std::vector<MapWork> work;  // to be done before the frame samples anything
  int from = 0, to = 0;       // slots to sample; equal when one map serves
  Vec3d from_direction, to_direction;
  double t = 0;            // [0, 1): time between the two keys
  bool refreshed = false;  // a first frame, a jump or invalidate(): maps were drawn at once
};

class KeySchedule {
 public:
  static constexpr int kSlots = 3;
  // The light's direction so many frames after the current one; called with 0 up to
  // 2 * max(interval_frames, max_frames). Null for a light moved by hand.
  using Ahead = std::function<Vec3d(int frames)>;

  explicit KeySchedule(const ScheduleOptions& options);

  // Plans the next frame, in which the light is at `now` (towards the light, any length > 0).
  // Keys of a scripted light are at most max_key_degrees apart: a longer interval is cut short. One
  // moved by hand that runs so far ahead of its keys has jumped. A script may change its mind: a
  // light that comes to rest or leaves it has jumped, and so has one that runs half as far again
  // from its keys as they may be apart.
  FramePlan next(const Vec3d& now, const Ahead& ahead);

  // The maps no longer show the scene: the next frame draws what it samples at once.
  void invalidate() { valid_ = false; }

  // Whole maps begun since construction. A static light makes it 1, whatever the options.
  std::int64_t passes() const { return passes_; }

 private:
  struct Key {
    int slot = 0;
    Vec3d direction;
  };
  void refresh(const Vec3d& now, const Ahead& ahead, FramePlan& plan);
  void begin_interval(const Vec3d& now, const Ahead& ahead);
  int interval_from(int start, const Ahead& ahead) const;
  bool left_keys(const Vec3d& now, const Ahead& ahead) const;
  int free_slot() const;
  void draw_whole(int slot, const Vec3d& direction, FramePlan& plan);
  FramePlan next_unblended(const Vec3d& now);

  ScheduleOptions options_;
  Key from_, to_, coming_;
  bool valid_ = false, coming_needs_work_ = false;
  int frame_ = 0;  // within the interval
  int length_ = 1, next_length_ = 1;
  std::int64_t passes_ = 0;
  Vec3d last_;
};

}  // namespace atlas
