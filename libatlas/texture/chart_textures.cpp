#include "libatlas/texture/chart_textures.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <mutex>
#include <string_view>
#include <utility>

#include "libatlas/charts/chart_set_check.h"
#include "libatlas/charts/chart_triangles.h"
#include "libatlas/core/is_enumerator.h"
#include "libatlas/core/parallel.h"
#include "libatlas/core/pool.h"
#include "libatlas/texture/downsizing.h"
#include "libatlas/texture/sample_chart.h"

namespace atlas {
namespace {

constexpr std::string_view kWho = "chart textures";  // in messages

Status check(const TextureOptions& o) {
  const auto bad = [](std::string_view what, double value, std::string_view rule) {
    return Status{ErrorCode::bad_option, fmt::format("{} is {}; it must be {}", what, value, rule)};
  };
  if (!(o.texel > 0) || !std::isfinite(o.texel) || !std::isfinite(1 / o.texel))
    return bad("texel", o.texel, "a length above 0");
  if (!(o.texture_sampling > 0) || !std::isfinite(o.texture_sampling))
    return bad("texture sampling", o.texture_sampling, "a factor above 0");
  if (!std::isfinite(o.threshold))
    return bad("downsizing threshold", o.threshold, "a display value (0 turns downsizing off)");
  if (!(o.brightest >= 0) || !std::isfinite(o.brightest))
    return bad("brightest light", o.brightest, "a luminance, or 0");
  if (o.min_side < 1) return bad("smallest texture side", o.min_side, "at least 1 texel");
  if (o.max_side < o.min_side || o.max_side > (1 << 16))
    return bad("largest texture side", o.max_side, "between the smallest side and 65536 texels");
  return {};
}

double uv_area2(const ChartSet& charts, std::size_t t) {
  const Vec2d a = charts.uvs[charts.triangle_uv[3 * t]];
  const Vec2d b = charts.uvs[charts.triangle_uv[3 * t + 1]];
  const Vec2d c = charts.uvs[charts.triangle_uv[3 * t + 2]];
  return std::fabs((b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x));
}

// Returns the density of the chart's diffuse textures. It is the root mean square over the area, so
// that the chart gets as many texels as its textures have there.
double texture_density(const ChartLight& light, const Chart& chart) {
  double area = 0, texels = 0;
  for (const std::uint32_t t : triangles_of(light.charts, chart)) {
    const double a = uv_area2(light.charts, t), d = light.sampler.texture_density(t);
    area += a;
    texels += a * d * d;
  }
  return area > 0 ? std::sqrt(texels / area) : 0;
}

double wanted_density(const ChartLight& light, const TextureOptions& options, const Chart& chart) {
  const double own = options.follow_textures ? texture_density(light, chart) : 0;
  return std::max(1 / options.texel, own * options.texture_sampling);
}

// Returns whether one colour fills the chart. The corners of the triangles are enough to decide.
ChartContent content(const ChartLight& light, const Chart& chart) {
  bool first = true, unlit = true;
  float colour[3] = {0, 0, 0};
  for (const std::uint32_t t : triangles_of(light.charts, chart)) {
    const auto triangle = light.sampler.prepare(t, 0);
    if (!triangle.constant) return ChartContent::varied;
    const float* e = triangle.illumination[0];
    if (first) std::copy_n(e, 3, colour);
    first = false;
    if (!std::equal(e, e + 3, colour)) return ChartContent::varied;
    for (int k = 0; k < 3; ++k) unlit = unlit && e[k] == 0;
  }
  return unlit ? ChartContent::unlit : ChartContent::uniform;
}

// Shrinks each side to min_side. The sides are independent, because a texture of one colour needs
// no particular shape.
void shrink(ChartTexture& texture, Vec2d size, int min_side) {
  const auto side = [min_side](std::int32_t full, double length, double& density) {
    if (full <= min_side) return full;
    density = min_side / length;
    return static_cast<std::int32_t>(min_side);
  };
  texture.width = side(texture.full_width, size.x, texture.texels_per_unit.x);
  texture.height = side(texture.full_height, size.y, texture.texels_per_unit.y);
}

struct ChartOutcome {
  double square_sum = 0;  // of display errors, over covered texels and RGB
  std::int64_t covered = 0;
  bool raised = false;
};

// Memory for the textures of one chart. It is used again for other charts.
struct Room {
  SampledChart full;
  HalvedCharts halved;
};

// The input of size_chart, with the memory that it uses.
struct Sizing {
  const ChartLight& light;
  const TextureOptions& options;
  Pool<Room>& rooms;
};

// Whether the tone curve clips light of the chart. The corners decide; textures only darken.
bool clips(const ChartLight& light, std::uint32_t id) {
  const float white = light.tone.white / light.tone.scale;
  for (const std::uint32_t t : triangles_of(light.charts, light.charts.charts[id])) {
    for (const auto& e : light.sampler.prepare(t, 0).illumination)
      if (std::max({e[0], e[1], e[2]}) > white) return true;
  }
  return false;
}

Downsizing downsize_shown(const Sizing& sizing, std::uint32_t id, double density,
                          const ToneMapping& tone) {
  std::unique_ptr<Room> room = sizing.rooms.take();
  sample_chart({sizing.light.sampler, sizing.light.charts, tone}, id, density, room->full);
  const Downsizing d = downsize(room->full, sizing.options, room->halved);
  sizing.rooms.give(std::move(room));
  return d;
}

void downsize_chart(const Sizing& sizing, std::uint32_t id, ChartTexture& out,
                    ChartOutcome& outcome) {
  const double density = out.full_texels_per_unit.x;
  Downsizing d = downsize_shown(sizing, id, density, sizing.light.tone);
  if (d.halvings > 0 && sizing.options.brightest > 0 && clips(sizing.light, id)) {
    ToneMapping unclipped;
    unclipped.scale = static_cast<float>(1 / sizing.options.brightest);
    const Downsizing bright = downsize_shown(sizing, id, density, unclipped);
    if (bright.halvings < d.halvings) d = bright;
  }
  out.sampled = true;
  out.halvings = d.halvings;
  out.width = d.width;
  out.height = d.height;
  out.texels_per_unit = {std::ldexp(density, -d.halvings), std::ldexp(density, -d.halvings)};
  out.max_error = d.max_error;
  out.rms_error = static_cast<float>(
      d.covered > 0 ? std::sqrt(d.square_sum / (3.0 * static_cast<double>(d.covered))) : 0);
  outcome.square_sum = d.square_sum;
  outcome.covered = d.covered;
}

ChartOutcome size_chart(const Sizing& sizing, std::uint32_t id, ChartTexture& out) {
  const ChartLight& light = sizing.light;
  const TextureOptions& options = sizing.options;
  ChartOutcome outcome;
  const Chart& chart = light.charts.charts[id];
  double density = wanted_density(light, options, chart);
  outcome.raised = density > 1 / options.texel;
  const double longest = std::max(chart.size.x, chart.size.y);
  if (longest * density > options.max_side) {
    density = options.max_side / longest;
    out.capped = true;
  }
  out.full_texels_per_unit = out.texels_per_unit = {density, density};
  const TexelSize full = texel_size(chart.size, out.full_texels_per_unit);
  out.full_width = out.width = full.width;
  out.full_height = out.height = full.height;
  out.content = content(light, chart);
  if (options.threshold <= 0) return outcome;
  if (out.content != ChartContent::varied) {
    shrink(out, chart.size, options.min_side);
    return outcome;
  }
  if ((std::min(full.width, full.height) + 1) / 2 < options.min_side) return outcome;
  downsize_chart(sizing, id, out, outcome);
  return outcome;
}

void add_up(const std::vector<ChartOutcome>& outcomes, TextureResult& result) {
  double square_sum = 0;
  for (std::size_t i = 0; i < outcomes.size(); ++i) {
    const ChartTexture& t = result.charts[i];
    result.full_texels += std::int64_t{t.full_width} * t.full_height;
    result.final_texels += std::int64_t{t.width} * t.height;
    result.halved += t.halvings > 0;
    result.uniform += t.content == ChartContent::uniform;
    result.unlit += t.content == ChartContent::unlit;
    result.capped += t.capped;
    result.raised += outcomes[i].raised;
    result.max_error = std::max<double>(result.max_error, t.max_error);
    square_sum += outcomes[i].square_sum;
    result.sampled += t.sampled;
    result.sampled_texels += outcomes[i].covered;
  }
  if (result.sampled_texels > 0)
    result.rms_error = std::sqrt(square_sum / (3.0 * static_cast<double>(result.sampled_texels)));
}

}  // namespace

Status check_scene_of(const ChartLight& light) {
  const std::size_t charted = light.charts.triangle_chart.size();
  const std::size_t triangles = light.sampler.scene().triangle_count();
  if (charted != triangles)
    return {ErrorCode::bad_input,
            fmt::format("the charts are of a mesh of {} triangles, and the scene has {}", charted,
                        triangles)};
  if (!is_enumerator(light.tone.op, ToneOperator::reinhard_devlin))
    return {ErrorCode::bad_input,
            fmt::format("the tone mapping's op is {} (give a ToneOperator)", int(light.tone.op))};
  if (Status s = check_triangle_lists(light.charts, kWho); !s.ok()) return s;
  return check_chart_arrays(light.charts, 3 * triangles, kWho);
}

Status check_light(const ChartLight& light, std::uint32_t chart) {
  if (Status s = check_chart(light.charts, chart, kWho); !s.ok()) return s;
  for (const std::uint32_t t : triangles_of(light.charts, light.charts.charts[chart])) {
    const int corner = light.sampler.bad_corner(t);
    if (corner == 3) continue;
    const Scene& s = light.sampler.scene();
    return {ErrorCode::bad_input,
            fmt::format("triangle {}: at vertex {} illumination times reflectance is no number or "
                        "beyond 1e36 (where it is unknown, 0 leaves the surface black)",
                        t, s.indices[3 * std::size_t(t) + static_cast<std::size_t>(corner)])};
  }
  return {};
}

TexelSize texel_size(Vec2d size, Vec2d texels_per_unit) {
  // A millionth of a texel more than a whole number is rounding. The chart then extends beyond its
  // box by that amount, which is not visible.
  const auto side = [](double texels) {
    return static_cast<std::int32_t>(std::clamp(std::ceil(texels - 1e-6), 1.0, 1e9));
  };
  return {side(size.x * texels_per_unit.x), side(size.y * texels_per_unit.y)};
}

Result<std::vector<double>> wanted_densities(const ChartLight& light, const TextureOptions& options,
                                             const Context& context) {
  constexpr std::size_t kGrain = 16;
  if (Status s = check(options); !s.ok()) return s;
  if (Status s = check_scene_of(light); !s.ok()) return s;
  std::vector<double> densities(light.charts.charts.size());
  for (std::size_t c = 0; c < densities.size(); ++c)
    if (Status s = check_chart(light.charts, c, kWho); !s.ok()) return s;
  parallel_for(context, densities.size(), kGrain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t c = begin; c < end; ++c)
      densities[c] = wanted_density(light, options, light.charts.charts[c]);
  });
  if (context.cancelled()) return Status::cancelled();
  return densities;
}

Result<TextureResult> size_chart_textures(const ChartLight& light, const TextureOptions& options,
                                          const Context& context) {
  if (Status s = check(options); !s.ok()) return s;
  if (Status s = check_scene_of(light); !s.ok()) return s;
  const std::size_t n = light.charts.charts.size();
  for (std::size_t i = 0; i < n; ++i)
    if (Status s = check_light(light, static_cast<std::uint32_t>(i)); !s.ok()) return s;
  TextureResult result;
  result.charts.resize(n);
  std::vector<ChartOutcome> outcomes(n);
  Pool<Room> rooms;
  std::mutex reporting;
  std::size_t triangles_done = 0;
  parallel_for(context, n, 1, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      if (context.cancelled()) return;
      outcomes[i] =
          size_chart({light, options, rooms}, static_cast<std::uint32_t>(i), result.charts[i]);
      const std::lock_guard lock(reporting);
      triangles_done += light.charts.charts[i].triangle_count;
      context.report("downsizing", static_cast<double>(triangles_done) /
                                       static_cast<double>(light.charts.chart_triangles.size()));
    }
  });
  if (context.cancelled()) return Status::cancelled();
  add_up(outcomes, result);
  return result;
}

}  // namespace atlas
