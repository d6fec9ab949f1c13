#include "libatlas/shadow/light_clock.h"

#include <algorithm>

namespace atlas {
namespace {

// Weight of the newest frame in the mean: about the last twenty count.
constexpr double kNewest = 0.05;

}  // namespace

LightClock::LightClock(const LightClockOptions& options) : options_(options) {
  if (!(options_.max_step > 0)) options_.max_step = LightClockOptions{}.max_step;
}

void LightClock::advance(double seconds, double degrees_per_second) {
  const double duration = seconds > 0 ? seconds : 0;
  const double speed = degrees_per_second > 0 ? degrees_per_second : 0;
  mean_seconds_ = mean_seconds_ > 0 ? (1 - kNewest) * mean_seconds_ + kNewest * duration : duration;
  slowed_ = speed * duration > options_.max_step;
  travelled_ += std::min(speed * duration, options_.max_step);
  step_ahead_ = std::min(speed * mean_seconds_, options_.max_step);
}

}  // namespace atlas
