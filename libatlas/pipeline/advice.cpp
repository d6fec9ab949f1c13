#include "libatlas/pipeline/advice.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstddef>
#include <utility>

#include "libatlas/pack/larger_pages.h"
#include "libatlas/pipeline/layout_options.h"
#include "libatlas/scene/named_materials.h"

namespace atlas {
namespace {

double page_texels(const ExportReport& report) {
  double texels = 0;
  for (const PageReport& page : report.pages) texels += double(page.width) * page.height;
  return texels;
}

std::string on_many_pages(const ExportReport& report, const ExportOptions& options) {
  const LargerPages wanted = larger_pages(page_texels(report), options.atlas_size);
  const std::string larger =
      wanted.side > options.atlas_size
          ? fmt::format("ExportOptions::atlas_size {} ExportOptions::atlases {} holds as much; ",
                        wanted.side, wanted.count)
          : "";
  return fmt::format(
      "{} charts on {} pages of {} x {}: viewers load and draw every page by itself, which so many "
      "make slow ({}a longer ExportOptions::texel_metres or a higher ExportOptions::threshold "
      "needs fewer)",
      report.charts.size(), report.pages.size(), options.atlas_size, options.atlas_size, larger);
}

std::string on_small_charts(const ExportReport& report, const ExportOptions& options,
                            double texels_a_chart) {
  return fmt::format(
      "{} charts have {:.0f} texels each on average, and {:.0f} % of the pages are gutters and "
      "gaps between them ({} leave more for the light; a larger ChartOptions::max_stretch or "
      "charts across materials (ChartOptions::split_at_materials) make fewer charts)",
      report.charts.size(), texels_a_chart, 100 * (1 - report.uv_utilization),
      more_room(options, true, "a lower ExportOptions::mip_levels"));
}

// Returns whether the number of charts grows with that of the triangles because single vertices
// exceed the bound. On balls of 49,000 and 197,000 triangles, scan noise of 15 % of the edges has
// no peaks, and 4 charts are enough; noise of 20 % has them at 0.012 and 0.023 % of the vertices,
// and they take 20 and 63 charts.
bool shattered_by_noise(const ExportReport& report, const ExportOptions& options) {
  constexpr double kPeaks = 0.0001;
  constexpr std::size_t kManyCharts = 48, kChartsAPeak = 8;
  const auto peaks = report.noise.peaks;
  return options.charts.cone_degrees == 0 && report.charts.size() >= kManyCharts &&
         double(peaks) > kPeaks * double(report.noise.vertices) &&
         kChartsAPeak * peaks >= report.charts.size();
}

std::string on_rounding(const ExportReport& report) {
  return fmt::format(
      "{} of {} charts are stretched more than the bound allows once their uvs are floats, up to "
      "{:.4g} (charts or triangles narrower than about a tenth of a texel, and bounds below about "
      "1.001, need more digits than floats have: a larger ExportOptions::atlas_size or "
      "ChartOptions::max_stretch)",
      report.charts_beyond_bound, report.charts.size(), report.written_stretch_999);
}

std::string on_noise(const ExportReport& report) {
  return fmt::format(
      "{} charts, more the finer the mesh is: its surface is rough as by scan noise, and {} of {} "
      "vertices are peaks that stretch a chart beyond the bound (smooth the mesh first, or a "
      "larger ChartOptions::max_stretch)",
      report.charts.size(), report.noise.peaks, report.noise.vertices);
}

std::string length_text(double metres) {
  return metres < 1 ? fmt::format("{:.3g} mm", 1e3 * metres) : fmt::format("{:.3g} m", metres);
}

std::string packed_length(const ExportReport& report) {
  return length_text(report.packed_texel * report.metres_per_unit);
}

std::string on_long_texels(const ExportReport& report, double texels_a_chart) {
  return fmt::format(
      "{} charts have {:.0f} texels each on average, {} long: little of the light is left "
      "(a shorter ExportOptions::texel_metres)",
      report.charts.size(), texels_a_chart, packed_length(report));
}

// From this share of the pages on, a lower least side leaves noticeably more of them to other
// charts: texels become a twentieth shorter, or more.
constexpr double kMuchHeld = 0.1;

// Returns what lets pages hold shorter texels.
std::string room_for_texels(const ExportReport& report, const ExportOptions& options) {
  const bool held = report.least_side_share >= kMuchHeld && options.min_side > 1;
  return more_room(options, true, held ? "a lower ExportOptions::min_side" : "");
}

std::string on_coarse_texels(const ExportReport& report, const ExportOptions& options) {
  const bool given = options.texel_metres > 0;
  return fmt::format(
      "texels are {} long, not the {} {}, since the pages hold no more ({}, or a "
      "longer ExportOptions::texel_metres{})",
      packed_length(report), length_text(report.texel * report.metres_per_unit),
      given ? "of ExportOptions::texel_metres" : "that are usual", room_for_texels(report, options),
      given ? "" : " if it will do");
}

// Pages below this are visibly poorer than the light, as long as finer texels could show more of
// it.
constexpr double kPoorDecibels = 35;

// From here on the error is below what halving may cost (ExportOptions::threshold), so that finer
// texels would show nothing more.
constexpr double kFaithfulDecibels = 45;

bool is_faithful(const ExportReport& report) {
  return report.error_measured && report.fidelity.lit > 0 &&
         report.fidelity.psnr >= kFaithfulDecibels;
}

bool loses_detail(const ExportReport& report) {
  const double texel = report.packed_texel * report.metres_per_unit;
  return report.error_measured && report.fidelity.lit > 0 && report.fidelity.psnr < kPoorDecibels &&
         2 * texel > report.plan.light_spacing_m && report.plan.light_spacing_m > 0;
}

std::string on_lost_detail(const ExportReport& report, const ExportOptions& options) {
  const bool held = report.packed_texel <= 1.1 * report.texel;
  return fmt::format(
      "pages show the light to {:.1f} dB only: their texels are {} long, and the vertices "
      "that carry the light are {} apart ({})",
      report.fidelity.psnr, packed_length(report), length_text(report.plan.light_spacing_m),
      held ? "a shorter ExportOptions::texel_metres" : room_for_texels(report, options));
}

std::string on_white(const ExportReport& report) {
  return fmt::format(
      "light of {:.3g}, the geometric mean, is shown white like all above {:.3g}: most shadows are "
      "lost (a larger ToneOptions::white or a lower ToneOptions::exposure_stops)",
      double(report.luminance.log_average), report.exposure_white);
}

// Colours are shown with 1 as white, so those of 0 to 255 are white all over.
std::string on_large_colours(const ExportReport& report) {
  return fmt::format(
      "colours of {:.3g}, the geometric mean, are shown white like all above 1 (colours are shares "
      "of 1 where a file does not store them as bytes: divide those of 0 to 255 by 255)",
      double(report.luminance.log_average));
}

std::string on_black(const ExportReport& report) {
  return fmt::format(
      "light of {:.3g}, the brightest that is seen but for 2 %, is shown black; white begins at "
      "{:.3g} (a smaller ToneOptions::white or a higher ToneOptions::exposure_stops)",
      double(report.luminance.percentile98), report.exposure_white);
}

// Light of ten times the median as white shows the median as a dark grey (89 of 255).
std::string on_dark(const ExportReport& report) {
  const double median = report.luminance.median;
  const bool curve = report.tone.op != ToneOperator::reinhard_devlin;
  const std::string white = fmt::format("ToneOptions::white {:.3g}", 10 * median);
  return fmt::format(
      "more than half of what is seen is shown black: its median is {:.3g}, and white begins at "
      "{:.3g} ({})",
      median, report.exposure_white,
      curve ? "ToneOptions::op reinhard-devlin shows dark rooms and what is bright beside them, " +
                  white + " the dark alone"
            : "a linear tone curve with " + white + " shows the dark alone");
}

// Whether given charts are hardly larger than single triangles. Two triangles a chart are usual:
// those of quads in maps of light.
bool keeps_crumbs(const ExportReport& report) {
  constexpr std::uint64_t kMany = 256;
  return report.repairs.kept_charts >= kMany && 2 * report.repairs.kept_charts > report.triangles;
}

std::string on_crumbs(const ExportReport& report) {
  return fmt::format(
      "ChartOptions::keep_uv_charts kept {} charts of {} triangles (if texture coordinates of "
      "neighbours differ by rounding, weld them with a tolerance, or leave it out)",
      report.repairs.kept_charts, report.triangles);
}

// Returns a kept chart that is longer than all other charts, if it leaves the pages nearly empty;
// else null. Charts of usual shapes fill half of their pages, and rings a fifth.
const Chart* overlong_kept(const ExportReport& report) {
  constexpr double kNearlyEmpty = 0.1;
  if (report.charts.empty() || report.pages.empty() || report.uv_utilization >= kNearlyEmpty)
    return nullptr;
  const auto shorter = [](const Chart& a, const Chart& b) { return a.size.x < b.size.x; };
  const Chart& longest = *std::max_element(report.charts.begin(), report.charts.end(), shorter);
  return longest.kept ? &longest : nullptr;
}

std::string on_overlong(const ExportReport& report, const Chart& chart) {
  return fmt::format(
      "charts fill only {:.2g} % of the pages: charts[{}] of the report, of {} triangles, is "
      "{:.3g} long and {:.3g} wide for {:.3g} square units of surface, since "
      "ChartOptions::keep_uv_charts kept its shape (unwrap it anew; give ChartOptions::uv_aspect "
      "if its page was not square; or leave ChartOptions::keep_uv_charts out)",
      100 * report.uv_utilization, &chart - report.charts.data(), chart.triangle_count,
      chart.size.x, chart.size.y, chart.distortion.surface_area);
}

// Returns the display value of grey light.
float shown(const ExportReport& report, double luminance) {
  const auto v = static_cast<float>(luminance);
  return report.tone.display({v, v, v}).x;
}

std::vector<std::string> advice_on_tone(const ExportReport& report, const ExportOptions& options) {
  constexpr float kBlack = 6 / 255.0f;
  std::vector<std::string> lines;
  const LuminanceStatistics& light = report.luminance;
  const auto is_black = [&](double v) { return v > 0 && shown(report, v) < kBlack; };
  // A measured white suits the brightest light, even if all light is equal.
  const bool measured = options.tone.white <= 0 && options.tone.exposure_stops == 0;
  if (shown(report, light.log_average) >= 1) {
    if (!measured)
      lines.push_back(on_white(report));
    else if (options.quantity == Quantity::colour)
      lines.push_back(on_large_colours(report));
  }
  if (!measured && is_black(light.percentile98))
    lines.push_back(on_black(report));
  else if (is_black(light.median) && options.quantity != Quantity::colour)
    lines.push_back(on_dark(report));
  return lines;
}

// Of textures that stayed encoded, only PNG files have alpha. Their header says so in a bit of the
// colour type, except for palettes (3), which may have it.
bool may_have_alpha(const Texture& texture) {
  constexpr std::size_t kColourType = 25;  // bytes of a PNG file before it
  if (texture.encoded.empty()) return texture.image.channels % 2 == 0;
  if (texture.encoded.size() <= kColourType || texture.encoded[0] != 0x89) return false;
  const int type = texture.encoded[kColourType];
  return type == 3 || (type & 4) != 0;
}

bool is_open(const Material& m, const Scene& scene) {
  const bool holes = m.texture >= 0 && may_have_alpha(scene.textures[std::size_t(m.texture)]);
  return m.opacity_textured || m.opacity_by_view ||
         (m.alpha_mode != AlphaMode::opaque && (m.opacity < 1 || holes));
}

}  // namespace

std::vector<std::string> advice_on(const ExportReport& report, const ExportOptions& options) {
  // Below these limits, it shows that pages lack light that the scene has.
  constexpr double kFewTexels = 32 * 32, kHardlyAny = 8 * 8, kLittleUsed = 0.4, kCoarse = 2;
  constexpr std::size_t kManyCharts = 256;
  std::vector<std::string> lines;
  const bool cone = options.charts.cone_degrees > 0;
  if (options.charts.keep_uv_charts && report.repairs.kept_charts == 0)
    lines.push_back(fmt::format(
        "ChartOptions::keep_uv_charts kept no chart: the scene's texture coordinates are missing, "
        "flipped, lie on each other{}or are squeezed to lines (leave it out for charts of all new "
        "borders)",
        cone ? ", bend beyond ChartOptions::cone_degrees " : " "));
  if (options.charts.keep_uv_charts && keeps_crumbs(report)) lines.push_back(on_crumbs(report));
  if (const Chart* chart = overlong_kept(report); chart && options.charts.keep_uv_charts)
    lines.push_back(on_overlong(report, *chart));
  if (report.triangles > 0 && report.surface_area == 0)
    lines.push_back(
        "no triangle has an area, so uvs say nothing (check how the scene was exported, and the "
        "digits of its coordinates)");
  if (shattered_by_noise(report, options)) lines.push_back(on_noise(report));
  if (report.charts_beyond_bound > 0) lines.push_back(on_rounding(report));
  if (report.pages.empty() || report.gpu_bytes == 0) return lines;  // no light was baked
  if (report.luminance.lit_area == 0 && report.luminance.unlit_area > 0)
    lines.push_back(
        "no light is above 0, so pages are black (check the simulation's result, and how it was "
        "exported)");
  if (report.pages.size() > kManyPages) lines.push_back(on_many_pages(report, options));
  const double asked = options.texel_metres / report.metres_per_unit;
  const bool coarse = report.texel > 0 && report.packed_texel > kCoarse * report.texel;
  const double texels_a_chart =
      report.uv_utilization * page_texels(report) / double(report.charts.size());
  if (report.charts.size() >= kManyCharts && texels_a_chart < kFewTexels &&
      report.uv_utilization < kLittleUsed) {
    // At scale 1 all charts have what they asked for. They are small because their light is even.
    if (report.scale < 1) lines.push_back(on_small_charts(report, options, texels_a_chart));
  } else if (asked > 0 && !coarse && texels_a_chart < kHardlyAny) {
    lines.push_back(on_long_texels(report, texels_a_chart));
  }
  if (coarse && (asked > 0 || !is_faithful(report)))
    lines.push_back(on_coarse_texels(report, options));
  else if (loses_detail(report))
    lines.push_back(on_lost_detail(report, options));
  for (std::string& line : advice_on_tone(report, options)) lines.push_back(std::move(line));
  return lines;
}

std::vector<std::string> advice_on_materials(const Scene& scene, Quantity quantity) {
  NamedMaterials open, lamps;
  for (const Material& m : scene.materials) {
    if (is_open(m, scene)) open.add(m);
    if (m.emission != Vec3f{}) lamps.add(m);
  }
  std::vector<std::string> lines;
  if (open.count > 0)
    lines.push_back(fmt::format(
        "{} {} transparent or {} holes: baked pages are opaque (export such parts by themselves "
        "with ExportOptions::charts_only ExportOptions::keep_scene)",
        open.text(), open.count == 1 ? "is" : "are", open.count == 1 ? "has" : "have"));
  if (lamps.count > 0 && quantity == Quantity::illuminance)
    lines.push_back(fmt::format(
        "{} {} light: it is not baked, since its unit need not be that of the vertices, so pages "
        "show such parts as dark as what they reflect (give vertices all light that leaves them "
        "and say ExportOptions::quantity luminance, or export such parts by themselves with "
        "ExportOptions::charts_only "
        "ExportOptions::keep_scene)",
        lamps.text(), lamps.count == 1 ? "emits" : "emit"));
  return lines;
}

std::vector<std::string> advice_on_missing_light(const Scene& scene, const DefectReport& defects,
                                                 const ExportOptions& options) {
  if (scene.illumination.empty() || defects.count(DefectKind::illumination_missing) == 0) return {};
  std::size_t dark = 0;
  for (std::size_t k = 0; k < scene.indices.size(); k += 3)
    dark += std::all_of(&scene.indices[k], &scene.indices[k] + 3,
                        [&](std::uint32_t v) { return scene.illumination[v] == Vec3f{}; });
  if (dark == 0) return {};
  return {fmt::format(
      "{} of {} triangles have no light, which other vertices have, so pages show them black (give "
      "all vertices light; if those colours are paint, ExportOptions::charts_only makes uvs "
      "without light{})",
      dark, scene.triangle_count(),
      options.keep_scene ? " and leaves the colours where they are"
                         : ", and with ExportOptions::keep_scene beside the colours")};
}

}  // namespace atlas
