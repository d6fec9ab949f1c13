#include "libatlas/charts/flaps.h"

#include <algorithm>
#include <array>
#include <limits>
#include <optional>
#include <span>
#include <unordered_map>

#include "libatlas/core/glm_bridge.h"
#include "libatlas/core/predicates.h"
#include "libatlas/param/injectivity.h"
#include "libatlas/param/orient.h"

namespace atlas {
namespace {

// A flap is this small, in triangles and as a part of its carrier's area.
constexpr std::size_t kMostTriangles = 200;
constexpr double kMostShare = 0.5;
constexpr std::size_t kMostEdges = 24;  // tried a flap, the longest
// Of its rectangle a carrier fills as much in the end, or this part of what it filled before.
constexpr double kLeastFill = 0.35, kKeptFill = 0.9;
// What carries flaps may hang on another chart the next time; a fourth time found nothing.
constexpr int kRounds = 3;

struct Box {
  glm::dvec2 low{std::numeric_limits<double>::infinity()}, high = -low;

  void add(Vec2d p) {
    low = glm::min(low, to_glm(p));
    high = glm::max(high, to_glm(p));
  }
  double area() const { return (high.x - low.x) * (high.y - low.y); }
  bool misses(Vec2d a, Vec2d b) const {
    return std::max(a.x, b.x) < low.x || std::min(a.x, b.x) > high.x ||
           std::max(a.y, b.y) < low.y || std::min(a.y, b.y) > high.y;
  }
};

// A turn and a scale that lay an edge pq upon PQ.
struct Placement {
  std::uint32_t edge = kNoIndex;  // the flap's half-edge that closes
  glm::dvec2 turn{1, 0}, p{0}, q{0}, P{0}, Q{0};

  Vec2d operator()(Vec2d u) const {
    if (to_glm(u) == p) return from_glm(P);  // the ends meet exactly
    if (to_glm(u) == q) return from_glm(Q);
    const glm::dvec2 d = to_glm(u) - p;
    return from_glm(P + glm::dvec2(turn.x * d.x - turn.y * d.y, turn.x * d.y + turn.y * d.x));
  }
};

double fill(const FlatChart& chart) {
  const double box = chart.size.x * chart.size.y;
  return box > 0 ? chart.distortion.uv_area / box : 1;
}

// Triangles in ascending order; vertices that nothing names are left out.
FlatChart put_in_order(const FlatChart& chart) {
  FlatChart out = chart;
  std::vector<std::uint32_t> order(chart.triangles.size());
  for (std::uint32_t i = 0; i < order.size(); ++i) order[i] = i;
  std::sort(order.begin(), order.end(), [&](std::uint32_t a, std::uint32_t b) {
    return chart.triangles[a] < chart.triangles[b];
  });
  std::vector<std::uint32_t> name(chart.uvs.size(), kNoIndex);
  out.uvs.clear();
  out.vertex.clear();
  for (std::size_t i = 0; i < order.size(); ++i) {
    out.triangles[i] = chart.triangles[order[i]];
    out.corners[i] = chart.corners[order[i]];
    for (std::uint32_t& c : out.corners[i]) {
      if (name[c] == kNoIndex) {
        name[c] = static_cast<std::uint32_t>(out.uvs.size());
        out.uvs.push_back(chart.uvs[c]);
        out.vertex.push_back(chart.vertex[c]);
      }
      c = name[c];
    }
  }
  return out;
}

class FlapHanger {
 public:
  FlapHanger(const FlattenInput& input, Partition& partition, std::vector<FlatChart>& charts)
      : input_(input),
        topology_(input.topology),
        partition_(partition),
        charts_(charts),
        place_(topology_.triangle_count(), kNoIndex),
        carriers_(charts.size()) {
    for (std::uint32_t k = 0; k < charts.size(); ++k) {
      for (std::uint32_t i = 0; i < charts[k].triangles.size(); ++i) {
        partition_.chart[charts[k].triangles[i]] = k;
        place_[charts[k].triangles[i]] = i;
      }
    }
  }

  // Returns whether any chart hangs on another one now.
  bool run(const Context& context) {
    std::vector<std::uint32_t> order;
    for (std::uint32_t k = 0; k < charts_.size(); ++k) {
      if (charts_[k].triangles.size() <= kMostTriangles) order.push_back(k);
    }
    std::stable_sort(order.begin(), order.end(), [&](std::uint32_t a, std::uint32_t b) {
      return charts_[a].triangles.size() < charts_[b].triangles.size();
    });
    for (const std::uint32_t k : order) {
      if (context.cancelled()) break;
      if (carriers_[k].flaps.empty()) hang(k);
    }
    const auto before = static_cast<std::uint32_t>(charts_.size());
    bool any = false;
    for (std::uint32_t k = 0; k < before; ++k) {
      if (carriers_[k].flaps.empty()) continue;
      std::optional<FlatChart> whole = judged(k, put_together(k));
      any = any || whole;
      if (whole) {
        charts_[k] = std::move(*whole);
      } else {
        take_down(k);
      }
    }
    std::erase_if(charts_, [](const FlatChart& chart) { return chart.triangles.empty(); });
    return any;
  }

 private:
  struct Segment {
    std::uint32_t half_edge;
    Vec2d a, b;
  };
  struct Flap {
    FlatChart chart;         // as it was
    std::vector<Vec2d> uvs;  // where it hangs
    std::uint32_t edge;      // its half-edge that closed
  };
  struct Carrier {
    std::vector<Flap> flaps;
    std::vector<Segment> border;  // with those of the flaps; empty: not known yet
    Box box;
    double area = 0, least_fill = 0;
  };

  Vec2d start(const FlatChart& chart, std::span<const Vec2d> uvs, std::uint32_t h) const {
    return uvs[chart.corners[place_[h / 3]][h % 3]];
  }

  std::vector<Segment> border_of(const FlatChart& chart) const {
    std::vector<Segment> border;
    for (const std::uint32_t t : chart.triangles) {
      for (std::uint32_t h = 3 * t; h < 3 * t + 3; ++h) {
        const std::uint32_t o = topology_.opposite[h];
        const bool open =
            o == kNoIndex || partition_.chart[o / 3] != partition_.chart[t] || partition_.seam(h);
        if (!open) continue;
        border.push_back(
            {h, start(chart, chart.uvs, h), start(chart, chart.uvs, next_half_edge(h))});
      }
    }
    return border;
  }

  void hang(std::uint32_t k) {
    struct Link {
      std::uint32_t half_edge;
      double length;
    };
    const std::vector<Segment> border = border_of(charts_[k]);
    std::vector<Link> links;
    for (const Segment& s : border) {
      const std::uint32_t o = topology_.opposite[s.half_edge];
      if (o == kNoIndex || partition_.chart[o / 3] == k) continue;
      links.push_back({s.half_edge, edge_length(topology_, s.half_edge)});
    }
    std::stable_sort(links.begin(), links.end(),
                     [](const Link& a, const Link& b) { return a.length > b.length; });
    if (links.size() > kMostEdges) links.resize(kMostEdges);
    Placement best;
    double least_growth = std::numeric_limits<double>::infinity();
    for (const Link& link : links) {
      const std::optional<Placement> there = placement(k, link.half_edge);
      if (there && fits(k, *there, border, least_growth)) best = *there;
    }
    if (best.edge != kNoIndex) attach(k, best, border);
  }

  std::optional<Placement> placement(std::uint32_t k, std::uint32_t h) {
    const std::uint32_t o = topology_.opposite[h], into = partition_.chart[o / 3];
    const FlatChart &flap = charts_[k], &carrier = charts_[into];
    if (flap.distortion.surface_area > kMostShare * carrier.distortion.surface_area) return {};
    const Flap* earlier = flap_of(o / 3, carriers_[into]);
    const FlatChart& owner = earlier ? earlier->chart : carrier;
    const std::span<const Vec2d> uvs = earlier ? earlier->uvs : carrier.uvs;
    Placement out;
    out.edge = h;
    out.p = to_glm(start(flap, flap.uvs, h));
    out.q = to_glm(start(flap, flap.uvs, next_half_edge(h)));
    out.P = to_glm(start(owner, uvs, next_half_edge(o)));
    out.Q = to_glm(start(owner, uvs, o));
    const glm::dvec2 from = out.q - out.p, to = out.Q - out.P;
    const double squared = glm::dot(from, from);
    if (!(squared > 0)) return {};
    out.turn = glm::dvec2(glm::dot(from, to), from.x * to.y - from.y * to.x) / squared;
    const double scale = glm::length(out.turn);
    if (!(std::max(scale, 1 / scale) * flap.distortion.stretch_999 <= input_.options.max_stretch)) {
      return {};
    }
    return out;
  }

  // Whether there is room, and the carrier's rectangle grows less than `least_growth`, which is
  // then set.
  bool fits(std::uint32_t k, const Placement& there, std::span<const Segment> border,
            double& least_growth) {
    const std::uint32_t o = topology_.opposite[there.edge];
    const Carrier& carrier = known_carrier(partition_.chart[o / 3]);
    std::vector<Segment> moved;
    Box box, both = carrier.box;
    for (const Segment& s : border) {
      if (s.half_edge == there.edge) continue;
      moved.push_back({s.half_edge, there(s.a), there(s.b)});
      box.add(moved.back().a);
      both.add(moved.back().a);
    }
    const double growth = both.area() / carrier.box.area();
    const double area =
        carrier.area + glm::dot(there.turn, there.turn) * charts_[k].distortion.uv_area;
    if (!(growth < least_growth) || area < carrier.least_fill * both.area()) return false;
    for (const Segment& s : carrier.border) {
      if (s.half_edge == o || box.misses(s.a, s.b)) continue;
      for (const Segment& m : moved) {
        if (segments_cross(s.a, s.b, m.a, m.b)) return false;
      }
    }
    least_growth = growth;
    return true;
  }

  const Carrier& known_carrier(std::uint32_t k) {
    Carrier& carrier = carriers_[k];
    if (!carrier.border.empty()) return carrier;
    carrier.border = border_of(charts_[k]);
    for (const Segment& s : carrier.border) carrier.box.add(s.a);
    carrier.area = charts_[k].distortion.uv_area;
    carrier.least_fill = std::min(kLeastFill, kKeptFill * fill(charts_[k]));
    return carrier;
  }

  void attach(std::uint32_t k, const Placement& there, std::span<const Segment> border) {
    const std::uint32_t o = topology_.opposite[there.edge], into = partition_.chart[o / 3];
    FlatChart& flap = charts_[k];
    Carrier& carrier = carriers_[into];
    std::erase_if(carrier.border, [&](const Segment& s) { return s.half_edge == o; });
    for (const Segment& s : border) {
      if (s.half_edge == there.edge) continue;
      carrier.border.push_back({s.half_edge, there(s.a), there(s.b)});
      carrier.box.add(there(s.a));
    }
    carrier.area += glm::dot(there.turn, there.turn) * flap.distortion.uv_area;
    Flap& hung = carrier.flaps.emplace_back();
    for (const Vec2d u : flap.uvs) hung.uvs.push_back(there(u));
    hung.edge = there.edge;
    for (const std::uint32_t t : flap.triangles) partition_.chart[t] = into;
    for (const Segment& s : border) {
      const std::uint32_t other = topology_.opposite[s.half_edge];
      if (s.half_edge == there.edge || other == kNoIndex) continue;
      if (partition_.chart[other / 3] != into) continue;
      partition_.cut(s.half_edge);
      partition_.cut(other);
    }
    hung.chart = std::move(flap);
    flap = FlatChart{};
  }

  // The one that brought triangle t, or null.
  static const Flap* flap_of(std::uint32_t t, const Carrier& carrier) {
    for (const Flap& flap : carrier.flaps) {
      const auto& list = flap.chart.triangles;
      if (std::binary_search(list.begin(), list.end(), t)) return &flap;
    }
    return nullptr;
  }

  FlatChart put_together(std::uint32_t k) const {
    FlatChart whole = charts_[k];
    std::unordered_map<std::uint32_t, std::uint32_t> at;  // of flaps' triangles, in `whole`
    for (const Flap& flap : carriers_[k].flaps) {
      const FlatChart& part = flap.chart;
      const auto first = static_cast<std::uint32_t>(whole.uvs.size());
      whole.uvs.insert(whole.uvs.end(), flap.uvs.begin(), flap.uvs.end());
      whole.vertex.insert(whole.vertex.end(), part.vertex.begin(), part.vertex.end());
      const std::uint32_t h = flap.edge, o = topology_.opposite[h];
      const auto found = at.find(o / 3);
      const auto there = whole.corners[found == at.end() ? place_[o / 3] : found->second];
      const auto& here = part.corners[place_[h / 3]];
      const std::array<std::uint32_t, 2> own{here[h % 3], here[next_half_edge(h) % 3]},
          others{there[next_half_edge(o) % 3], there[o % 3]};
      for (std::size_t i = 0; i < part.triangles.size(); ++i) {
        at[part.triangles[i]] = static_cast<std::uint32_t>(whole.triangles.size());
        whole.triangles.push_back(part.triangles[i]);
        auto corners = part.corners[i];
        for (std::uint32_t& c : corners) {
          c = c == own[0] ? others[0] : c == own[1] ? others[1] : first + c;
        }
        whole.corners.push_back(corners);
      }
    }
    return put_in_order(whole);
  }

  // Measured and turned; nothing if it breaks a limit.
  std::optional<FlatChart> judged(std::uint32_t k, FlatChart whole) const {
    const glm::dvec3 origin = to_dvec(topology_.points[whole.vertex.front()]);
    std::vector<Vec3d> positions;
    for (const std::uint32_t v : whole.vertex) {
      positions.push_back(from_glm(to_dvec(topology_.points[v]) - origin));
    }
    std::vector<double> density;
    if (!input_.density.empty()) {
      for (const std::uint32_t t : whole.triangles) density.push_back(input_.density[t]);
    }
    const LocalMesh mesh{positions, whole.corners, density};
    const double scale = area_preserving_scale(measure_distortion(mesh, whole.uvs));
    for (Vec2d& p : whole.uvs) p = {p.x * scale, p.y * scale};
    whole.distortion = measure_distortion(mesh, whole.uvs);
    if (whole.distortion.stretch_999 > input_.options.max_stretch ||
        !check_injectivity(mesh, whole.uvs).injective) {
      return {};
    }
    std::vector<std::array<std::uint32_t, 2>> border;
    for (const Segment& s : carriers_[k].border) {
      const auto t =
          std::lower_bound(whole.triangles.begin(), whole.triangles.end(), s.half_edge / 3);
      const auto& c = whole.corners[std::size_t(t - whole.triangles.begin())];
      border.push_back({c[s.half_edge % 3], c[next_half_edge(s.half_edge) % 3]});
    }
    whole.size = orient_for_packing(whole.uvs, border).size;
    whole.cone = normal_cone(topology_.normals, whole.triangles);
    whole.planar = false;
    return whole;
  }

  // Flaps become charts of their own again.
  void take_down(std::uint32_t k) {
    for (Flap& flap : carriers_[k].flaps) {
      for (const std::uint32_t t : flap.chart.triangles) {
        partition_.chart[t] = static_cast<std::uint32_t>(charts_.size());
      }
      charts_.push_back(std::move(flap.chart));
    }
    for (std::size_t i = charts_.size() - carriers_[k].flaps.size(); i < charts_.size(); ++i) {
      for (const std::uint32_t t : charts_[i].triangles) {
        for (std::uint32_t h = 3 * t; h < 3 * t + 3; ++h) {
          const std::uint32_t o = topology_.opposite[h];
          if (o == kNoIndex || partition_.chart[o / 3] == partition_.chart[t]) continue;
          partition_.close(h);
          partition_.close(o);
        }
      }
    }
  }

  const FlattenInput& input_;
  const Topology& topology_;
  Partition& partition_;
  std::vector<FlatChart>& charts_;
  std::vector<std::uint32_t> place_;  // 1 a triangle: in the chart that it came in
  std::vector<Carrier> carriers_;     // 1 a chart
};

}  // namespace

void hang_flaps(const FlattenInput& input, Partition& partition, std::vector<FlatChart>& charts,
                const Context& context) {
  if (input.topology.calm_normals.empty() || input.options.cone_degrees > 0) return;
  for (int round = 0; round < kRounds && !context.cancelled(); ++round) {
    if (!FlapHanger(input, partition, charts).run(context)) return;
  }
}

}  // namespace atlas
