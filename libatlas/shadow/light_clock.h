// How far a light has travelled along its path in a window, where frames last as long as they like.
#pragma once

namespace atlas {

struct LightClockOptions {
  // A light moves at most so far from one frame to the next, degrees, > 0 and finite: where frames
  // are slow it slows down too, instead of leaping past what shadows between keys can follow.
  double max_step = 2;
};

class LightClock {
 public:
  explicit LightClock(const LightClockOptions& options = {});

  // The next frame, `seconds` after the last one, of a light with this speed (what is
  // negative, infinite or NaN counts as 0; a light of speed 0 rests).
  void advance(double seconds, double degrees_per_second);

  // Degrees travelled so far; and what they will be so many frames later if these last as long as
  // the last ones did in the mean (times jitter, and a key a little early is exact for its place).
  double travelled() const { return travelled_; }
  double ahead(int frames) const { return travelled_ + frames * step_ahead_; }
  // The last step was cut to max_step.
  bool slowed() const { return slowed_; }

 private:
  LightClockOptions options_;
  double travelled_ = 0, step_ahead_ = 0;
  double mean_seconds_ = 0;  // of the last frames; 0 before the first
  bool slowed_ = false;
};

}  // namespace atlas
