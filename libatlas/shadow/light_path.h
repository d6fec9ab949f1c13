// Where a moving directional light is. Paths are measured in degrees travelled on the sphere, so
// that a speed in degrees a second means the same on each of them. On a line this holds in the mean
// only: the light moves evenly along the line, and the line's far parts are small on the sphere.
// Directions point towards the light.
#pragma once

#include <string>
#include <vector>

#include "libatlas/core/status.h"
#include "libatlas/core/vec.h"

namespace atlas {

enum class PathKind {
  fixed,  // does not move
  line,   // the light moves along the straight segment between the tips of the first two directions
  arc,    // the light moves along the great circle between the first two directions
  sun,    // the light follows the sun over one day
  keys,   // the light moves along great circles through all directions in turn
};

// What happens at the end of a path: the light starts again (it jumps), goes back, or stays.
enum class PathEnd { loop, back, stop };

struct SunOptions {
  int day_of_year = 172;    // 1 to 366
  double latitude = 50.45;  // degrees, north positive, [-90, 90]
  double start_hour = 9;    // local solar time, [0, 24): 12 is noon
  Vec3d up{0, 1, 0};        // the scene's vertical
  Vec3d north{0, 0, -1};    // any direction not parallel to up; made horizontal
};

struct LightPathOptions {
  PathKind kind = PathKind::sun;
  PathEnd end = PathEnd::loop;
  std::vector<Vec3d> directions = {};  // fixed: 1; line, arc: 2; keys: 2 or more; sun: none
  SunOptions sun = {};
};

// Returns the declination of the sun on a day, in radians, by Cooper's formula (Solar Energy 12,
// 1969), which is accurate to about half a degree.
double sun_declination(int day_of_year);

// Returns the direction towards the sun at an hour of local solar time (east = north x up).
Vec3d sun_direction(const SunOptions& options, double hour);

class LightPath {
 public:
  LightPath() : options_{PathKind::fixed, PathEnd::loop, {{0, 1, 0}}, {}} {}  // rests at +y
  // Error: bad_option with the reason. Reasons are a wrong number of directions, a direction that
  // is zero or not finite, two consecutive directions that are opposite (no unique arc joins them,
  // and a line would pass through the origin), a day, latitude or hour out of range, an up parallel
  // to north, and a sun that never rises on that day.
  static Result<LightPath> make(const LightPathOptions& options);

  // Returns the unit direction after so many degrees of travel from the start. Values that are
  // negative or not finite count as 0. On the sun's path, travel has the sun's own angular speed.
  // It starts at start_hour, or at sunrise or sunset if the sun is down then. The path lasts until
  // sunset. If it loops, it continues from sunrise.
  Vec3d direction(double degrees) const;

  // The length of the whole path in degrees (the sun's is from sunrise to sunset); 0 if the light
  // does not move.
  double length() const { return length_; }
  // The local solar time in hours after so many degrees of travel; NaN if this is not the sun's
  // path.
  double hour(double degrees) const;

 private:
  double folded(double degrees) const;

  LightPathOptions options_;
  std::vector<double> lengths_;  // degrees of each segment
  double length_ = 0;
  double sunrise_ = 0, sunset_ = 24, offset_ = 0, degrees_per_hour_ = 15;
};

// Reads "fixed:x,y,z", "line:x,y,z;x,y,z", "arc:x,y,z;x,y,z", "keys:...;...;..." or
// "sun:DAY,LATITUDE,HOUR" into `options`. Fields that the text does not name keep their values.
Result<LightPathOptions> parse_light_path(const std::string& text, LightPathOptions options);

}  // namespace atlas
