// How far a light has travelled along its path in a window, where the duration of frames varies.
#pragma once

namespace atlas {

struct LightClockOptions {
  // The largest movement of a light from one frame to the next, in degrees, > 0 and finite. If
  // frames are slow, the light slows down too. Otherwise it would move further than shadows between
  // keys can follow.
  double max_step = 2;
};

class LightClock {
 public:
  explicit LightClock(const LightClockOptions& options = {});

  // Begins the next frame, `seconds` after the last one, for a light with this speed. Arguments
  // that are negative, infinite or NaN count as 0. A light of speed 0 rests.
  void advance(double seconds, double degrees_per_second);

  // travelled() gives the degrees travelled so far. ahead() gives what they will be after so many
  // more frames, if these last as long as the mean of the last frames. Since frame times vary, a
  // key may come a little early or late, but it is exact for its own direction.
  double travelled() const { return travelled_; }
  double ahead(int frames) const { return travelled_ + frames * step_ahead_; }
  // Whether the last step was shortened to max_step.
  bool slowed() const { return slowed_; }

 private:
  LightClockOptions options_;
  double travelled_ = 0, step_ahead_ = 0;
  double mean_seconds_ = 0;  // of the last frames; 0 before the first
  bool slowed_ = false;
};

}  // namespace atlas
