#include "libatlas/charts/seams/slit_paths.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "libatlas/charts/mesh/border_weight.h"
#include "libatlas/charts/mesh/chart_fans.h"
#include "libatlas/charts/seams/band_paths.h"
#include "libatlas/core/degrees.h"
#include "libatlas/core/glm_bridge.h"
#include "libatlas/core/portable_math.h"

namespace atlas {
namespace {

using Path = BandPaths::Path;

constexpr int kRounds = 4, kTubeRounds = 16;
constexpr double kLeastGain = 0.01;  // share of a path's cost
// An edge costs this share of its length more for each edge that it is away from the old path,
// because a chart stretches least where merging cut it open. Does not apply to tubes, which stretch
// as much wherever they are cut, and fill more of their rectangles with a straight cut.
constexpr double kStiffness = 0.15;
// In bands of fewer rings borders hardly move.
constexpr int kWideBand = 3;
constexpr int kReach = 4;  // times the rings: how far a slit may be extended
// The most triangles between two paths, per edge of the paths and ring of the band. Larger regions
// do not lie between them.
constexpr std::size_t kLuneTriangles = 6, kSmallLune = 64;

}  // namespace

class Slits::Straightener {
 public:
  Straightener(const Topology& topology, const StraightenOptions& options, Partition& partition,
               Frames& frames)
      : topology_(topology),
        rings_(options.rings),
        partition_(partition),
        frames_(frames),
        crease_angle_(radians(options.rules.crease_degrees)),
        fans_(topology, partition),
        paths_(topology, partition, crease_angle_) {}

  void close() {
    list_paths();
    std::erase_if(slits_, [&](const Slit& slit) { return !is_tube(slit); });
    for (const Slit& slit : slits_) seal(slit.path);
  }

  void reopen() {
    for (Slit& slit : slits_) {
      std::erase_if(slit.path, [&](std::uint32_t h) {
        return partition_.chart[h / 3] != slit.chart || !fans_.inner(h);
      });
      cut(slit.path);
    }
    for (Slit& slit : slits_) {
      if (slit.path.empty()) continue;
      const int rings = kReach * rings_[slit.chart];
      if (slit.free_end) draw_on(next_half_edge(slit.path.back()), rings);
      if (slit.free_start) draw_on(slit.path.front(), rings);
    }
  }

  void straighten() {
    list_paths();
    for (Slit& slit : slits_) {
      const bool tube = is_tube(slit);
      const BandPaths::Band band{rings_[slit.chart], tube ? 0 : kStiffness};
      const int rounds = band.rings == 0 ? 0 : tube ? kTubeRounds : kRounds;
      for (int round = 0; round < rounds && shorten(slit.path, band); ++round) {
      }
    }
  }

 private:
  struct Slit {
    Path path;
    std::uint32_t chart;
    bool free_start, free_end;  // the end lies on the border
  };

  // Whether the slit leads from border to border.
  bool is_tube(const Slit& slit) const {
    return slit.free_start && slit.free_end && rings_[slit.chart] >= kWideBand;
  }

  // Lists the maximal paths of seams. No path passes a vertex where others end.
  void list_paths() {
    slits_.clear();
    std::vector<std::uint32_t> seams;
    for (std::uint32_t t = 0; t < topology_.triangle_count(); ++t) {
      if (partition_.seams[t] == 0 || partition_.chart[t] == kNoIndex) continue;
      for (std::uint32_t h = 3 * t; h < 3 * t + 3; ++h) {
        if (partition_.seam(h) && fans_.inner(h) && h < topology_.opposite[h]) seams.push_back(h);
      }
    }
    if (seams.empty()) return;
    std::vector<std::uint8_t> seen(topology_.opposite.size(), 0);
    for (const std::uint32_t h : seams) {
      if (seen[h]) continue;
      Path back = follow(topology_.opposite[h], seen), path;
      for (auto it = back.rbegin(); it != back.rend(); ++it) {
        path.push_back(topology_.opposite[*it]);
      }
      if (fans_.to(back.back()) == fans_.from(back.front())) continue;  // a closed path
      const Path forth = follow(h, seen);
      path.insert(path.end(), forth.begin() + 1, forth.end());
      const std::uint32_t chart = partition_.chart[h / 3];
      const bool free_start = on_border(path.front()),
                 free_end = on_border(next_half_edge(path.back()));
      slits_.push_back({std::move(path), chart, free_start, free_end});
    }
  }

  // Whether the start of h lies on the chart's border.
  bool on_border(std::uint32_t h) const {
    return !fans_.around(
        h, [&](std::uint32_t g) { return fans_.inner(g); }, [](std::uint32_t) {});
  }

  // Extends a slit that ends inside the chart, at the start of h, to the nearest border.
  void draw_on(std::uint32_t h, int rings) {
    int seams = 0;
    const bool inside = fans_.around(
        h, [&](std::uint32_t g) { return fans_.inner(g); },
        [&](std::uint32_t g) { seams += partition_.seam(g); });
    if (!inside || seams != 1) return;
    cut(paths_.to_border(h, rings));
  }

  // Returns the path from seam h on, to where it ends or branches.
  Path follow(std::uint32_t h, std::vector<std::uint8_t>& seen) const {
    const auto inner = [&](std::uint32_t g) { return fans_.inner(g); };
    Path path{h};
    for (;;) {
      seen[path.back()] = seen[topology_.opposite[path.back()]] = 1;
      const std::uint32_t back = topology_.opposite[path.back()];
      std::uint32_t next = kNoIndex;
      int seams = 0;
      const bool closed = fans_.around(back, inner, [&](std::uint32_t g) {
        if (!partition_.seam(g)) return;
        ++seams;
        if (g != back) next = g;
      });
      if (!closed || seams != 2 || next == h) return path;
      path.push_back(next);
    }
  }

  void cut(const Path& path) {
    for (const std::uint32_t h : path) {
      partition_.cut(h);
      partition_.cut(topology_.opposite[h]);
    }
  }
  void seal(const Path& path) {
    for (const std::uint32_t h : path) {
      partition_.close(h);
      partition_.close(topology_.opposite[h]);
    }
  }

  double weight(std::uint32_t h) const { return border_weight(topology_, h, crease_angle_); }
  double cost(const Path& path) const {
    double sum = 0;
    for (const std::uint32_t h : path) sum += weight(h);
    return sum;
  }

  // Replaces the path by a shorter one. Returns false if no path is clearly shorter.
  bool shorten(Path& path, const BandPaths::Band& band) {
    seal(path);
    const std::vector<std::uint32_t> starts = ends(path.front(), band.rings),
                                     goals = ends(next_half_edge(path.back()), band.rings);
    Path found;
    if (apart(starts, goals)) found = paths_.beside(path, {starts, goals}, band);
    if (found.empty() || cost(found) > (1 - kLeastGain) * cost(path) ||
        !move_banks(path, found, band.rings)) {
      cut(path);
      return false;
    }
    path = std::move(found);
    return true;
  }

  bool apart(const std::vector<std::uint32_t>& starts,
             const std::vector<std::uint32_t>& goals) const {
    for (const std::uint32_t h : starts) {
      for (const std::uint32_t g : goals) {
        if (fans_.from(h) == fans_.from(g)) return false;
      }
    }
    return true;
  }

  // Returns half-edges that leave the vertices where the path may end: the start of h and, if that
  // lies on the chart's border, vertices along the border on both sides of it.
  std::vector<std::uint32_t> ends(std::uint32_t h, int rings) const {
    std::vector<std::uint32_t> out{h};
    if (fans_.place(h) != ChartFans::Place::border) return out;
    const auto inner = [&](std::uint32_t g) { return fans_.inner(g); };
    for (const bool forward : {true, false}) {
      std::uint32_t at = h;
      for (int i = 0; i < rings; ++i) {
        std::uint32_t rim = kNoIndex;
        fans_.around(at, inner, [&](std::uint32_t g) {
          const std::uint32_t side = forward ? g : previous_half_edge(g);
          if (!fans_.inner(side)) rim = side;
        });
        if (rim == kNoIndex) break;
        at = forward ? next_half_edge(rim) : rim;
        if (fans_.from(at) == fans_.from(h) || fans_.place(at) != ChartFans::Place::border) break;
        out.push_back(at);
      }
    }
    return out;
  }

  // Moves the triangles between the two paths from one bank to the other. If they are not between
  // them, returns false and changes nothing, except that `found` is closed.
  bool move_banks(const Path& path, const Path& found, int rings) {
    cut(path);
    cut(found);
    const Path left = less(path, found);
    const std::size_t most =
        kSmallLune + kLuneTriangles * std::size_t(rings) * (path.size() + found.size());
    std::vector<std::vector<std::uint32_t>> lunes;
    std::vector<std::uint32_t> done;  // triangles of all lunes, sorted
    for (const std::uint32_t h : left) {
      const std::uint32_t a = h / 3, b = topology_.opposite[h] / 3;
      const auto taken = [&](std::uint32_t t) {
        return std::binary_search(done.begin(), done.end(), t);
      };
      if (taken(a) || taken(b)) continue;
      std::vector<std::uint32_t> lune = smaller_side(a, b, most);
      if (lune.empty()) {
        seal(less(found, path));
        return false;
      }
      done.insert(done.end(), lune.begin(), lune.end());
      std::sort(done.begin(), done.end());
      lunes.push_back(std::move(lune));
    }
    for (const std::vector<std::uint32_t>& lune : lunes) turn_frames(lune, left);
    seal(left);
    return true;
  }

  // Returns the edges of a path that are not in the other one, in either direction.
  Path less(const Path& path, const Path& other) const {
    Path all;
    for (const std::uint32_t h : other) {
      all.push_back(h);
      all.push_back(topology_.opposite[h]);
    }
    std::sort(all.begin(), all.end());
    Path rest;
    for (const std::uint32_t h : path) {
      if (!std::binary_search(all.begin(), all.end(), h)) rest.push_back(h);
    }
    return rest;
  }

  // Returns the triangles connected to one of two triangles, whichever are fewer, sorted. Both sets
  // grow in turn. Returns nothing if both have more than `most`, or if they meet.
  std::vector<std::uint32_t> smaller_side(std::uint32_t a, std::uint32_t b, std::size_t most) {
    in_.resize(topology_.triangle_count(), 0);
    std::array<std::vector<std::uint32_t>, 2> sides{{{a}, {b}}};
    in_[a] = 1;
    in_[b] = 2;
    int least = -1;
    bool meet = false;
    for (std::size_t i = 0; i < most && least < 0 && !meet; ++i) {
      for (int side = 0; side < 2 && least < 0; ++side) {
        if (i == sides[side].size()) {
          least = side;
        } else {
          meet = meet || !grow(sides[side][i], std::uint8_t(side + 1), sides[side]);
        }
      }
    }
    for (const std::vector<std::uint32_t>& side : sides) {
      for (const std::uint32_t t : side) in_[t] = 0;
    }
    if (least < 0 || meet) return {};
    std::sort(sides[least].begin(), sides[least].end());
    return std::move(sides[least]);
  }

  // Adds the neighbours of t. Returns false if one of them is on the other side.
  bool grow(std::uint32_t t, std::uint8_t mark, std::vector<std::uint32_t>& side) {
    for (std::uint32_t h = 3 * t; h < 3 * t + 3; ++h) {
      if (!fans_.linked(h)) continue;
      const std::uint32_t o = topology_.opposite[h] / 3;
      if (in_[o] != 0 && in_[o] != mark) return false;
      if (in_[o] == 0) side.push_back(o);
      in_[o] = mark;
    }
    return true;
  }

  // Turns the frames of a lune by the angle between the frames on both sides of the closing edges.
  void turn_frames(const std::vector<std::uint32_t>& lune, const Path& closing) {
    double c = 0, s = 0;
    for (const std::uint32_t edge : closing) {
      std::uint32_t h = edge;
      if (!std::binary_search(lune.begin(), lune.end(), h / 3)) h = topology_.opposite[h];
      const std::uint32_t o = topology_.opposite[h];
      if (!std::binary_search(lune.begin(), lune.end(), h / 3)) continue;
      const Frames::Frame own = frames_.at(topology_, h / 3);
      const Frames::Frame wanted =
          carry_frame(topology_, frames_.at(topology_, o / 3), o / 3, h / 3);
      const double length = edge_length(topology_, h);
      c += length * glm::dot(to_dvec(wanted[0]), to_dvec(own[0]));
      s += length * glm::dot(to_dvec(wanted[1]), to_dvec(own[0]));
    }
    const double norm = portable::hypot(c, s);
    if (!(norm > 0)) return;
    for (const std::uint32_t t : lune) {
      const Frames::Frame f = frames_.at(topology_, t);
      const glm::dvec3 u = to_dvec(f[0]), v = to_dvec(f[1]);
      const glm::vec3 x(c / norm * u - s / norm * v), y(s / norm * u + c / norm * v);
      frames_.put(t, {Vec3f{x.x, x.y, x.z}, Vec3f{y.x, y.y, y.z}});
    }
  }

  const Topology& topology_;
  std::span<const std::uint8_t> rings_;
  Partition& partition_;
  Frames& frames_;
  double crease_angle_;
  ChartFans fans_;
  BandPaths paths_;
  std::vector<std::uint8_t> in_;  // one per triangle: which side it is on; 0: none
  std::vector<Slit> slits_;
};

Slits::Slits(const Topology& topology, const StraightenOptions& options, Partition& partition,
             Frames& frames)
    : straightener_(std::make_unique<Straightener>(topology, options, partition, frames)) {}
Slits::~Slits() = default;

void Slits::close() {
  straightener_->close();
}
void Slits::reopen() {
  straightener_->reopen();
}
void Slits::straighten() {
  straightener_->straighten();
}

}  // namespace atlas
