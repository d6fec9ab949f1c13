#include "libatlas/unwrap/like_mesh.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <optional>
#include <set>
#include <utility>

#include "libatlas/core/is_finite.h"
#include "libatlas/core/no_index.h"
#include "libatlas/pack/beside.h"
#include "libatlas/unwrap/layout_problem.h"
#include "libatlas/unwrap/like/lay_beside.h"
#include "libatlas/unwrap/like/take_uvs.h"

namespace atlas {
namespace {

constexpr std::int32_t kLongestSide = 16384;
// A chart stays if its uvs lie within this many texels of where one similarity puts them.
constexpr double kInPlace = 0.01;

// Where a chart's uvs lie on its page.
struct Similarity {
  double cosine = 1, sine = 0, scale = 0;
  Vec2d offset = {};

  Vec2d operator()(Vec2d uv) const {
    const double c = scale * cosine, s = scale * sine;
    return {offset.x + c * uv.x - s * uv.y, offset.y + s * uv.x + c * uv.y};
  }
};

struct Correspondence {
  Vec2d uv, texel;
};

// The similarity that is nearest in the least squares sense, without a reflection.
Similarity fit_similarity(const std::vector<Correspondence>& pairs) {
  Vec2d uv = {}, texel = {};
  for (const Correspondence& p : pairs) {
    uv = {uv.x + p.uv.x, uv.y + p.uv.y};
    texel = {texel.x + p.texel.x, texel.y + p.texel.y};
  }
  const double n = double(std::max<std::size_t>(1, pairs.size()));
  uv = {uv.x / n, uv.y / n};
  texel = {texel.x / n, texel.y / n};
  double real = 0, imaginary = 0, squares = 0;
  for (const Correspondence& p : pairs) {
    const double x = p.uv.x - uv.x, y = p.uv.y - uv.y, u = p.texel.x - texel.x,
                 v = p.texel.y - texel.y;
    real += x * u + y * v;
    imaginary += x * v - y * u;
    squares += x * x + y * y;
  }
  Similarity fit;
  const double length = std::sqrt(real * real + imaginary * imaginary);
  if (!(squares > 0) || !(length > 0)) return fit;
  fit.scale = length / squares;
  fit.cosine = real / length;
  fit.sine = imaginary / length;
  const Vec2d moved = fit(uv);
  fit.offset = {texel.x - moved.x, texel.y - moved.y};
  return fit;
}

}  // namespace

Status check_earlier(const EarlierUvs& e, const std::string& who) {
  const auto bad = [&](const std::string& text) {
    return Status(ErrorCode::bad_input, who + ": the earlier mesh: " + text);
  };
  const std::size_t triangles = e.indices.size() / 3;
  if (e.indices.size() % 3 != 0 || triangles >= std::size_t{1} << 30)
    return bad(
        fmt::format("{} indices are not whole triangles, fewer than 2^30", e.indices.size()));
  for (std::size_t i = 0; i < e.indices.size(); ++i)
    if (e.indices[i] >= e.positions.size())
      return bad(fmt::format("triangle {}: index {} names none of the {} positions", i / 3,
                             e.indices[i], e.positions.size()));
  for (std::size_t v = 0; v < e.positions.size(); ++v)
    if (!is_finite(e.positions[v])) return bad(fmt::format("position {} is not finite", v));
  if (!e.uv_indices.empty() && e.uv_indices.size() != e.indices.size())
    return bad("uv indices must be empty or 3 a triangle");
  if (!e.triangle_page.empty() && e.triangle_page.size() != triangles)
    return bad("triangle_page must be empty or 1 a triangle");
  if (!e.objects.empty() && e.objects.size() != e.positions.size())
    return bad("objects must be empty or 1 a position");
  if (e.pages.empty()) return bad("it has no page (give the size of each in texels)");
  for (std::size_t p = 0; p < e.pages.size(); ++p) {
    const auto [width, height] = e.pages[p];
    if (width < 1 || height < 1 || std::max(width, height) > kLongestSide)
      return bad(fmt::format("page {} is {} x {} (sides of 1 .. {} texels)", p, width, height,
                             kLongestSide));
  }
  if (!(e.tolerance >= 0 && e.tolerance < 1))
    return {
        ErrorCode::bad_option,
        fmt::format("{}: EarlierUvs::tolerance is {:g} (at least 0, below 1)", who, e.tolerance)};
  return {};
}

LikeMesh::LikeMesh(const MeshView& mesh, const EarlierUvs& earlier, const Options& options)
    : view_(mesh),
      max_stretch_(options.max_stretch),
      pages_(earlier.pages.begin(), earlier.pages.end()) {
  const JoinedMesh joined = join_triangles(mesh.positions, mesh.indices, mesh.objects),
                   before = join_triangles(earlier.positions, earlier.indices, earlier.objects);
  PageGrid grid(earlier.pages, before.triangle_count());
  TakenUvs taken = take_uvs({joined, before, earlier}, grid);
  lay_beside(joined, {earlier.pages, mesh.density, options.max_stretch, double(options.padding)},
             grid, taken);
  const std::size_t n = joined.triangle_count();
  chart_ = std::move(taken.chart);
  chart_triangles_ = std::move(taken.chart_triangles);
  page_.assign(n, 0);
  same_.assign(n, 0);
  texels_.resize(3 * n);
  bool any = false;
  for (std::uint32_t t = 0; t < n; ++t) {
    if (chart_[t] == kNoIndex) continue;
    any = true;
    page_[t] = taken.chart_page[chart_[t]];
    same_[t] = taken.state[t] == TakenState::same;
    std::copy(taken.texels[t].begin(), taken.texels[t].end(), texels_.begin() + 3 * t);
  }
  if (!any)
    nothing_ =
        std::string("nothing of the earlier uvs stays, and all charts are new: ") +
        (taken.with_uvs == 0  ? "there are no usable ones"
         : taken.matched == 0 ? "no triangle lies where one did (another size, unit or place?)"
                              : "the triangles that lie where they lay have no usable ones");
  seams_.assign(3 * n, 0);
  for (std::uint32_t h = 0; h < seams_.size(); ++h) {
    const std::uint32_t o = joined.across[h];
    const bool charts = o != kNoIndex && chart_[h / 3] != kNoIndex && chart_[o / 3] != kNoIndex;
    seams_[h] = (charts && taken.seams[h]) || (!mesh.seams.empty() && mesh.seams[h] != 0);
  }
  write_texcoords(earlier);
}

void LikeMesh::write_texcoords(const EarlierUvs& earlier) {
  aspect_ = double(pages_[0].width) / pages_[0].height;
  const bool one_shape = std::all_of(pages_.begin(), pages_.end(), [&](const Extent& page) {
    return std::int64_t{page.width} * pages_[0].height ==
           std::int64_t{page.height} * pages_[0].width;
  });
  if (!one_shape) aspect_ = 1;
  texcoords_.resize(texels_.size());
  texcoord_indices_.assign(texels_.size(), kNoIndex);
  for (std::uint32_t c = 0; c < texels_.size(); ++c) {
    if (chart_[c / 3] == kNoIndex) continue;
    const Extent page = earlier.pages[page_[c / 3]];
    const Extent unit = one_shape ? page : Extent{kLongestSide, kLongestSide};
    texcoords_[c] = {float(texels_[c].x / unit.width), float(texels_[c].y / unit.height)};
    texcoord_indices_[c] = c;
  }
  view_.texcoords = texcoords_;
  view_.texcoord_indices = texcoord_indices_;
  view_.seams = seams_;
}

ChartOptions LikeMesh::chart_options(const ChartOptions& asked) const {
  ChartOptions options = asked;
  options.keep_uv_charts = true;
  options.uv_aspect = aspect_;
  options.material_uv_aspects.clear();
  return options;
}

// Lays out one set of charts.
class LikeMesh::Keeper {
 public:
  Keeper(const LikeMesh& like, const LayoutOptions& options, ChartSet& charts)
      : like_(like), charts_(charts), options_(options) {
    layout_.outlines = true;
    layout_.placements.resize(charts.charts.size());
    layout_.origins.assign(charts.charts.size(), ChartOrigin::made);
    constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
    layout_.kept_texels.assign(charts.uvs.size(), {kNone, kNone});
  }

  Result<PagesOfParts> run(bool apart, const Context& context) {
    for (std::uint32_t c = 0; c < charts_.charts.size(); ++c) keep(c);
    const double density = area_ > 0 ? std::sqrt(texels_ / area_) : 1;
    PagesOfParts pages;
    if (apart) {
      const PagesOfCharts room{like_.view_, like_.max_stretch_,
                               std::numeric_limits<double>::infinity()};
      const std::vector<Vec2d> densities(charts_.charts.size(), {density, density});
      pages.opened = open_part_gaps(room, densities, charts_, context).charts;
    }
    if (Status s = place_others(density, context); !s.ok()) return s;
    if (apart) pages.left = left_part_gaps(like_.view_, charts_, layout_.placements, context);
    if (context.cancelled()) return Status::cancelled();
    layout_.uv_utilization = uv_utilization(charts_, layout_);
    pages.layout = std::move(layout_);
    return pages;
  }

 private:
  std::span<const std::uint32_t> triangles(std::uint32_t c) const {
    const Chart& chart = charts_.charts[c];
    return std::span(charts_.chart_triangles).subspan(chart.first_triangle, chart.triangle_count);
  }

  // Keeps a chart's place if it has one.
  void keep(std::uint32_t c) {
    if (!charts_.charts[c].kept) return;
    std::optional<Similarity> place = place_of(c);
    if (!place) {
      mirror(c);
      place = place_of(c);
      if (!place) return mirror(c);
    }
    layout_.origins[c] = origin_of(c);
    texels_ += charts_.charts[c].distortion.uv_area * place->scale * place->scale;
    area_ += charts_.charts[c].distortion.uv_area;
    take_place(c, *place);
  }

  // Where the chart lay, if that is a similar shape.
  std::optional<Similarity> place_of(std::uint32_t c) const {
    std::vector<Correspondence> pairs;
    for (const std::uint32_t t : triangles(c)) {
      if (like_.chart_[t] == kNoIndex) continue;
      for (std::uint32_t i = 3 * t; i < 3 * t + 3; ++i)
        pairs.push_back({charts_.uvs[charts_.triangle_uv[i]], like_.texels_[i]});
    }
    const Similarity fit = fit_similarity(pairs);
    const bool in_place = std::all_of(pairs.begin(), pairs.end(), [&](const Correspondence& p) {
      const Vec2d at = fit(p.uv);
      return std::max(std::abs(at.x - p.texel.x), std::abs(at.y - p.texel.y)) <= kInPlace;
    });
    return fit.scale > 0 && in_place ? std::optional(fit) : std::nullopt;
  }

  // Mirrors a chart and turns its triangles: with the uvs of some, triangles that disagree with
  // their neighbours, or all of a program that mirrors charts, run clockwise.
  void mirror(std::uint32_t c) {
    Chart& chart = charts_.charts[c];
    for (std::uint32_t i = chart.first_uv; i < chart.first_uv + chart.uv_count; ++i)
      charts_.uvs[i].x = chart.size.x - charts_.uvs[i].x;
    chart.axis = {-chart.axis.x, -chart.axis.y, -chart.axis.z};
    std::vector<std::uint32_t> turned(triangles(c).begin(), triangles(c).end()), flipped;
    std::sort(turned.begin(), turned.end());
    const std::vector<std::uint32_t>& before = charts_.flipped_triangles;
    std::set_symmetric_difference(before.begin(), before.end(), turned.begin(), turned.end(),
                                  std::back_inserter(flipped));
    charts_.flipped_triangles = std::move(flipped);
  }

  ChartOrigin origin_of(std::uint32_t c) const {
    std::set<std::uint32_t> earlier;
    std::size_t had = 0;
    for (const std::uint32_t t : triangles(c)) {
      if (!like_.same_[t]) return ChartOrigin::repaired;
      if (earlier.insert(like_.chart_[t]).second) had += like_.chart_triangles_[like_.chart_[t]];
    }
    return had == triangles(c).size() ? ChartOrigin::kept : ChartOrigin::repaired;
  }

  void take_place(std::uint32_t c, const Similarity& fit) {
    const Chart& chart = charts_.charts[c];
    const auto all = std::span(layout_.kept_texels).subspan(chart.first_uv, chart.uv_count);
    for (std::size_t i = 0; i < all.size(); ++i) all[i] = fit(charts_.uvs[chart.first_uv + i]);
    for (const std::uint32_t t : triangles(c)) {
      if (like_.chart_[t] == kNoIndex) continue;
      for (std::uint32_t i = 3 * t; i < 3 * t + 3; ++i)
        layout_.kept_texels[charts_.triangle_uv[i]] = like_.texels_[i];
    }
    Vec2d low = all[0], high = all[0];
    for (const Vec2d p : all) {
      low = {std::min(low.x, p.x), std::min(low.y, p.y)};
      high = {std::max(high.x, p.x), std::max(high.y, p.y)};
    }
    ChartPlacement& to = layout_.placements[c];
    to.chart = c;
    to.page = std::int32_t(like_.page_[triangles(c)[0]]);
    to.outlined = true;
    to.x = std::int32_t(std::floor(low.x));
    to.y = std::int32_t(std::floor(low.y));
    to.width = std::int32_t(std::ceil(high.x)) - to.x;
    to.height = std::int32_t(std::ceil(high.y)) - to.y;
    to.texels_per_unit = {fit.scale, fit.scale};
    to.cosine = fit.cosine;
    to.sine = fit.sine;
    to.offset = fit.offset;
  }

  Status place_others(double density, const Context& context) {
    const ChartOutlines outlines(charts_,
                                 std::vector<Vec2d>(charts_.charts.size(), {density, density}));
    std::vector<std::uint32_t> free;
    std::vector<ChartShape> shapes;
    std::vector<TakenShape> taken;
    for (std::uint32_t c = 0; c < charts_.charts.size(); ++c) {
      const Chart& chart = charts_.charts[c];
      if (layout_.origins[c] == ChartOrigin::made) {
        free.push_back(c);
        shapes.push_back(outlines.shapes[c]);
      } else {
        taken.push_back({std::uint32_t(layout_.placements[c].page),
                         {std::span(layout_.kept_texels).subspan(chart.first_uv, chart.uv_count),
                          outlines.shapes[c].triangles}});
      }
    }
    Result<BesideResult> beside = pack_beside(shapes, {like_.pages_, taken}, options_, context);
    if (!beside.ok() && beside.status().code() == ErrorCode::no_solution)
      return {ErrorCode::no_solution, beside.status().message() + " (" + options_.remedy + ")"};
    if (!beside.ok()) return beside.status();
    layout_.pages = std::move(beside->pages);
    for (std::size_t i = 0; i < free.size(); ++i) put(free[i], beside->placements[i], density);
    return {};
  }

  void put(std::uint32_t c, const OutlinePlacement& from, double density) {
    ChartPlacement& to = layout_.placements[c];
    to = outlined_placement(from.box, from.angle, from.offset, options_.padding);
    to.chart = c;
    to.page = std::int32_t(from.page);
    to.texels_per_unit = {density, density};
  }

  const LikeMesh& like_;
  ChartSet& charts_;
  const LayoutOptions& options_;
  PageLayout layout_;
  double texels_ = 0, area_ = 0;  // of the charts that stay, on their pages and as charts
};

Result<PagesOfParts> LikeMesh::lay_out(const LayoutOptions& options, bool apart, ChartSet& charts,
                                       const Context& context) const {
  return Keeper(*this, options, charts).run(apart, context);
}

}  // namespace atlas
