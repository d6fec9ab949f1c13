#include "libatlas/charts/absorb.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <queue>
#include <span>

#include "libatlas/charts/hull.h"
#include "libatlas/charts/merge_options.h"
#include "libatlas/core/glm_bridge.h"

namespace atlas {
namespace {

// What a union costs is bounded: by the neighbours tried for a chart, and by the triangles of all
// unions as a multiple of the mesh's, which keeps the time linear.
struct Patience {
  std::size_t neighbours;
  double work, fill;  // fill: of its rectangle by a union, or as much as the sparser part
  std::size_t few;    // charts of fewer triangles are tried, too, though they are no fragments
};
// Of charts with fewer triangles than a cell the coarse mesh knows hardly more than the outline:
// whether to merge them is seen here.
constexpr Patience kSmooth{3, 1, 0.45, 40};
constexpr Patience kFast{2, 0.25, 0.45, 0};
constexpr Patience kBest{6, 4, 0.45, kNoIndex};
// Scan noise divides charts that need not be divided: a work of 2 left armadillo with 56 to 59
// charts for 41 smooth ones, 3 leaves 40 to 52, 6 leaves 38 to 52 in twice the time.
constexpr Patience kNoisy{4, 3, 0.45, 0};
// A limit on cones leaves many small charts, cheap to try.
constexpr Patience kInCone{6, 3, 0.3, 0};
constexpr double kSmallShare = 0.01;  // of the triangles, what is tried on smooth meshes
// In pieces of so many triangles charts of so few are tried as well, for two hundredths of the time
// and three fewer charts in a hundred; smaller pieces would take a fifth more time.
constexpr std::size_t kLargePiece = 20000, kFewOfLarge = 400;
constexpr double kMostL2 = 1.01;    // of a union's stretch, as when cells are merged
constexpr double kWholeFill = 0.6;  // of a union of charts that are no fragments
// Solving never raised the share that a union fills by more: of 1600 it spared 260, in a seventh of
// the time, and none that succeeded (90 meshes).
constexpr double kSureFill = 0.995;
// Charts apart along creases, as the sides of a box, merging knew well enough: their seams weigh
// less than this part of their length.
constexpr double kHidden = 0.5;
// Lengths of borders are compared in parts of a chart's whole border: where a mesh is symmetric
// many are equal but for rounding.
constexpr double kBorderParts = 1024;
// Charts whose common border has shapes so different, by its length, do not go together; of short
// borders that says little, but of charts that are no fragments (of 72 and 55 none went together).
// On rough surfaces relaxing such unions is dear: of 88 beyond a twentieth 8 succeeded, in half of
// all the time (11 noisy meshes).
constexpr double kMostMisfit = 0.1, kMostRoughMisfit = 0.05, kMostShortMisfit = 0.25;
constexpr std::size_t kLeastFitted = 8;  // edges
// Unions of so many times their smaller part's triangles keep the larger one's uvs but around it: a
// tenth less time for intricate statues, as many charts.
constexpr std::size_t kLittle = 10;

// A turn and a shift; applied to complex numbers.
struct Motion {
  glm::dvec2 turn{1, 0}, shift{0};
  double misfit = 0;  // root mean square distance of what should meet, by the border's length
  std::size_t edges = 0;

  Vec2d operator()(Vec2d p) const {
    return {turn.x * p.x - turn.y * p.y + shift.x, turn.y * p.x + turn.x * p.y + shift.y};
  }
};

class Absorber {
 public:
  Absorber(const AbsorbInput& input, std::vector<FlatChart>& charts)
      : input_(input),
        topology_(input.flatten.topology),
        charts_(charts),
        patience_(choose_patience(input.flatten.options)),
        most_misfit_(topology_.calm_normals.empty() ? kMostMisfit : kMostRoughMisfit),
        seam_worth_(merge_options(input.flatten.options.max_stretch).seam_worth),
        crease_cosine_(std::cos(input.flatten.options.crease_degrees * M_PI / 180)),
        work_(patience_.work * double(topology_.triangle_count())) {
    auto& label = input_.partition.chart;
    for (std::uint32_t k = 0; k < charts_.size(); ++k) {
      for (const std::uint32_t t : charts_[k].triangles) label[t] = k;
    }
  }

  void run(const Context& context) {
    using Entry = std::pair<std::size_t, std::uint32_t>;
    std::priority_queue<Entry, std::vector<Entry>, std::greater<>> queue;
    piece_size_.assign(topology_.component_count, 0);
    for (const FlatChart& chart : charts_) {
      piece_size_[topology_.component[chart.triangles[0]]] += chart.triangles.size();
    }
    for (std::uint32_t k = 0; k < charts_.size(); ++k) {
      candidate_.push_back(worth_a_try(charts_[k]));
      if (candidate_[k]) queue.push({charts_[k].triangles.size(), k});
    }
    while (!queue.empty() && !context.cancelled() && work_ > 0) {
      const auto [size, k] = queue.top();
      queue.pop();
      if (charts_[k].triangles.size() != size) continue;  // it has changed since
      const std::uint32_t into = absorb(k);
      if (into != kNoIndex && candidate_[into]) {
        queue.push({charts_[into].triangles.size(), into});
      }
    }
    std::erase_if(charts_, [](const FlatChart& chart) { return chart.triangles.empty(); });
  }

 private:
  struct BorderEdge {
    std::uint32_t chart, half_edge;  // chart: on the other side
    double length;
  };
  struct Neighbour {
    std::uint32_t chart;
    double border;
    std::span<const BorderEdge> edges;
  };

  Patience choose_patience(const ChartOptions& options) const {
    if (options.cone_degrees > 0) return kInCone;
    if (!topology_.calm_normals.empty()) return kNoisy;
    if (options.preset == ChartPreset::fast) return kFast;
    return options.preset == ChartPreset::best ? kBest : kSmooth;
  }

  bool worth_a_try(const FlatChart& chart) const {
    const std::size_t size = chart.triangles.size();
    const std::size_t piece = piece_size_[topology_.component[chart.triangles[0]]];
    const bool large = piece >= kLargePiece && patience_.few > 0;
    if (size < (large ? std::max(kFewOfLarge, patience_.few) : patience_.few)) return true;
    return chart.fragment && (!topology_.calm_normals.empty() ||
                              double(size) <= kSmallShare * double(topology_.triangle_count()));
  }

  std::uint32_t absorb(std::uint32_t k) {
    const std::vector<BorderEdge> border = border_of(k);
    const std::vector<Neighbour> neighbours = find_neighbours(border);
    for (std::size_t i = 0; i < std::min(neighbours.size(), patience_.neighbours); ++i) {
      if (join(k, neighbours[i])) return neighbours[i].chart;
    }
    return kNoIndex;
  }

  // Sorted by the chart across.
  std::vector<BorderEdge> border_of(std::uint32_t k) const {
    std::vector<BorderEdge> border;
    for (const std::uint32_t t : charts_[k].triangles) {
      for (std::uint32_t h = 3 * t; h < 3 * t + 3; ++h) {
        const std::uint32_t o = topology_.opposite[h];
        if (o == kNoIndex || input_.partition.chart[o / 3] == k) continue;
        border.push_back({input_.partition.chart[o / 3], h, edge_length(topology_, h)});
      }
    }
    std::stable_sort(border.begin(), border.end(),
                     [](const BorderEdge& a, const BorderEdge& b) { return a.chart < b.chart; });
    return border;
  }

  // The longest border first.
  static std::vector<Neighbour> find_neighbours(std::span<const BorderEdge> border) {
    std::vector<Neighbour> all;
    double whole = 0;
    for (std::size_t first = 0, last = 0; first < border.size(); first = last) {
      Neighbour n{border[first].chart, 0, {}};
      for (; last < border.size() && border[last].chart == n.chart; ++last) {
        n.border += border[last].length;
      }
      n.edges = border.subspan(first, last - first);
      whole += n.border;
      all.push_back(n);
    }
    for (Neighbour& n : all) n.border = std::round(kBorderParts * n.border / whole);
    std::stable_sort(all.begin(), all.end(),
                     [](const Neighbour& a, const Neighbour& b) { return a.border > b.border; });
    return all;
  }

  bool may_fit_cone(const FlatChart& a, const FlatChart& b) const {
    const double limit = input_.flatten.options.cone_degrees * M_PI / 180;
    if (limit <= 0) return true;
    const double between =
        std::acos(std::clamp(glm::dot(to_dvec(a.cone.axis), to_dvec(b.cone.axis)), -1.0, 1.0));
    return between <= 2 * limit && std::max(a.cone.angle, b.cone.angle) <= limit;
  }

  bool join(std::uint32_t k, const Neighbour& neighbour) {
    const std::uint32_t into = neighbour.chart;
    FlatChart &a = charts_[k], &b = charts_[into];
    if (!may_fit_cone(a, b)) return false;
    const std::size_t size = a.triangles.size() + b.triangles.size();
    std::size_t& failed_size = failed_[std::minmax(k, into)];
    if (failed_size == size) return false;
    failed_size = size;
    const Motion motion = fit(k, neighbour);
    const bool said = motion.edges >= kLeastFitted || !(a.fragment || b.fragment);
    if (motion.misfit > (said ? most_misfit_ : kMostShortMisfit)) return false;
    const Seam seam = seam_of(neighbour.edges);
    if (!a.fragment && !b.fragment && seam.weight < kHidden * seam.length) return false;
    if (fill_together(a, b, motion) < kSureFill * least_fill(a, b)) return false;
    work_ -= double(size);
    std::vector<std::uint8_t> seams;
    for (const FlatChart* chart : {&a, &b}) {
      for (const std::uint32_t t : chart->triangles) seams.push_back(input_.partition.seams[t]);
    }
    const std::vector<Vec2d> joined = side_by_side(a, b, motion);
    for (const std::uint32_t t : a.triangles) input_.partition.chart[t] = into;
    std::vector<std::uint32_t> both(size);
    std::merge(a.triangles.begin(), a.triangles.end(), b.triangles.begin(), b.triangles.end(),
               both.begin());
    const bool little = size > kLittle * std::min(a.triangles.size(), b.triangles.size());
    ChartOutcome outcome = flatten_chart(
        input_.flatten, input_.partition, both,
        {.cuts = 0, .joined = joined, .little = little, .whole = true}, input_.scratch);
    outcome.flat.triangles = std::move(both);
    if (outcome.parts.empty() && is_better(outcome.flat, a, b, worth_of(seam, a))) {
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

  // Whether a union is better than its parts. Fragments were meant to be one chart; what else is
  // joined must not cost more stretch than the seam that it saves is worth.
  bool is_better(const FlatChart& both, const FlatChart& a, const FlatChart& b,
                 double worth) const {
    if (both.distortion.stretch_l2 > kMostL2 || fill(both) < least_fill(a, b)) return false;
    return a.fragment || b.fragment || energy(both) <= energy(a) + energy(b) + worth;
  }

  struct Seam {
    double length = 0, weight = 0;  // weight: creases count less, they hide it
  };
  Seam seam_of(std::span<const BorderEdge> edges) const {
    Seam seam;
    for (const BorderEdge& edge : edges) {
      seam.length += edge.length;
      seam.weight += border_weight(topology_, edge.half_edge, crease_cosine_);
    }
    return seam;
  }

  // What a seam of the piece that `chart` lies in is worth in stretch, as when cells are merged.
  double worth_of(const Seam& seam, const FlatChart& chart) {
    if (piece_area_.empty()) measure_pieces();
    const double piece = piece_area_[topology_.component[chart.triangles.front()]];
    return seam_worth_ * seam.weight * std::sqrt(piece);
  }

  void measure_pieces() {
    piece_area_.assign(topology_.component_count, 0);
    for (std::uint32_t t = 0; t < topology_.triangle_count(); ++t) {
      if (topology_.component[t] != kNoIndex) {
        piece_area_[topology_.component[t]] += topology_.areas[t];
      }
    }
  }

  double area(const FlatChart& chart) const {
    double sum = 0;
    for (const std::uint32_t t : chart.triangles) sum += topology_.areas[t];
    return sum;
  }
  double energy(const FlatChart& chart) const {
    return area(chart) * (chart.distortion.stretch_l2 * chart.distortion.stretch_l2 - 1);
  }

  // The uvs of both, 3 a triangle in ascending order, those of `a` moved.
  static std::vector<Vec2d> side_by_side(const FlatChart& a, const FlatChart& b,
                                         const Motion& motion) {
    std::vector<Vec2d> uvs;
    uvs.reserve(3 * (a.triangles.size() + b.triangles.size()));
    for (std::size_t i = 0, j = 0; i < a.triangles.size() || j < b.triangles.size();) {
      const bool moved =
          j == b.triangles.size() || (i < a.triangles.size() && a.triangles[i] < b.triangles[j]);
      const auto& corners = moved ? a.corners[i++] : b.corners[j++];
      for (const std::uint32_t v : corners) uvs.push_back(moved ? motion(a.uvs[v]) : b.uvs[v]);
    }
    return uvs;
  }

  // How much of its rectangle a union must fill.
  double least_fill(const FlatChart& a, const FlatChart& b) const {
    if (a.fragment || b.fragment) return std::min({patience_.fill, fill(a), fill(b)});
    return kWholeFill;
  }

  // What both fill as they are, side by side.
  static double fill_together(const FlatChart& a, const FlatChart& b, const Motion& motion) {
    std::vector<Vec2d> points = b.uvs, hull;
    for (const Vec2d& p : a.uvs) points.push_back(motion(p));
    hull_area(points, hull);
    const double box = box_area(hull);
    return box > 0 ? (a.distortion.uv_area + b.distortion.uv_area) / box : 1;
  }

  static double fill(const FlatChart& chart) {
    const double box = chart.size.x * chart.size.y;
    return box > 0 ? chart.distortion.uv_area / box : 1;
  }

  // The half-edge's two ends in the uvs of its chart.
  std::array<glm::dvec2, 2> ends(const FlatChart& chart, std::uint32_t h) const {
    const auto at = std::lower_bound(chart.triangles.begin(), chart.triangles.end(), h / 3);
    const auto& corners = chart.corners[std::size_t(at - chart.triangles.begin())];
    return {to_glm(chart.uvs[corners[h % 3]]), to_glm(chart.uvs[corners[next_half_edge(h) % 3]])};
  }

  // What takes one chart's uvs to where the other's continue best across their border (Procrustes).
  Motion fit(std::uint32_t k, const Neighbour& neighbour) const {
    struct Pair {
      glm::dvec2 from, to;
      double weight;
    };
    std::vector<Pair> pairs;
    double length = 0;
    glm::dvec2 mean_from(0), mean_to(0);
    for (const BorderEdge& edge : neighbour.edges) {
      const double weight = 0.5 * edge.length;
      const auto from = ends(charts_[k], edge.half_edge),
                 to = ends(charts_[neighbour.chart], topology_.opposite[edge.half_edge]);
      for (const int i : {0, 1}) {
        pairs.push_back({from[i], to[1 - i], weight});
        mean_from += weight * from[i];
        mean_to += weight * to[1 - i];
        length += weight;
      }
    }
    Motion motion;
    motion.edges = pairs.size() / 2;
    if (!(length > 0)) return motion;
    mean_from /= length;
    mean_to /= length;
    double c = 0, s = 0, spread = 0;
    for (const Pair& pair : pairs) {
      const glm::dvec2 p = pair.from - mean_from, q = pair.to - mean_to;
      c += pair.weight * glm::dot(p, q);
      s += pair.weight * (p.x * q.y - p.y * q.x);
      spread += pair.weight * (glm::dot(p, p) + glm::dot(q, q));
    }
    const double norm = std::sqrt(c * c + s * s);
    if (norm > 0) motion.turn = glm::dvec2(c, s) / norm;
    const Vec2d turned = motion(from_glm(mean_from));
    motion.shift = mean_to - to_glm(turned);
    motion.misfit = std::sqrt(std::max(spread - 2 * norm, 0.0) / length) / length;
    return motion;
  }

  const AbsorbInput& input_;
  const Topology& topology_;
  std::vector<FlatChart>& charts_;
  Patience patience_;
  double most_misfit_;
  double seam_worth_;
  double crease_cosine_;
  double work_;
  std::vector<std::uint8_t> candidate_;  // 1 a chart: tried by itself, as what it joins with others
  std::vector<std::size_t> piece_size_;  // 1 a piece: triangles
  std::vector<double> piece_area_;       // empty until it is needed
  // Triangles of the union that was tried last of each two charts: the same again fails again.
  std::map<std::pair<std::uint32_t, std::uint32_t>, std::size_t> failed_;
};

}  // namespace

void absorb_charts(const AbsorbInput& input, std::vector<FlatChart>& charts,
                   const Context& context) {
  Absorber(input, charts).run(context);
}

}  // namespace atlas
