// Internal: pushes charts together as rigid bodies.
#pragma once

#include <limits>
#include <span>
#include <vector>

#include "libatlas/core/context.h"
#include "libatlas/pack/outlines/distance_field.h"

namespace atlas::pack {

// A chart as a rigid body. The point p of its own coordinates lies at `at` + R(angle) (p - center).
struct Body {
  DistanceField field;
  std::vector<Vec2d> outline;  // points on the outline, relative to the centre
  struct Arc {  // kArc outline points that lie close together; the last arc may have fewer
    Vec2d center;
    double radius = 0;
  };
  static constexpr std::size_t kArc = 8;
  std::vector<Arc> arcs;
  Vec2d center;
  // Gyration: the mean square distance from the centre.
  double area = 0, radius = 0, gyration = 0;
  Vec2d at;
  double angle = 0;
};

Body make_body(const Mask& mask, double cell, double reach, double spacing);

// Sorts the outline into arcs. To be called after the outline has changed.
void make_arcs(Body& body);

struct SqueezeOptions {
  double clearance = 2;                                   // distance kept between two charts
  double margin = 1;                                      // distance kept from the page's edges
  double tolerance = 1;                                   // by how much both may be violated
  double work = std::numeric_limits<double>::infinity();  // limit, in words (about 2 ns each)
  double first_step = 0.01, last_step = 0.0008;           // shares of the page's sides
  bool square = false;                                    // the page is square and stays square
  // The page is made no smaller once the context is cancelled, if there is one, or this time has
  // come (wall_seconds()).
  const Context* context = nullptr;
  double deadline = std::numeric_limits<double>::infinity();
};

struct SqueezePage {
  double width = 0, height = 0;
};

// Moves and turns the bodies, which lie in the page, such that they fit a page that is as small as
// possible. Returns that page, or one without area if overlaps remain. The page is made smaller
// step by step. After each step, overlaps are removed contact by contact (position based dynamics,
// Müller et al. 2007).
SqueezePage squeeze(std::span<Body> bodies, SqueezePage page, const SqueezeOptions& options);

}  // namespace atlas::pack
