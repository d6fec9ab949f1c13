// Generated meshes like those that people unwrap: statues, scans, machine parts, terrain.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "libatlas/core/status.h"
#include "tests/support/shapes.h"

namespace atlas::bench {

// The names that make_figure accepts.
inline constexpr const char* kFigures =
    "figure, hound, bust, figure-scan, terraces, shaft, bracket";

// Makes "NAME:TRIANGLES" (the number is met within a fifth):
//   figure       a standing figure of blended capsules, one closed surface
//   hound        the same with four legs, ears and a tail
//   bust         a head on a plinth with folds of cloth
//   figure-scan  the figure with scan noise, sigma = 15 % of the mean edge along the normals
//   terraces     terrain with ridges and steps
//   shaft        a turned part: steps, grooves, a cone and a bore, in metres (0.2 m long)
//   bracket      boxes and bores of one CAD assembly, each a closed piece, in metres
// Any other name goes to make_shape (kinds.h). Errors: bad_option.
Result<test::Shape> make_figure(const std::string& name);

// Returns a closed surface of revolution about z. The profile is a closed polygon (radius, height),
// anticlockwise; each side is divided into pieces about twice as long as the arcs around.
test::Shape turned(const std::vector<Vec2d>& profile, int around);

// Returns the surface where a field similar to a signed distance changes sign, by naive surface
// nets (Gibson 1998). Each cell of the grid that it crosses gets one vertex, at the mean of the
// crossings of its edges.
struct Blob {
  Vec3d a, b;  // ends of a capsule; a ball if they are equal
  double radius_a, radius_b;
};
test::Shape blend(const std::vector<Blob>& blobs, double smoothing, std::uint64_t triangles);

}  // namespace atlas::bench
