#include "libatlas/charts/flattening/relieve.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <utility>

#include "libatlas/charts/flattening/chart_job.h"
#include "libatlas/charts/flattening/split.h"
#include "libatlas/charts/merging/merge_options.h"
#include "libatlas/charts/mesh/border_weight.h"
#include "libatlas/core/degrees.h"
#include "libatlas/core/parallel.h"
#include "libatlas/param/distortion.h"

namespace atlas {
namespace {

// The least energy of charts that are tried, relative to the worth of a seam as long as the square
// root of the piece's area, times the chart's share of the piece's triangles, times the square root
// of their number.
constexpr double kLeastEnergy = 0.04;

constexpr int kMostDarts = 3;
// A tip is searched for in the most stretched triangles that together have this share of the
// energy.
constexpr double kStretchedPart = 0.5;

class Reliever {
 public:
  Reliever(const FlattenInput& input, Partition& partition, std::vector<FlatChart>& charts)
      : input_(input),
        topology_(input.topology),
        partition_(partition),
        charts_(charts),
        seam_worth_(merge_options(input.options.max_stretch).seam_worth),
        crease_angle_(radians(input.options.crease_degrees)),
        chart_area_(charts.size(), 0),
        piece_area_(topology_.component_count, 0),
        piece_triangles_(topology_.component_count, 0) {}

  void run(const Context& context) {
    auto& label = partition_.chart;
    for (std::uint32_t k = 0; k < charts_.size(); ++k) {
      for (const std::uint32_t t : charts_[k].triangles) {
        label[t] = k;
        chart_area_[k] += topology_.areas[t];
      }
      piece_area_[charts_[k].piece(topology_)] += chart_area_[k];
      piece_triangles_[charts_[k].piece(topology_)] += double(charts_[k].triangles.size());
    }
    const std::size_t grain = std::max<std::size_t>(4, charts_.size() / 64);
    parallel_for(context, charts_.size(), grain, [&](std::size_t begin, std::size_t end) {
      ChartScratch scratch;
      for (std::size_t k = begin; k < end && !context.cancelled(); ++k) {
        const double least = least_energy(charts_[k]);
        for (int i = 0; i < kMostDarts && energy(k, charts_[k]) > least; ++i) {
          if (!relieve(k, scratch)) break;
        }
      }
    });
  }

 private:
  using Dart = std::vector<std::uint32_t>;  // half-edges of the topology, both sides

  // The stretch energy of chart k as it is flattened in `flat`: its area times (L2 stretch squared
  // - 1). Like the price of a dart, it does not depend on the density.
  double energy(std::size_t k, const FlatChart& flat) const {
    return chart_area_[k] * flat.excess();
  }

  // Charts with less energy are not worth trying, which takes time in proportion to their
  // triangles.
  double least_energy(const FlatChart& chart) const {
    const std::uint32_t p = chart.piece(topology_);
    return kLeastEnergy * seam_worth_ * piece_area_[p] * double(chart.triangles.size()) /
           std::sqrt(piece_triangles_[p]);
  }

  // Cuts a dart. Returns false if it is not worth its seam.
  bool relieve(std::size_t k, ChartScratch& scratch) {
    FlatChart& chart = charts_[k];
    const double energy_before = energy(k, chart);
    const Dart dart = dart_for(chart, scratch.chart);
    const double price = price_of(dart, piece_area_[chart.piece(topology_)]);
    if (dart.empty() || price >= energy_before) return false;
    for (const std::uint32_t h : dart) partition_.cut(h);
    ChartOutcome outcome = flatten_chart(
        input_, partition_, {.triangles = chart.triangles, .cuts = 0, .whole = true}, scratch);
    if (!outcome.parts.empty() || energy(k, outcome.flat) + price >= energy_before) {
      for (const std::uint32_t h : dart) partition_.close(h);
      return false;
    }
    outcome.flat.triangles = std::move(chart.triangles);
    outcome.flat.fragment = chart.fragment;
    chart = std::move(outcome.flat);
    return true;
  }

  Dart dart_for(const FlatChart& chart, LocalChart& local) {
    local.build(topology_, partition_, chart.triangles);
    local.take_density(input_.density);
    Dart dart;
    if (local.corners != chart.corners) return dart;  // a seam was closed since
    for (const std::uint32_t h : way_to_tip(topology_, local, most_stretched(chart, local))) {
      for (const std::uint32_t side : {h, local.opposite[h]})
        dart.push_back(3 * local.triangles()[side / 3] + side % 3);
    }
    return dart;
  }

  // Returns indices into the chart's triangle list.
  std::vector<std::uint32_t> most_stretched(const FlatChart& chart, const LocalChart& local) const {
    const LocalMesh mesh = local.mesh();
    std::vector<TriangleStretch> stretch(chart.corners.size());
    measure_triangles(mesh, chart.uvs, stretch);
    double area = 0, uv_area = 0;
    for (const TriangleStretch& t : stretch) {
      area += t.area;
      uv_area += t.uv_area;
    }
    std::vector<std::pair<double, std::uint32_t>> order;  // minus the energy; index
    double all = 0;
    for (std::uint32_t i = 0; i < stretch.size(); ++i) {
      const double s1 = stretch[i].s1, s2 = stretch[i].s2;
      const double own = stretch[i].area * (0.5 * (s1 * s1 + s2 * s2) * uv_area / area - 1);
      order.emplace_back(-own, i);
      all += std::max(own, 0.0);
    }
    std::sort(order.begin(), order.end());
    std::vector<std::uint32_t> places;
    double sum = 0;
    for (const auto& [minus, place] : order) {
      if (sum > kStretchedPart * all) break;
      sum -= minus;
      places.push_back(place);
    }
    return places;
  }

  double price_of(const Dart& dart, double piece_area) const {
    double weight = 0;
    for (std::size_t i = 0; i < dart.size(); i += 2)
      weight += border_weight(topology_, dart[i], crease_angle_);
    return seam_worth_ * weight * std::sqrt(piece_area);
  }

  const FlattenInput& input_;
  const Topology& topology_;
  Partition& partition_;
  std::vector<FlatChart>& charts_;
  double seam_worth_, crease_angle_;
  std::vector<double> chart_area_, piece_area_, piece_triangles_;
};

}  // namespace

void relieve_charts(const FlattenInput& input, Partition& partition, std::vector<FlatChart>& charts,
                    const Context& context) {
  const ChartOptions& options = input.options;
  if (options.preset == ChartPreset::fast || options.cone_degrees > 0) return;
  if (!input.topology.calm_normals.empty()) return;
  Reliever(input, partition, charts).run(context);
}

}  // namespace atlas
