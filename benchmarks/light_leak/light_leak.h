// Figures 1 to 3 of the paper: light that leaks across a shadow edge, against the texel size.
#pragma once

#include "benchmarks/light_leak/picture.h"
#include "benchmarks/light_leak/shadow_edge.h"
#include "benchmarks/support/staged.h"
#include "libatlas/bake/bake.h"

namespace atlas::bench {

struct LeakOptions {
  ShadowEdgeOptions edge;
  double texel = 0.005;    // requested, metres
  double band_texels = 2;  // points within this many (actual) texels of the edge count
  // Second figure: points within this many metres, whatever the texel size.
  double fixed_band = 0.01;
  double sampling = 0.125;       // distance of the sample points, texels
  double threshold = 2.0 / 255;  // for downsizing
  BakeMethod method = BakeMethod::least_squares;
  double picture = 0;  // side of the drawn patch, metres; 0: none
  int pixels = 240;    // along that side
};

// Errors at points of the object, relative to the input's light there: the absolute difference in
// the worst channel. Both are tone-mapped, sRGB-encoded and clipped to [0, 1]. The atlas is read
// from 8-bit values with bilinear interpolation, as in a viewer.
struct LeakErrors {
  std::uint64_t points = 0;
  double p50 = 0, p95 = 0, p99 = 0, maximum = 0, rms = 0;
};

struct Leak {
  double texel = 0;  // of the object's charts after scaling and downsizing, metres (area mean)
  double scale = 1;  // applied to all pages equally
  std::size_t pages = 0;
  double edge_length = 0;         // of the shadow edge, metres
  LeakErrors band, fixed, whole;  // within band_texels; within fixed_band; the whole object
  LeakPicture picture;
};

// `staged` holds the scene. Its charts and light are computed once and kept; sizes and layout are
// computed anew. Errors: bad_input (no such object; no shadow edge on it); those of the stages; io.
Result<Leak> measure_leak(Staged& staged, const LeakOptions& options);

}  // namespace atlas::bench
