#include "libatlas/texture/tone.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "libatlas/core/is_enumerator.h"
#include "libatlas/core/luma.h"

namespace atlas {
namespace {

constexpr std::array<std::pair<ToneOperator, std::string_view>, 4> kOperators{{
    {ToneOperator::linear, "linear"},
    {ToneOperator::reinhard, "reinhard"},
    {ToneOperator::drago, "drago"},
    {ToneOperator::reinhard_devlin, "reinhard-devlin"},
}};

// A scaled channel that no curve overflows on: infinity over infinity would show the brightest
// light black. NaN and negative ones count as 0.
float bounded(float v) {
  return v > 0 ? std::min(v, 1e36f) : 0.0f;
}

float clip(float v) {
  return v > 0 ? std::min(v, 1.0f) : 0.0f;
}

// The operators' curves, of luminance already scaled.

// Reinhard et al. 2002, eq. 4, divided by y.
float reinhard_ratio(float y, float white) {
  return (1 + y / (white * white)) / (1 + y);
}

// Drago et al. 2003, eq. 4 with Ldmax = 100 cd/m², divided by y. `exponent` is ln(bias) / ln(0.5),
// `norm` is 1 / log10(1 + white).
float drago_ratio(float y, float white, float exponent, float norm) {
  if (y < 1e-12f) return norm / std::log(2.0f);  // the limit at 0
  const float share = std::min(y / white, 1e36f);
  return norm * std::log1p(y) / (y * std::log(2 + 8 * std::pow(share, exponent)));
}

// Reinhard and Devlin 2005, eq. 1 to 6, for one channel, without the final normalisation.
float photoreceptor(float v, float adaptation, float m) {
  return v > 0 ? v / (v + std::pow(adaptation, m)) : 0.0f;
}

// Reinhard and Devlin 2005, section 3: contrast from the key of the scene.
double automatic_contrast(const LuminanceStatistics& s) {
  const double range = s.maximum_log - s.minimum_log;
  if (!(range > 0)) return 0.3;
  const double k = (s.maximum_log - std::log(s.log_average)) / range;
  return 0.3 + 0.7 * std::pow(std::clamp(k, 0.0, 1.0), 1.4);
}

void set_drago(ToneMapping& tone, const ToneOptions& o, double average, double white) {
  // Section 3.2: the world adaptation luminance is corrected for the bias.
  const double adaptation = average / std::pow(1 + o.bias - 0.85, 5);
  tone.scale = static_cast<float>(1 / adaptation);
  tone.white = static_cast<float>(white / adaptation);
  tone.parameter[0] = static_cast<float>(std::log(o.bias) / std::log(0.5));
  tone.parameter[1] = static_cast<float>(1 / std::log10(1 + white / adaptation));
}

void set_reinhard_devlin(ToneMapping& tone, const ToneOptions& o, const LuminanceStatistics& s,
                         double white) {
  // The published curve depends on the unit of luminance; dividing by the scene's log average
  // first takes that away.
  const double average = s.log_average;
  tone.scale = static_cast<float>(1 / average);
  tone.white = static_cast<float>(white / average);
  tone.parameter[0] = static_cast<float>(o.contrast > 0 ? o.contrast : automatic_contrast(s));
  tone.parameter[1] = static_cast<float>(o.light_adaptation);
  tone.parameter[2] = static_cast<float>(o.chromatic_adaptation);
  const float mean[3] = {s.mean_rgb.x, s.mean_rgb.y, s.mean_rgb.z};
  for (int k = 0; k < 3; ++k)
    tone.offset[k] = static_cast<float>(o.chromatic_adaptation * mean[k] / average +
                                        (1 - o.chromatic_adaptation));
  const auto a = static_cast<float>(o.light_adaptation);
  const float at_white = photoreceptor(tone.white, a * tone.white + (1 - a), tone.parameter[0]);
  tone.parameter[3] = 1 / at_white;
}

// Returns the white of a linear curve: it lies so far above the log-average, here above its robust
// estimate, that this is shown at a key (Reinhard et al. 2002, eq. 2). Of the keys of usual scenes,
// the one at which a fiftieth of what is visible is white.
double linear_white(const LuminanceStatistics& s) {
  constexpr double kHighKey = 1 / 4.0, kLowKey = 1 / 15.0;
  return std::clamp(s.percentile98, s.middle / kHighKey, s.middle / kLowKey);
}

}  // namespace

Status check_options(const ToneOptions& o) {
  const auto within = [](double v, double lo, double hi) { return v >= lo && v <= hi; };
  const auto must = [](std::string_view field, double value, std::string_view range) {
    return Status(ErrorCode::bad_option,
                  fmt::format("ToneOptions::{} is {:g}; it must be {}", field, value, range));
  };
  if (!(o.white >= 0) || !std::isfinite(o.white))
    return must("white", o.white, "a luminance above 0, or 0 to measure it");
  if (!within(o.exposure_stops, -64, 64))
    return must("exposure_stops", o.exposure_stops, "within -64..64 stops");
  if (!within(o.key, 1e-6, 1e6))
    return must("key", o.key, "within 1e-6..1e6 (0.18 is middle grey)");
  if (!within(o.bias, 0.5, 0.999)) return must("bias", o.bias, "within 0.5..0.999");
  if (o.contrast != 0 && !within(o.contrast, 0.01, 1.5))
    return must("contrast", o.contrast, "0 (automatic) or within 0.01..1.5");
  if (!within(o.chromatic_adaptation, 0, 1))
    return must("chromatic_adaptation", o.chromatic_adaptation, "within 0..1");
  if (!within(o.light_adaptation, 0, 1))
    return must("light_adaptation", o.light_adaptation, "within 0..1");
  if (!is_enumerator(o.op, ToneOperator::reinhard_devlin))
    return must("op", int(o.op), "a ToneOperator");
  return {};
}

Result<ToneOperator> parse_tone_operator(std::string_view name) {
  std::string choices;
  for (const auto& [op, text] : kOperators) {
    if (text == name) return op;
    choices += choices.empty() ? "" : ", ";
    choices += text;
  }
  return Status{ErrorCode::bad_option,
                fmt::format("unknown tone mapping '{}'; choose one of {}", name, choices)};
}

std::string_view tone_operator_name(ToneOperator op) {
  return kOperators[static_cast<std::size_t>(op)].second;
}

Vec3f ToneMapping::map_curve(Vec3f luminance) const {
  const Vec3f c{bounded(scale * luminance.x), bounded(scale * luminance.y),
                bounded(scale * luminance.z)};
  const float y = luma(c.x, c.y, c.z);
  if (!(y > 0)) return {};
  if (op == ToneOperator::reinhard_devlin) {
    const float in[3] = {c.x, c.y, c.z};
    float out[3];
    for (int k = 0; k < 3; ++k) {
      const float local = parameter[2] * in[k] + (1 - parameter[2]) * y;
      const float adaptation = parameter[1] * local + (1 - parameter[1]) * offset[k];
      out[k] = clip(parameter[3] * photoreceptor(in[k], adaptation, parameter[0]));
    }
    return {out[0], out[1], out[2]};
  }
  const float ratio = op == ToneOperator::reinhard
                          ? reinhard_ratio(y, white)
                          : drago_ratio(y, white, parameter[0], parameter[1]);
  return {clip(ratio * c.x), clip(ratio * c.y), clip(ratio * c.z)};
}

Result<ToneMapping> make_tone_mapping(const ToneOptions& options,
                                      const LuminanceStatistics& statistics) {
  if (Status s = check_options(options); !s.ok()) return s;
  ToneMapping tone;
  tone.op = options.op;
  const bool linear = options.op == ToneOperator::linear;
  double white = options.white;
  if (white <= 0) white = linear ? linear_white(statistics) : statistics.maximum;
  if (!(white > 0)) white = 1;  // an unlit scene: any scale shows it black
  LuminanceStatistics s = statistics;
  if (!(s.log_average > 0)) s.log_average = white;
  switch (options.op) {
    case ToneOperator::linear:
      tone.scale = static_cast<float>(1 / white);
      break;
    case ToneOperator::reinhard:
      tone.scale = static_cast<float>(options.key / s.log_average);
      tone.white = static_cast<float>(options.key / s.log_average * white);
      break;
    case ToneOperator::drago:
      set_drago(tone, options, s.log_average, white);
      break;
    case ToneOperator::reinhard_devlin:
      set_reinhard_devlin(tone, options, s, white);
      break;
  }
  if (!std::isfinite(tone.scale) || !std::isfinite(tone.white))
    return Status{
        ErrorCode::bad_input,
        fmt::format("light of {:.3g} is to be white: floats do not hold the inverse (give "
                    "the light in another unit)",
                    white)};
  tone.scale *= static_cast<float>(std::exp2(options.exposure_stops));
  return tone;
}

}  // namespace atlas
