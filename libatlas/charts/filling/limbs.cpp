#include "libatlas/charts/filling/limbs.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <numeric>
#include <utility>

#include "libatlas/charts/filling/limb_cutter.h"
#include "libatlas/charts/flattening/part_of_chart.h"
#include "libatlas/core/hull.h"

namespace atlas {
namespace {

// A chart whose rectangle covers this share of all charts' area determines the page. When charts
// were cut from 0.75 on, six meshes of 178 took up to twice as many charts, though they fill 0.71
// to 0.75 of their pages uncut.
constexpr double kDominant = 1;
constexpr double kPoor = 0.9;  // of min_fill: charts that fill more stay whole
// The least share of their convex hulls that all charts together must fill. With 0.72, two meshes
// of 178 took an eighth more charts and filled 0.01 and 0.02 more of their pages; with 0.66, one
// mesh fell to 0.67.
constexpr double kLeastTogether = 0.68;
// Each further piece must let the hulls shrink by this share of the mean hull: cutting small pieces
// into smaller ones fills no page.
constexpr double kLeastHullFall = 0.1;
// After so many charts in a row that cannot be cut with gain, the others stay whole. They waste
// less, and a lattice, or a scan full of holes, has hundreds of them.
constexpr int kMostInVain = 16;
constexpr double kWasteParts = 4096;  // wastes are rounded to parts of all hulls: nearly equal ones
                                      // tie

double hull_of(const FlatChart& chart) {
  std::vector<Vec2d> points = chart.uvs, hull;
  return hull_area(points, hull);
}

class LimbCharts {
 public:
  LimbCharts(const FlattenInput& input, std::vector<FlatChart>& charts, const Context& context)
      : input_(input), context_(context), charts_(charts), pieces_(charts.size()) {}

  std::size_t run() {
    double hulls = 0;  // an upper bound
    for (const FlatChart& chart : charts_) {
      area_ += chart.distortion.uv_area;
      hulls += std::min(chart.box_area(), bound_shape(chart.uvs).hull);
    }
    for (std::size_t k = 0; k < charts_.size(); ++k) {
      if (charts_[k].box_area() >= kDominant * area_ && !fills_enough(k)) cut(k);
    }
    if (area_ < kLeastTogether * hulls) cut_most_wasteful();
    replace();
    return count_;
  }

 private:
  void cut_most_wasteful() {
    std::vector<double> hull(charts_.size()), waste(charts_.size());
    double hulls = 0;
    for (std::size_t k = 0; k < charts_.size(); ++k) {
      hulls += hull[k] = hulls_of(k);
      waste[k] = hull[k] - charts_[k].distortion.uv_area;
    }
    if (area_ >= kLeastTogether * hulls) return;
    for (double& w : waste) w = std::round(kWasteParts * w / hulls);
    const double mean = hulls / double(charts_.size());
    std::vector<std::size_t> order(charts_.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    std::stable_sort(order.begin(), order.end(),
                     [&](std::size_t a, std::size_t b) { return waste[a] > waste[b]; });
    int in_vain = 0;
    for (const std::size_t k : order) {
      if (area_ >= kLeastTogether * hulls || waste[k] == 0 || context_.cancelled()) return;
      if (!pieces_[k].empty() || fills_enough(k)) continue;
      if (cut_shrinks(k, hull[k], mean)) {
        hulls -= hull[k] - hulls_of(k);
        in_vain = 0;
      } else if (++in_vain == kMostInVain) {
        return;
      }
    }
  }

  // Cuts the chart unless its hull shrinks by too little for the number of pieces.
  bool cut_shrinks(std::size_t k, double hull, double mean) {
    if (!cut(k)) return false;
    if (hull - hulls_of(k) >= kLeastHullFall * mean * double(pieces_[k].size() - 1)) return true;
    pieces_[k].clear();
    --count_;
    return false;
  }

  double hulls_of(std::size_t k) const {
    if (pieces_[k].empty()) return hull_of(charts_[k]);
    double sum = 0;
    for (const FlatChart& piece : pieces_[k]) sum += hull_of(piece);
    return sum;
  }

  bool fills_enough(std::size_t k) const {
    const FlatChart& chart = charts_[k];
    return chart.distortion.uv_area >= kPoor * input_.options.min_fill * chart.box_area();
  }

  // Fills pieces_[k] and returns true if cutting the chart pays.
  bool cut(std::size_t k) {
    const FlatChart& chart = charts_[k];
    const LimbLimits limits{input_.options.min_fill, area_, input_.topology.polygon};
    std::vector<FlatChart> pieces;
    for (const std::vector<std::uint32_t>& limb : limbs_of(chart, limits, context_)) {
      // A cut along a ragged border may leave a triangle unconnected to its limb.
      for (const std::vector<std::uint32_t>& triangles : connected_parts(chart, limb)) {
        pieces.push_back(part_of_chart(input_, chart, triangles));
        const Distortion& d = pieces.back().distortion;
        if (d.stretch_999 > input_.options.max_stretch || d.flips > 0) return false;
      }
    }
    if (pieces.empty()) return false;
    pieces_[k] = std::move(pieces);
    ++count_;
    return true;
  }

  // Replaces cut charts by their pieces.
  void replace() {
    if (count_ == 0) return;
    std::vector<FlatChart> all;
    for (std::size_t k = 0; k < charts_.size(); ++k) {
      if (pieces_[k].empty()) {
        all.push_back(std::move(charts_[k]));
      } else {
        std::move(pieces_[k].begin(), pieces_[k].end(), std::back_inserter(all));
      }
    }
    charts_ = std::move(all);
  }

  const FlattenInput& input_;
  const Context& context_;
  std::vector<FlatChart>& charts_;
  double area_ = 0;                             // of all charts
  std::vector<std::vector<FlatChart>> pieces_;  // of each chart; empty: the chart is whole
  std::size_t count_ = 0;                       // number of charts cut
};

}  // namespace

std::size_t cut_limbs(const FlattenInput& input, std::vector<FlatChart>& charts,
                      const Context& context) {
  if (input.options.min_fill <= 0) return 0;
  return LimbCharts(input, charts, context).run();
}

}  // namespace atlas
