// The paper's figures 1 to 3: light that leaks across a shadow's edge, against the texel's size.
#pragma once

#include "benchmarks/light_leak/picture.h"
#include "benchmarks/light_leak/shadow_edge.h"
#include "benchmarks/support/staged.h"
#include "libatlas/bake/bake.h"

namespace atlas::bench {

struct LeakOptions {
  ShadowEdgeOptions edge;
  double texel = 0.005;      // asked for, metres
  double band_texels = 2;    // points within this many (actual) texels of the edge count
  double fixed_band = 0.01;  // and, as a second figure, within this many metres, whatever the texel
  double sampling = 0.125;   // distance of the sample points, texels
  double threshold = 2.0 / 255;  // of downsizing
  BakeMethod method = BakeMethod::least_squares;
  double picture = 0;  // side of the patch that is drawn, metres; 0: none
  int pixels = 240;    // of that side
};

// Errors at points of the object against the input's light there, both tone-mapped, sRGB-encoded,
// clipped to [0, 1]: the largest channel's absolute difference. The atlas is read back as 8-bit
// values, bilinearly, as a viewer does.
struct LeakErrors {
  std::uint64_t points = 0;
  double p50 = 0, p95 = 0, p99 = 0, maximum = 0, rms = 0;
};

struct Leak {
  double texel = 0;  // of the object's charts after scaling and downsizing, metres (area mean)
  double scale = 1;  // applied to all pages alike
  std::size_t pages = 0;
  double edge_length = 0;         // of the shadow's edge, metres
  LeakErrors band, fixed, whole;  // within band_texels; within fixed_band; the whole object
  LeakPicture picture;
};

// `staged` holds the scene; charts and light are computed once and kept, sizes and layout anew.
// Errors: bad_input (no such object; no shadow edge on it); those of the stages; io.
Result<Leak> measure_leak(Staged& staged, const LeakOptions& options);

}  // namespace atlas::bench
