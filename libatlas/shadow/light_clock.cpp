#include "libatlas/shadow/light_clock.h"

#include <algorithm>
#include <cmath>

namespace atlas {
namespace {

// Weight of the newest frame in the mean. About the last twenty frames count.
constexpr double kNewest = 0.05;

// Infinite values count as 0. An infinite time would stay in the mean for ever, and multiplied by
// the speed of a light at rest it would be NaN.
double positive_or_zero(double value) {
  return value > 0 && std::isfinite(value) ? value : 0;
}

}  // namespace

LightClock::LightClock(const LightClockOptions& options) : options_(options) {
  if (!(positive_or_zero(options_.max_step) > 0)) options_.max_step = LightClockOptions{}.max_step;
}

void LightClock::advance(double seconds, double degrees_per_second) {
  const double duration = positive_or_zero(seconds), speed = positive_or_zero(degrees_per_second);
  mean_seconds_ = mean_seconds_ > 0 ? (1 - kNewest) * mean_seconds_ + kNewest * duration : duration;
  slowed_ = speed * duration > options_.max_step;
  travelled_ += std::min(speed * duration, options_.max_step);
  step_ahead_ = std::min(speed * mean_seconds_, options_.max_step);
}

}  // namespace atlas
