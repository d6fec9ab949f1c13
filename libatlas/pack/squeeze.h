// Internal: pushing charts together as rigid bodies.
#pragma once

#include <span>
#include <vector>

#include "libatlas/pack/distance_field.h"

namespace atlas::pack {

// A chart as a rigid body; what lies at p of its own coordinates is at `at` + R(angle) (p -
// center).
struct Body {
  DistanceField field;
  std::vector<Vec2d> outline;  // around the centre
  struct Arc {                 // kArc points of it that lie close together, the last one fewer
    Vec2d center;
    double radius = 0;
  };
  static constexpr std::size_t kArc = 8;
  std::vector<Arc> arcs;
  Vec2d center;
  double area = 0, radius = 0, gyration = 0;  // gyration: mean square distance from the centre
  Vec2d at;
  double angle = 0;
};

Body make_body(const Mask& mask, double cell, double reach, double spacing);

// Sorts the outline into arcs; to be called when it has changed.
void make_arcs(Body& body);

struct SqueezeOptions {
  double clearance = 2;  // kept between two charts
  double margin = 1;     // kept to the page's edges
  double tolerance = 1;  // of both
  std::uint32_t sweeps = 2000;
  double first_step = 0.01, last_step = 0.0008;  // shares of the page's sides
  bool square = false;                           // the page is and stays square
};

struct SqueezePage {
  double width = 0, height = 0;
};

// Moves and turns the bodies, which lie in the page, such that they fit a page as small as
// possible. Returns that page, or one without area where overlaps remain. The page is made smaller
// step by step; after each step overlaps are taken out contact by contact (position based dynamics,
// Müller et al. 2007).
SqueezePage squeeze(std::span<Body> bodies, SqueezePage page, const SqueezeOptions& options);

}  // namespace atlas::pack
