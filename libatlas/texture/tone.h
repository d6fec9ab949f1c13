// Tone mapping: from linear luminance to what a display shows.
#pragma once

#include <cstdint>
#include <string_view>

#include "libatlas/core/context.h"
#include "libatlas/core/srgb.h"
#include "libatlas/core/status.h"
#include "libatlas/core/vec.h"
#include "libatlas/texture/luminance.h"

namespace atlas {

// Area-weighted statistics of the surface's luminance; scene units of LuminanceSampler.
struct LuminanceStatistics {
  double lit_area = 0;  // surface whose luminance is not exactly zero
  double unlit_area = 0;
  // Over what is visible and lit: rays from the empty space inside the scene's box (see
  // docs/texture.md); if the scene encloses no space, over the lit surface by area.
  double percentile98 = 0, percentile99 = 0;  // of max(R, G, B)
  double median = 0;                          // of Y = luma (Rec. 709 weights)
  // The median of Y without what is darker than a hundredth of its 90th percentile: a robust
  // estimate of the log-average of what is lit, which darkness beside it does not change.
  double middle = 0;
  bool seen = false;                           // the former: what is visible
  double maximum = 0;                          // of max(R, G, B) over the samples
  double log_average = 0;                      // exp(mean ln Y) over the lit surface
  double mean = 0;                             // of Y over the lit surface
  Vec3f mean_rgb = {};                         // over the lit surface
  double minimum_log = 0, maximum_log = 0;     // ln Y at the 1st and 99th percentile
  std::uint64_t not_finite = 0, negative = 0;  // samples left out / counted as zero
};

// Samples every triangle in proportion to its area. Deterministic.
// Errors: bad_input when no triangle has area; cancelled.
Result<LuminanceStatistics> measure_luminance(const LuminanceSampler& sampler,
                                              const Context& context);

enum class ToneOperator {
  linear,           // clip at white
  reinhard,         // Reinhard et al. 2002, eq. 4: global, with a white point
  drago,            // Drago et al. 2003: adaptive logarithmic, bias 0.85
  reinhard_devlin,  // Reinhard and Devlin 2005: photoreceptor, adapts to the scene's mean
};

// "linear", "reinhard", "drago", "reinhard-devlin". Errors: bad_option, naming the choices.
Result<ToneOperator> parse_tone_operator(std::string_view name);
std::string_view tone_operator_name(ToneOperator op);

struct ToneOptions {
  ToneOperator op = ToneOperator::linear;
  // Scene luminance that becomes display white; 0: automatic. linear: the 98th
  // percentile of what is visible, but 4 to 15 times LuminanceStatistics::middle; the others: the
  // largest luminance.
  double white = 0;                 // >= 0
  double exposure_stops = 0;        // brightens (+) or darkens (-) by powers of two, -64..64
  double key = 0.18;                // reinhard: middle grey, 1e-6..1e6
  double bias = 0.85;               // drago: 0.5..0.999
  double contrast = 0;              // reinhard_devlin: m, 0: automatic (0.3..1), else 0.01..1.5
  double chromatic_adaptation = 0;  // reinhard_devlin: c, 0..1
  double light_adaptation = 1;      // reinhard_devlin: a, 0..1
};

// Whether every option lies in the range given above; the message names the field and its range.
Status check_options(const ToneOptions& options);

// A tone curve with all its numbers fixed. Cheap to copy, thread-safe.
//
// Colour: `linear` works per channel. `reinhard` and `drago` map luma Y and scale RGB by
// curve(Y) / Y, which keeps hue and saturation; channels that then exceed 1 clip. `reinhard_devlin`
// is per channel, as published.
struct ToneMapping {
  ToneOperator op = ToneOperator::linear;
  float scale = 1;                    // multiplies luminance first
  float white = 1;                    // scaled luminance that becomes 1
  float parameter[4] = {0, 0, 0, 0};  // the operator's own constants, see tone.cpp
  float offset[3] = {0, 0, 0};        // reinhard_devlin: the adaptation term of each channel

  // Linear display value of each channel, in [0, 1]. Negative and NaN inputs count as 0.
  Vec3f map(Vec3f luminance) const {
    if (op != ToneOperator::linear) return map_curve(luminance);
    const auto clip = [this](float v) {
      v *= scale;
      return v > 0 ? (v < 1 ? v : 1.0f) : 0.0f;
    };
    return {clip(luminance.x), clip(luminance.y), clip(luminance.z)};
  }
  // The same, sRGB-encoded: what an 8-bit texture stores, in [0, 1].
  Vec3f display(Vec3f luminance) const {
    const Vec3f v = map(luminance);
    return {srgb_encode(v.x), srgb_encode(v.y), srgb_encode(v.z)};
  }

 private:
  Vec3f map_curve(Vec3f luminance) const;  // the operators other than linear
};

// Errors: bad_option, naming the option; bad_input where the light is so weak (white below 3e-39)
// that a float does not hold the scale.
Result<ToneMapping> make_tone_mapping(const ToneOptions& options,
                                      const LuminanceStatistics& statistics);

}  // namespace atlas
