#include "libatlas/pipeline/layout_options.h"

#include <algorithm>

#include "libatlas/pipeline/lightmap.h"

namespace atlas {
namespace {

// Returns the largest side of a page for plain uvs.
std::int32_t plain_page_size(const ChartSet& charts, const ExportOptions& options) {
  constexpr double kTexelsAChart = 1024, kExpectedFill = 0.75;
  constexpr std::int32_t kLargestSide = 16384;
  if (!options.larger_plain_page || options.plain_pages > 1) return options.atlas_size;
  if (options.texel_metres > 0) return kLargestSide;  // packing takes what the density needs
  // A page that is as long as its longest chart is less wide than long if the other charts do not
  // fill more. For a square page, charts are cut instead.
  double longest = 0, area = 0;
  for (const Chart& chart : charts.charts) {
    longest = std::max(longest, chart.size.x);
    area += chart.distortion.uv_area;
  }
  const double filled =
      options.square_plain_page || options.udim ? 1 : area / (kExpectedFill * longest * longest);
  const double width = std::min(1.0, filled);
  const double wanted = kTexelsAChart * double(charts.charts.size());
  std::int32_t side = options.atlas_size;
  while (side < kLargestSide && width * side * side < wanted) side *= 2;
  return side;
}

}  // namespace

LayoutOptions layout_options(const ChartSet& charts, const ExportOptions& options, bool bake) {
  LayoutOptions layout;
  layout.preset = options.packing;
  layout.time_budget = options.time_budget;
  layout.outlines = options.outlines;
  layout.remedy = "give " + more_room(options, bake);
  if (bake) {
    layout.pages = options.atlases;
    layout.page_size = options.atlas_size;
    layout.padding = gutter_pad(options.mip_levels);
    layout.alignment = 1 << options.mip_levels;
    layout.minimum_side = options.min_side;
    // Pages of one shape need one line that says it (scene/uv_page.h); they may share an array.
    layout.square = options.keep_scene && options.atlases > 1;
    layout.remedy += ", or a lower ExportOptions::min_side or ExportOptions::mip_levels";
  } else {
    layout.pages = options.plain_pages;
    layout.page_size = plain_page_size(charts, options);
    layout.padding = plain_padding(options);
    layout.alignment = 1 << options.plain_mip_levels;
    layout.minimum_side = 0;
    if (options.plain_mip_levels > 0)
      layout.remedy += ", or a lower ExportOptions::plain_mip_levels";
    layout.square = options.square_plain_page || options.plain_pages > 1 || options.udim;
    layout.free_aspect = !layout.square;
  }
  return layout;
}

std::int32_t plain_padding(const ExportOptions& options) {
  return std::max(options.plain_padding, gutter_pad(options.plain_mip_levels));
}

std::string more_room(const ExportOptions& options, bool bake, const std::string& other) {
  const bool several = holds_pages(options, bake);
  const std::string more = several ? "more ExportOptions::atlases" : "";
  const std::string joint = !several ? "" : other.empty() ? " or " : ", ";
  const std::string larger = more + joint + "a larger ExportOptions::atlas_size";
  return other.empty() ? larger : larger + " or " + other;
}

}  // namespace atlas
