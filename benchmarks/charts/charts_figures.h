// Meshes like those that people unwrap, made in code: statues, scans, machine parts, terrain.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "libatlas/core/status.h"
#include "tests/support/shapes.h"

namespace atlas::bench {

// Names that make_figure knows.
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
// Any other name goes to make_shape (support/work.h). Errors: bad_option.
Result<test::Shape> make_figure(const std::string& name);

// The surface where a signed distance-like field changes sign, by naive surface nets (Gibson 1998):
// one vertex a cell of the grid that it crosses, at the mean of its edges' crossings.
struct Blob {
  Vec3d a, b;  // ends of a capsule; equal: a ball
  double radius_a, radius_b;
};
test::Shape blend(const std::vector<Blob>& blobs, double smoothing, std::uint64_t triangles);

}  // namespace atlas::bench
