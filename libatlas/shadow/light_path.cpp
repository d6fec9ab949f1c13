#include "libatlas/shadow/light_path.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <limits>
#include <numbers>

#include "libatlas/core/glm_bridge.h"
#include "libatlas/core/is_enumerator.h"
#include "libatlas/shadow/blend.h"

namespace atlas {
namespace {

constexpr double kDegree = std::numbers::pi / 180;
constexpr double kHour = 15 * kDegree;  // the earth turns 15 degrees an hour

// Uses hypot, since the squares of very long and very short directions leave the range of doubles.
glm::dvec3 unit_direction(const Vec3d& v) {
  return to_glm(v) / std::hypot(v.x, v.y, v.z);
}

bool usable(const Vec3d& v) {
  const double length = std::hypot(v.x, v.y, v.z);
  return length > 0 && std::isfinite(length);
}

// Great-circle interpolation between the unit vectors a and b, which are less than pi apart. It
// uses the part of b that is perpendicular to a. This part is computed from the difference of a and
// b, or from their sum if the angle is above a right angle. Near 0 and near pi that vector is small
// but keeps its direction, where the usual formula would divide by a sine that has lost its digits.
glm::dvec3 slerp(const glm::dvec3& a, const glm::dvec3& b, double t) {
  const double angle = angle_between(from_glm(a), from_glm(b));
  if (angle < kSlerpMinSine) return glm::normalize(glm::mix(a, b, t));
  const glm::dvec3 near = glm::dot(a, b) < 0 ? a + b : b - a;
  const glm::dvec3 square = glm::normalize(near - a * glm::dot(a, near));
  return std::cos(t * angle) * a + std::sin(t * angle) * square;
}

Status check_directions(const LightPathOptions& options) {
  const std::size_t count = options.directions.size();
  const bool pair = options.kind == PathKind::line || options.kind == PathKind::arc;
  const std::size_t least = options.kind == PathKind::fixed ? 1 : 2;
  if (count < least || (least == 1 && count > 1) || (pair && count > 2))
    return {ErrorCode::bad_option,
            fmt::format("light path: {} directions given (fixed takes 1, line and arc 2, keys 2 or "
                        "more)",
                        count)};
  for (std::size_t i = 0; i < count; ++i) {
    if (!usable(options.directions[i]))
      return {ErrorCode::bad_option,
              fmt::format("light path: direction {} is zero or not finite (give x,y,z)", i + 1)};
    if (i > 0 &&
        angle_between(options.directions[i - 1], options.directions[i]) > std::numbers::pi - 1e-6)
      return {ErrorCode::bad_option,
              fmt::format("light path: directions {} and {} are opposite, no single arc joins them "
                          "(add one between)",
                          i, i + 1)};
  }
  return {};
}

Status check_sun(const SunOptions& sun) {
  if (sun.day_of_year < 1 || sun.day_of_year > 366 || !(std::abs(sun.latitude) <= 90) ||
      !(sun.start_hour >= 0 && sun.start_hour < 24))
    return {
        ErrorCode::bad_option,
        "light path: the sun needs a day in 1..366, a latitude in -90..90 and an hour in 0..24"};
  const double lean = usable(sun.up) && usable(sun.north) ? angle_between(sun.up, sun.north) : 0;
  if (std::sin(lean) < 1e-3)
    return {ErrorCode::bad_option, "light path: up and north must be two different directions"};
  return {};
}

}  // namespace

double sun_declination(int day_of_year) {
  return 23.45 * kDegree * std::sin(2 * std::numbers::pi * (284 + day_of_year) / 365);
}

Vec3d sun_direction(const SunOptions& options, double hour) {
  const double decl = sun_declination(options.day_of_year), lat = options.latitude * kDegree;
  const double angle = (hour - 12) * kHour;
  const glm::dvec3 up = unit_direction(options.up);
  const glm::dvec3 along = unit_direction(options.north);
  const glm::dvec3 north = glm::normalize(along - up * glm::dot(up, along));
  const glm::dvec3 east = glm::cross(north, up);
  const double e = -std::cos(decl) * std::sin(angle);
  const double n =
      std::cos(lat) * std::sin(decl) - std::sin(lat) * std::cos(decl) * std::cos(angle);
  const double u =
      std::sin(lat) * std::sin(decl) + std::cos(lat) * std::cos(decl) * std::cos(angle);
  return from_glm(glm::normalize(e * east + n * north + u * up));
}

Result<LightPath> LightPath::make(const LightPathOptions& options) {
  if (!is_enumerator(options.kind, PathKind::keys) || !is_enumerator(options.end, PathEnd::stop))
    return Status{ErrorCode::bad_option,
                  fmt::format("light path: kind {}, end {} (give a PathKind and a PathEnd)",
                              int(options.kind), int(options.end))};
  const bool is_sun = options.kind == PathKind::sun;
  if (Status s = is_sun ? check_sun(options.sun) : check_directions(options); !s.ok()) return s;
  LightPath path;
  path.options_ = options;
  if (is_sun) {
    const double decl = sun_declination(options.sun.day_of_year);
    const double cosine = -std::tan(options.sun.latitude * kDegree) * std::tan(decl);
    if (cosine >= 1)
      return Status{ErrorCode::bad_option,
                    fmt::format("light path: the sun does not rise on day {} at latitude {}",
                                options.sun.day_of_year, options.sun.latitude)};
    const double half = cosine <= -1 ? 12 : std::acos(cosine) / kHour;
    path.sunrise_ = 12 - half;
    path.sunset_ = 12 + half;
    path.degrees_per_hour_ = 15 * std::cos(decl);
    path.length_ = 2 * half * path.degrees_per_hour_;
    const double start = std::clamp(options.sun.start_hour, path.sunrise_, path.sunset_);
    path.offset_ = (start - path.sunrise_) * path.degrees_per_hour_;
    return path;
  }
  for (std::size_t i = 1; i < options.directions.size(); ++i) {
    const double a = angle_between(options.directions[i - 1], options.directions[i]);
    path.lengths_.push_back(a / kDegree);
    path.length_ += path.lengths_.back();
  }
  return path;
}

double LightPath::folded(double degrees) const {
  if (!(degrees > 0) || length_ <= 0) degrees = 0;
  if (!std::isfinite(degrees)) degrees = 0;
  degrees += offset_;
  switch (options_.end) {
    case PathEnd::stop:
      return std::min(degrees, length_);
    case PathEnd::back: {
      const double there = std::fmod(degrees, 2 * length_);
      return length_ > 0 ? std::min(there, 2 * length_ - there) : 0;
    }
    case PathEnd::loop:
      // The end point itself belongs to the path. Otherwise a path that ends after a whole number
      // of steps would never be seen at its end.
      return degrees <= length_ ? degrees : std::fmod(degrees, length_);
  }
  return 0;
}

double LightPath::hour(double degrees) const {
  if (options_.kind != PathKind::sun) return std::numeric_limits<double>::quiet_NaN();
  return sunrise_ + folded(degrees) / degrees_per_hour_;
}

Vec3d LightPath::direction(double degrees) const {
  if (options_.kind == PathKind::sun) return sun_direction(options_.sun, hour(degrees));
  if (length_ <= 0) return from_glm(unit_direction(options_.directions[0]));
  double left = folded(degrees);
  std::size_t i = 0;
  while (i + 1 < lengths_.size() && left > lengths_[i]) left -= lengths_[i++];
  const double t = lengths_[i] > 0 ? std::min(left / lengths_[i], 1.0) : 0.0;
  if (options_.kind == PathKind::line)
    return from_glm(unit_direction(
        from_glm(glm::mix(to_glm(options_.directions[0]), to_glm(options_.directions[1]), t))));
  return from_glm(
      slerp(unit_direction(options_.directions[i]), unit_direction(options_.directions[i + 1]), t));
}

}  // namespace atlas
