#include "libatlas/pipeline/suit_pages.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <span>
#include <utility>

#include "libatlas/charts/tiles.h"
#include "libatlas/pack/fit.h"
#include "libatlas/unwrap/layout_problem.h"

namespace atlas {
namespace {

// Boxes that take more of the pages than this are left alone.
constexpr double kFilled = 0.75;
// The share of the pages by which the scale that pieces may reach is estimated.
constexpr double kFullPages = 0.9;
// How long pieces may be, in the order tried, as shares of a page's side at that scale.
constexpr std::array kLongestShares{1.0 / 3, 1.0 / 4, 1.0 / 5};
// Charts longer than the smallest of these are large. They are to blame if they have at least this
// share of all texels. Boxes tell nothing about charts that cover less than kRectangular of theirs.
constexpr double kMostTexels = 0.5, kRectangular = 0.9;
// Pieces are worth it if the scale grows by kLeastGain, and by kSeamPrice for each square root of
// the surface's area by which seams become longer. A seam between pieces costs vertices and
// gutters, and the gutters are part of the scale.
constexpr double kLeastGain = 0.04, kSeamPrice = 0.005;

struct BoxFit {
  double scale = 0, filled = 0;  // 0 if there is no room
};

BoxFit fit_boxes(std::span<const FitItem> items, const LayoutOptions& options,
                 const Context& context) {
  FitOptions fit = box_fit_options(options);
  fit.preset = PackPreset::standard;  // it is an estimate, whatever effort the pages are worth
  const Result<FitResult> fitted = fit_pages(items, fit, context);
  return fitted.ok() ? BoxFit{fitted->scale, fitted->utilization} : BoxFit{};
}

std::vector<FitItem> boxes_of(const SizedCharts& sized) {
  std::vector<FitItem> boxes;
  for (std::size_t c = 0; c < sized.densities.size(); ++c)
    boxes.push_back(chart_box(sized.charts.charts[c], sized.densities[c]));
  return boxes;
}

constexpr double kUnlimited = std::numeric_limits<double>::infinity();

// A piece may be turned against its chart, so the densities of both directions must be the same.
// Only those of charts of one colour differ, which are small.
bool may_cut(Vec2d density) {
  return density.x == density.y;
}

// The boxes of pieces, and by how much seams become longer, in scene units.
struct Pieces {
  std::vector<FitItem> boxes;
  double seams = 0;
};

// Divides boxes evenly, as cut_to_limits() divides rectangles, so that no side has more texels than
// `longest`.
Pieces divide(const SizedCharts& sized, double longest) {
  Pieces pieces;
  for (std::size_t c = 0; c < sized.densities.size(); ++c) {
    const Chart& chart = sized.charts.charts[c];
    const FitItem box = chart_box(chart, sized.densities[c]);
    const double side = may_cut(sized.densities[c]) ? longest : kUnlimited;
    const double columns = std::max(1.0, std::ceil(box.width / side));
    const double rows = std::max(1.0, std::ceil(box.height / side));
    pieces.boxes.insert(pieces.boxes.end(), std::size_t(columns * rows),
                        {box.width / columns, box.height / rows});
    pieces.seams += (columns - 1) * chart.size.y + (rows - 1) * chart.size.x;
  }
  return pieces;
}

// What decides whether and how charts are cut. Texels are those at scale 1.
struct Problem {
  const LayoutOptions& options;
  double scale = 1;  // that pieces may reach
  double area = 0;   // of the charts, texels
  double boxes = 0;  // of their boxes

  Problem(const SizedCharts& sized, std::span<const FitItem> items, const LayoutOptions& layout)
      : options(layout) {
    for (std::size_t c = 0; c < items.size(); ++c) {
      const Vec2d density = sized.densities[c];
      area += sized.charts.charts[c].distortion.uv_area * density.x * density.y;
      boxes += items[c].width * items[c].height;
    }
    const double room = double(options.pages) * options.page_size * options.page_size;
    if (area > 0) scale = std::min(1.0, std::sqrt(kFullPages * room / area));
  }

  // The longest side of pieces of which 1 / share lie side by side on a page, with their gutters.
  double longest(double share) const {
    const double texels = share * options.page_size - 2 * options.padding - options.alignment;
    return std::max(1.0, texels) / scale;
  }

  bool large_are_to_blame(std::span<const FitItem> items) const {
    double large = 0;
    for (const FitItem& item : items) {
      if (std::max(item.width, item.height) > longest(kLongestShares.back()))
        large += item.width * item.height;
    }
    return area >= kRectangular * boxes && large >= kMostTexels * boxes;
  }
};

// Returns the longest side of pieces that are worth their seams, or 0 if none are.
double best_longest(const SizedCharts& sized, const Problem& problem,
                    const std::vector<FitItem>& whole, const Context& context) {
  BoxFit best = fit_boxes(whole, problem.options, context);
  if (!(best.scale > 0 && best.scale < problem.scale) || best.filled >= kFilled) return 0;
  const double root_area = std::sqrt(sized.charts.surface_area);
  double longest = 0, seams = 0;
  for (const double share : kLongestShares) {
    // Sides as short as the shortest would not shrink with the scale.
    if (problem.longest(share) * problem.scale <= problem.options.minimum_side) break;
    const Pieces pieces = divide(sized, problem.longest(share));
    const BoxFit fit = fit_boxes(pieces.boxes, problem.options, context);
    const double gain = std::max(kLeastGain, kSeamPrice * (pieces.seams - seams) / root_area);
    if (fit.scale < (1 + gain) * best.scale) continue;
    best = fit;
    longest = problem.longest(share);
    seams = pieces.seams;
  }
  return longest;
}

// Charts in pieces, with the densities of the charts that they are pieces of.
Result<std::size_t> cut(const SuitPagesOptions& suit, double longest, SizedCharts& sized,
                        const Context& context) {
  std::vector<double> limits;
  for (const Vec2d& density : sized.densities)
    limits.push_back(may_cut(density) ? longest / density.x : kUnlimited);
  const std::vector<std::uint32_t> chart_before = sized.charts.triangle_chart;
  Result<std::size_t> count =
      cut_to_limits(suit.mesh, {limits, suit.max_stretch}, sized.charts, context);
  if (!count.ok()) return count;
  const SizedCharts whole{{}, std::move(sized.densities), std::move(sized.full_densities)};
  sized.densities.clear();
  sized.full_densities.clear();
  for (const Chart& piece : sized.charts.charts) {
    const std::uint32_t parent = chart_before[sized.charts.chart_triangles[piece.first_triangle]];
    sized.densities.push_back(whole.densities[parent]);
    sized.full_densities.push_back(whole.full_densities[parent]);
  }
  return count;
}

}  // namespace

Result<std::size_t> suit_pages(const SuitPagesOptions& suit, const LayoutOptions& options,
                               SizedCharts& sized, const Context& caller) {
  Context context = caller;
  context.progress = {};  // the layouts below are few and quick beside that of the charts
  const std::vector<FitItem> whole = boxes_of(sized);
  const Problem problem(sized, whole, options);
  if (!problem.large_are_to_blame(whole)) return std::size_t{0};
  const double longest = best_longest(sized, problem, whole, context);
  if (context.cancelled()) return Status::cancelled();
  if (longest == 0) return std::size_t{0};
  SizedCharts pieces = sized;
  const Result<std::size_t> count = cut(suit, longest, pieces, context);
  if (!count.ok()) return count;
  // Triangles may be too large for the cuts that were planned.
  const double before = fit_boxes(whole, options, context).scale;
  if (fit_boxes(boxes_of(pieces), options, context).scale < (1 + kLeastGain) * before)
    return std::size_t{0};
  sized = std::move(pieces);
  return count;
}

}  // namespace atlas
