// Decides which key shadow maps exist at what time, which of them a frame samples, and which part
// of the next one a frame draws. This file knows no OpenGL: maps are numbered slots, and work is a
// fraction of a map's triangles.
//
// With a scripted light the key after the next is drawn ahead, a slice in each frame of the current
// interval. No frame therefore draws a whole map, and the keys are exact. Where the light turns
// back or round a corner of 30 degrees or more, a key is put in the nearest frame, and the
// intervals there are shorter. The directions of a light moved by hand are not known ahead. Its
// keys are the directions that it had when they were begun, so blended shadows follow it with a
// delay of one to two intervals. Nothing is predicted, so nothing overshoots.
#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include "libatlas/core/vec.h"
#include "libatlas/shadow/blend.h"

namespace atlas {

struct ScheduleOptions {
  int interval_frames = 8;      // k >= 1; 1 draws a map every frame
  double interval_degrees = 0;  // > 0: a key every so many degrees instead, or after max_frames
  int max_frames = 64;          // longest interval if interval_degrees is used, >= 1
  // Keys are at most this far apart, in (0, kMaxKeyDegrees], even if that leaves few frames between
  // them. With a fast light, or on a slow machine, a frame then draws a larger part of a map. The
  // alternative would be shadows interpolated over half the sky. If only the last map is sampled,
  // it is drawn anew as soon as the light is this far from it.
  double max_key_degrees = kMaxKeyDegrees;
  bool blend = true;         // a frame samples two keys; false: it samples the last one only
  bool sliced = true;        // each map is drawn over the interval; false: one frame draws it all
  double jump_degrees = 20;  // a light that moves further than this in one frame has jumped
};

// One part of the drawing of a map: the triangles [begin, end), as fractions of all triangles, for
// one direction of the light. If begin is 0, the map has to be cleared first. If end is 1, the map
// is complete after this part.
struct MapWork {
  int slot = 0;
  Vec3d direction = {};
  double begin = 0, end = 1;
};

struct FramePlan {
  std::vector<MapWork> work = {};  // to be done before the frame samples anything
  int from = 0, to = 0;            // slots to sample; equal if one map is enough
  Vec3d from_direction = {}, to_direction = {};
  double t = 0;            // position in time between the two keys, [0, 1); 0 for one map
  bool refreshed = false;  // maps were drawn at once: first frame, jump or invalidate()
};

class KeySchedule {
 public:
  static constexpr int kSlots = 3;
  // Gives the light's direction so many frames after the current one. It is called with 0 up to
  // 3 * max(interval_frames, max_frames) + 1. It is null for a light moved by hand.
  using Ahead = std::function<Vec3d(int frames)>;

  // Numbers of frames below 1 count as 1, and a max_key_degrees out of range as the largest.
  explicit KeySchedule(const ScheduleOptions& options);

  // Plans the next frame, in which the light is at `now` (a direction towards the light, of any
  // length > 0). Keys of a scripted light are at most max_key_degrees apart; a longer interval is
  // shortened. A light moved by hand that is further than max_key_degrees from its key has jumped.
  // A scripted light may deviate from its prediction: it has jumped if it stops or starts, or if
  // its distance from its key is more than one and a half times max_key_degrees.
  FramePlan next(const Vec3d& now, const Ahead& ahead);

  // Says that the maps no longer show the scene. The next frame draws the maps that it samples at
  // once.
  void invalidate() { valid_ = false; }

  // The number of maps begun since construction. It stays 1 for a static light, whatever the
  // options.
  std::int64_t passes() const { return passes_; }

 private:
  struct Key {
    int slot = 0;
    Vec3d direction;
  };
  void refresh(const Vec3d& now, const Ahead& ahead, FramePlan& plan);
  void begin_interval(const Vec3d& now, const Ahead& ahead);
  int frames_to_turn(int start, int most, const Ahead& ahead) const;
  int interval_from(int start, const Ahead& ahead) const;
  int straight_interval_from(int start, const Ahead& ahead) const;
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
