#include "libatlas/unwrap/unwrap.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <string>
#include <unordered_map>
#include <utility>

#include "libatlas/charts/charted_mesh.h"
#include "libatlas/charts/mesh/welded_mesh.h"
#include "libatlas/core/is_enumerator.h"
#include "libatlas/core/no_index.h"
#include "libatlas/unwrap/check_pages.h"
#include "libatlas/unwrap/fill_pages.h"
#include "libatlas/unwrap/like_mesh.h"
#include "libatlas/unwrap/own_scales.h"
#include "libatlas/unwrap/part_gaps.h"
#include "libatlas/unwrap/place_charts.h"
#include "libatlas/uvs/finish_uvs.h"

namespace atlas {

std::int32_t padding_of(const UnwrapOptions& options) {
  if (options.mip_levels == 0) return options.padding;
  return std::max(options.padding, gutter_pad(options.mip_levels));
}

std::int32_t alignment_of(const UnwrapOptions& options) {
  return std::lcm(options.alignment, 1 << options.mip_levels);
}

Status check_options(const UnwrapOptions& options) {
  const auto bad = [](std::string text) {
    return Status(ErrorCode::bad_option, "unwrap: " + std::move(text));
  };
  if (Status s = check_pages("unwrap", options); !s.ok()) return s;
  if (options.mip_levels < 0 || options.mip_levels > 10)
    return bad(fmt::format("mip_levels is {} (0 to 10)", options.mip_levels));
  if (alignment_of(options) > options.page_size / 4 || padding_of(options) > options.page_size / 4)
    return bad(fmt::format(
        "mip_levels is {}, whose cells of {} texels are more than a quarter of page_size",
        options.mip_levels, alignment_of(options)));
  if (!(options.texels_per_unit >= 0) || !std::isfinite(options.texels_per_unit))
    return bad(fmt::format("texels_per_unit is {} (a number above 0, or 0 for as many as fit)",
                           options.texels_per_unit));
  if (!is_enumerator(options.preset, PackPreset::best))
    return bad(fmt::format("preset is {} (give a PackPreset)", int(options.preset)));
  if (options.like && options.charts.keep_uv_charts)
    return bad("like and keep_uv_charts are given both (give one of them)");
  return options.like ? check_earlier(*options.like, "unwrap") : Status();
}

namespace {

LayoutOptions layout_options(const UnwrapOptions& options) {
  LayoutOptions layout{options};
  layout.padding = padding_of(options);
  layout.alignment = alignment_of(options);
  layout.minimum_side = 0;
  layout.outlines = true;
  layout.remedy = "ask for more pages, a larger page_size, less padding or fewer mip_levels";
  layout.free_aspect = options.pages == 1 && !options.square;
  return layout;
}

Result<PagesOfParts> lay_out(const MeshView& mesh, const UnwrapOptions& options, ChartSet& charts,
                             const Context& context) {
  const double texels = double(options.pages) * options.page_size * options.page_size;
  // A density above what full pages hold is lowered to that, which also keeps sizes in texels
  // finite.
  const double filling = filling_density(charts, texels);
  const double density =
      options.texels_per_unit > 0 ? std::min(options.texels_per_unit, filling) : filling;
  const LayoutOptions layout = layout_options(options);
  const PlainUvs uvs{mesh, options.charts, density, options.texels_per_unit > 0};
  if (options.part_gaps) return fill_pages_apart(uvs, layout, charts, context);
  Result<PageLayout> filled = fill_pages(uvs, layout, charts, context);
  if (!filled.ok()) return filled.status();
  return PagesOfParts{std::move(*filled), 0, {}};
}

// Makes one vertex for each pair of an input vertex and a uv that some corner names, in the order
// of the corners. A uv seldom has more than one vertex. It has several if several input vertices
// lie at its place, and thousands if it is the hub of a fan in a triangle soup.
void join_corners(std::span<const std::uint32_t> indices, std::span<const Vec2f> uvs,
                  UnwrappedMesh& mesh) {
  std::vector<std::uint32_t> first(uvs.size(), kNoIndex);
  std::unordered_map<std::uint64_t, std::uint32_t> others;  // by uv and input vertex
  mesh.indices.resize(indices.size());
  for (std::size_t i = 0; i < indices.size(); ++i) {
    const std::uint32_t uv = mesh.charts.triangle_uv[i],
                        added = std::uint32_t(mesh.vertices.size());
    std::uint32_t& v =
        first[uv] == kNoIndex || mesh.vertices[first[uv]] == indices[i]
            ? first[uv]
            : others.try_emplace(std::uint64_t{uv} << 32 | indices[i], kNoIndex).first->second;
    if (v == kNoIndex) {
      v = added;
      mesh.vertices.push_back(indices[i]);
      mesh.uvs.push_back(uvs[uv]);
    }
    mesh.indices[i] = v;
  }
}

}  // namespace

UnwrapOptions lightmap_options(double texels_per_metre, double metres_per_unit) {
  UnwrapOptions options;
  options.texels_per_unit = texels_per_metre * metres_per_unit;
  options.mip_levels = 2;
  options.padding = gutter_pad(options.mip_levels) + 1;
  options.square = true;
  options.part_gaps = true;
  return options;
}

namespace {

// The common density of charts, or the mean one by area where charts keep theirs.
double mean_density(const ChartSet& charts, const PageLayout& layout) {
  if (layout.kept_texels.empty()) return common_density(layout);
  double texels = 0, area = 0;
  for (const ChartPlacement& p : layout.placements) {
    const double own = charts.charts[p.chart].distortion.uv_area;
    texels += own * p.texels_per_unit.x * p.texels_per_unit.y;
    area += own;
  }
  return area > 0 ? std::sqrt(texels / area) : 1;
}

// Finishes the uvs of charts that have their places.
Result<UnwrappedMesh> finish(const MeshView& mesh, ChartSet charts, PagesOfParts laid,
                             const UnwrapOptions& options, const Context& context) {
  PageLayout& layout = laid.layout;
  if (!layout.own_scales.empty()) context.say(own_scales_text(charts, layout));
  UnwrappedMesh result;
  result.charts = std::move(charts);
  result.pages = std::move(layout.pages);
  result.utilization = layout.uv_utilization;
  result.texels_per_unit = mean_density(result.charts, layout);
  result.gaps = laid.left;
  result.gaps.charts = laid.opened;
  const ChartedMesh charted(mesh.indices, result.charts);
  FinishedUvs finished =
      finish_uvs({result.charts, layout.placements, result.pages, layout.kept_texels},
                 charted.view().uv_indices, {false, options.mip_levels, options.padding}, context);
  result.thin_triangles = finished.thin_triangles;
  if (result.thin_triangles > 0)
    context.say(fmt::format("{} slivers have no area or are turned over in uvs rounded to floats",
                            result.thin_triangles));
  result.texels_drawn_twice = finished.texels_drawn_twice;
  result.placements = std::move(finished.placements);
  join_corners(mesh.indices, finished.uvs, result);
  result.triangle_page.reserve(result.charts.triangle_chart.size());
  for (const std::uint32_t chart : result.charts.triangle_chart)
    result.triangle_page.push_back(std::uint32_t(result.placements[chart].page));
  result.origins = std::move(layout.origins);
  if (context.cancelled()) return Status::cancelled();
  return result;
}

Result<UnwrappedMesh> unwrap_like(const LikeMesh& like, const UnwrapOptions& options,
                                  const Context& context) {
  const MeshView mesh = like.view();
  Result<ChartSet> charts = make_charts(mesh, like.chart_options(options.charts), context);
  if (!charts.ok()) return charts.status();
  Result<PagesOfParts> laid =
      like.lay_out(layout_options(options), options.part_gaps, *charts, context);
  if (!laid.ok()) return laid.status();
  return finish(mesh, std::move(*charts), std::move(*laid), options, context);
}

}  // namespace

EarlierUvs earlier_uvs(const MeshView& mesh, const UnwrappedMesh& unwrapped) {
  return {mesh.positions,          mesh.indices,    unwrapped.uvs, unwrapped.indices,
          unwrapped.triangle_page, unwrapped.pages, mesh.objects};
}

Result<UnwrappedMesh> place_charts(const MeshView& mesh, ChartSet charts,
                                   const UnwrapOptions& options, const Context& context) {
  Result<PagesOfParts> laid = lay_out(mesh, options, charts, context);
  if (!laid.ok()) return laid.status();
  return finish(mesh, std::move(charts), std::move(*laid), options, context);
}

Result<UnwrappedMesh> unwrap_mesh(const MeshView& mesh, const UnwrapOptions& options,
                                  const Context& context) {
  if (Status s = check_options(options); !s.ok()) return s;
  if (options.like) {
    if (const Status s = weld_mesh(mesh).status(); !s.ok()) return s;
    const LikeMesh like(mesh, *options.like, {options.charts.max_stretch, padding_of(options)});
    if (like.nothing().empty()) return unwrap_like(like, options, context);
    context.say(like.nothing());
  }
  MeshView view = mesh;
  if (view.texcoord_indices.empty() && view.texcoords.size() == view.positions.size())
    view.texcoord_indices = view.indices;
  Result<ChartSet> charts = make_charts(view, options.charts, context);
  if (!charts.ok()) return charts.status();
  return place_charts(view, std::move(*charts), options, context);
}

}  // namespace atlas
