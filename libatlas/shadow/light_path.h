// Where a moving directional light is: paths measured in degrees travelled on the sphere, so that a
// speed in degrees a second means the same on each of them (on a line in the mean only: it is even
// along the line, whose far parts are small on the sphere). Directions point towards the light.
#pragma once

#include <string>
#include <vector>

#include "libatlas/core/status.h"
#include "libatlas/core/vec.h"

namespace atlas {

enum class PathKind {
  fixed,  // does not move
  line,   // the light moves along the straight segment between the tips of the first two directions
  arc,    // the great circle between the first two directions
  sun,    // the sun over one day
  keys,   // great circles through all directions in turn
};

// What happens at the end of a path: start again (the light jumps), go back, or stay.
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
  std::vector<Vec3d> directions;  // fixed: 1; line, arc: 2; keys: 2 or more; sun: none
  SunOptions sun;
};

// Declination of the sun on a day, radians: Cooper's formula (Solar Energy 12, 1969), good to about
// half a degree.
double sun_declination(int day_of_year);

// Direction towards the sun at an hour of local solar time (east = north x up).
Vec3d sun_direction(const SunOptions& options, double hour);

class LightPath {
 public:
  LightPath() : options_{PathKind::fixed, PathEnd::loop, {{0, 1, 0}}, {}} {}  // rests at +y
  // bad_option with the reason: too few directions, a zero or non-finite one, two opposite ones
  // (no unique arc, and a line through the origin), a sun that never rises on that day.
  static Result<LightPath> make(const LightPathOptions& options);

  // Unit direction after so many degrees of travel from the start (negative and NaN count as 0).
  // On the sun's path travel runs at the sun's own angular speed and starts at start_hour, moved to
  // sunrise or sunset if the sun is down then; the path lasts until sunset and, looping, goes on
  // from sunrise.
  Vec3d direction(double degrees) const;

  // Length of the path from its start to its end, degrees; 0 if it does not move.
  double length() const { return length_; }
  // Local solar time at a travel, hours; NaN if this is not the sun's path.
  double hour(double degrees) const;

 private:
  double folded(double degrees) const;

  LightPathOptions options_;
  std::vector<double> lengths_;  // degrees of each segment
  double length_ = 0;
  double sunrise_ = 0, sunset_ = 24, offset_ = 0, degrees_per_hour_ = 15;
};

// Reads "fixed:x,y,z", "line:x,y,z;x,y,z", "arc:x,y,z;x,y,z", "keys:...;...;..." or
// "sun:DAY,LATITUDE,HOUR" into options whose other fields are kept.
Result<LightPathOptions> parse_light_path(const std::string& text, LightPathOptions options);

}  // namespace atlas
