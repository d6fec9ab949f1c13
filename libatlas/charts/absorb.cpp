#include "libatlas/charts/absorb.h"

#include <algorithm>
#include <cmath>
#include <queue>

#include "libatlas/core/glm_bridge.h"

namespace atlas {
namespace {

constexpr int kCuts = 1;
// What a union costs is bounded: by the neighbours tried for a fragment, and by the triangles of
// all unions as a multiple of the mesh's, which keeps the time linear.
struct Patience {
  std::size_t neighbours;
  double work, fill;  // fill: of its rectangle by a union, or as much as the sparser part
};
constexpr Patience kSmooth{2, 0.25, 0.45};
// Scan noise divides charts that need not be divided: a work of 2.5 left armadillo with 55 to 69
// charts for 42 smooth ones, 6 leaves 41 to 49.
constexpr Patience kNoisy{4, 6, 0.45};
constexpr Patience kInCone{6, 3, 0.3};  // a limit on cones leaves many small charts, cheap to try
constexpr double kSmallShare = 0.01;    // of the triangles, what is tried on smooth meshes
constexpr double kMostL2 = 1.01;        // of a union's stretch, as when cells are merged

class Absorber {
 public:
  Absorber(const AbsorbInput& input, std::vector<FlatChart>& charts)
      : input_(input),
        topology_(input.flatten.topology),
        charts_(charts),
        patience_(input.flatten.options.cone_degrees > 0 ? kInCone
                  : topology_.calm_normals.empty()       ? kSmooth
                                                         : kNoisy),
        work_(patience_.work * double(topology_.triangle_count())) {
    auto& label = input_.partition.chart;
    for (std::uint32_t k = 0; k < charts_.size(); ++k) {
      for (const std::uint32_t t : charts_[k].triangles) label[t] = k;
    }
  }

  void run(const Context& context) {
    using Entry = std::pair<std::size_t, std::uint32_t>;
    std::priority_queue<Entry, std::vector<Entry>, std::greater<>> queue;
    for (std::uint32_t k = 0; k < charts_.size(); ++k) {
      if (charts_[k].fragment && worth_a_try(charts_[k]))
        queue.push({charts_[k].triangles.size(), k});
    }
    while (!queue.empty() && !context.cancelled() && work_ > 0) {
      const auto [size, k] = queue.top();
      queue.pop();
      if (charts_[k].triangles.size() != size) continue;  // it has changed since
      const std::uint32_t into = absorb(k);
      if (into != kNoIndex && charts_[into].fragment) {
        queue.push({charts_[into].triangles.size(), into});
      }
    }
    std::erase_if(charts_, [](const FlatChart& chart) { return chart.triangles.empty(); });
  }

 private:
  struct Neighbour {
    std::uint32_t chart;
    double border;
  };

  bool worth_a_try(const FlatChart& chart) const {
    return !topology_.calm_normals.empty() ||
           double(chart.triangles.size()) <= kSmallShare * double(topology_.triangle_count());
  }

  std::uint32_t absorb(std::uint32_t k) {
    std::vector<Neighbour> neighbours = find_neighbours(k);
    for (std::size_t i = 0; i < std::min(neighbours.size(), patience_.neighbours); ++i) {
      if (join(k, neighbours[i].chart)) return neighbours[i].chart;
    }
    return kNoIndex;
  }

  std::vector<Neighbour> find_neighbours(std::uint32_t k) const {
    std::vector<Neighbour> all, merged;
    each_border(k, [&](std::uint32_t h, std::uint32_t other) {
      all.push_back({other, edge_length(topology_, h)});
    });
    std::stable_sort(all.begin(), all.end(),
                     [](const Neighbour& a, const Neighbour& b) { return a.chart < b.chart; });
    for (const Neighbour& n : all) {
      if (merged.empty() || merged.back().chart != n.chart) merged.push_back({n.chart, 0});
      merged.back().border += n.border;
    }
    std::stable_sort(merged.begin(), merged.end(),
                     [](const Neighbour& a, const Neighbour& b) { return a.border > b.border; });
    return merged;
  }

  template <class Body>
  void each_border(std::uint32_t k, Body&& body) const {
    for (const std::uint32_t t : charts_[k].triangles) {
      for (std::uint32_t h = 3 * t; h < 3 * t + 3; ++h) {
        const std::uint32_t o = topology_.opposite[h];
        if (o != kNoIndex && input_.partition.chart[o / 3] != k) {
          body(h, input_.partition.chart[o / 3]);
        }
      }
    }
  }

  bool may_fit_cone(const FlatChart& a, const FlatChart& b) const {
    const double limit = input_.flatten.options.cone_degrees * M_PI / 180;
    if (limit <= 0) return true;
    const double between =
        std::acos(std::clamp(glm::dot(to_dvec(a.cone.axis), to_dvec(b.cone.axis)), -1.0, 1.0));
    return between <= 2 * limit && std::max(a.cone.angle, b.cone.angle) <= limit;
  }

  bool join(std::uint32_t k, std::uint32_t into) {
    FlatChart &a = charts_[k], &b = charts_[into];
    if (!may_fit_cone(a, b)) return false;
    work_ -= double(a.triangles.size() + b.triangles.size());
    std::vector<std::uint8_t> seams;
    for (const FlatChart* chart : {&a, &b}) {
      for (const std::uint32_t t : chart->triangles) seams.push_back(input_.partition.seams[t]);
    }
    turn_frames(k, into);
    for (const std::uint32_t t : a.triangles) input_.partition.chart[t] = into;
    std::vector<std::uint32_t> both(a.triangles.size() + b.triangles.size());
    std::merge(a.triangles.begin(), a.triangles.end(), b.triangles.begin(), b.triangles.end(),
               both.begin());
    ChartOutcome outcome =
        flatten_chart(input_.flatten, input_.partition, both,
                      {.cuts = topology_.calm_normals.empty() ? 0 : kCuts}, input_.scratch);
    const bool flat = outcome.parts.empty() && outcome.flat.distortion.stretch_l2 <= kMostL2;
    if (flat && fill(outcome.flat) >= std::min({patience_.fill, fill(a), fill(b)})) {
      outcome.flat.triangles = std::move(both);
      outcome.flat.fragment = a.fragment && b.fragment;
      b = std::move(outcome.flat);
      a = FlatChart{};
      return true;
    }
    for (const std::uint32_t t : a.triangles) input_.partition.chart[t] = k;
    std::size_t i = 0;
    for (const FlatChart* chart : {&a, &b}) {
      for (const std::uint32_t t : chart->triangles) input_.partition.seams[t] = seams[i++];
    }
    return false;
  }

  static double fill(const FlatChart& chart) {
    const double box = chart.size.x * chart.size.y;
    return box > 0 ? chart.distortion.uv_area / box : 1;
  }

  // Turns the frames of one chart so that they continue those of the other across their border.
  void turn_frames(std::uint32_t k, std::uint32_t into) {
    Frames& frames = input_.flatten.frames;
    if (frames.empty()) return;
    double c = 0, s = 0;
    each_border(k, [&](std::uint32_t h, std::uint32_t other) {
      if (other != into) return;
      const std::uint32_t t = h / 3, o = topology_.opposite[h] / 3;
      const auto wanted = carry_frame(topology_, frames[o], o, t);
      const double length = edge_length(topology_, h);
      const glm::dvec3 u = to_dvec(wanted[0]);
      c += length * glm::dot(to_dvec(frames[t][0]), u);
      s += length * glm::dot(to_dvec(frames[t][1]), u);
    });
    const double norm = std::sqrt(c * c + s * s);
    if (!(norm > 0)) return;
    c /= norm;
    s /= norm;
    for (const std::uint32_t t : charts_[k].triangles) {
      const glm::dvec3 u = to_dvec(frames[t][0]), v = to_dvec(frames[t][1]);
      frames[t] = {from_glm(glm::vec3(c * u + s * v)), from_glm(glm::vec3(c * v - s * u))};
    }
  }

  const AbsorbInput& input_;
  const Topology& topology_;
  std::vector<FlatChart>& charts_;
  Patience patience_;
  double work_;
};

}  // namespace

void absorb_fragments(const AbsorbInput& input, std::vector<FlatChart>& charts,
                      const Context& context) {
  Absorber(input, charts).run(context);
}

}  // namespace atlas
