#include "libatlas/charts/copies.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>

#include "libatlas/charts/cells/grains.h"
#include "libatlas/core/degrees.h"
#include "libatlas/core/glm_bridge.h"
#include "libatlas/core/sort_total.h"
#include "libatlas/param/distortion.h"

namespace atlas {
namespace {

constexpr double kTolerance = 1e-5;  // relative to a part's size
// Rounding when a part is placed: up to this share of the largest coordinate, 4 units in its last
// place.
constexpr double kRounding = 4.0 / (1 << 23);
// Parts whose rounding exceeds this share of their size are not compared.
constexpr double kMostRounding = 1e-3;
// The most originals with about the same sum of edge lengths that a piece is compared with.
constexpr std::size_t kMostCompared = 8;

std::uint64_t mixed(std::uint64_t hash, std::uint64_t value) {
  hash = (hash ^ value) * 0x9e3779b97f4a7c15ull;
  return hash ^ (hash >> 29);
}

// Properties of a piece that are compared first.
struct Digest {
  std::uint64_t hash = 0;  // of connectivity, densities and weights of seams
  double edges = 0;        // sum of the lengths
  // Tolerance of a length; 0: the piece is too far from the origin.
  double slack = 0;
  std::uint32_t piece = 0;
};

class Finder {
 public:
  Finder(const Topology& topology, std::span<const float> density)
      : topology_(topology),
        density_(density),
        pieces_(topology),
        place_(topology.triangle_count(), kNoIndex),
        name_(topology.points.size(), 0),
        owner_(topology.points.size(), kNoIndex) {}

  PieceCopies run() {
    PieceCopies copies;
    copies.original.resize(topology_.component_count);
    std::vector<Digest> digests;
    digests.reserve(topology_.component_count);
    for (std::uint32_t piece = 0; piece < topology_.component_count; ++piece) {
      copies.original[piece] = piece;
      digests.push_back(digest(piece));
    }
    sort_total(digests.begin(), digests.end(), [](const Digest& a, const Digest& b) {
      if (a.hash != b.hash) return a.hash < b.hash;
      return a.edges != b.edges ? a.edges < b.edges : a.piece < b.piece;
    });
    owner_.assign(owner_.size(), kNoIndex);
    for (std::size_t i = 0; i < digests.size(); ++i) {
      const Digest& own = digests[i];
      if (i == 0 || own.hash != digests[i - 1].hash) originals_.clear();
      if (!(own.slack > 0)) continue;
      const Digest* found = original_of(own);
      if (!found) {
        originals_.push_back(own);
        continue;
      }
      copies.original[own.piece] = found->piece;
      copies.copied_triangles += count(own.piece);
    }
    return copies;
  }

 private:
  std::uint32_t count(std::uint32_t piece) const {
    return pieces_.first[piece + 1] - pieces_.first[piece];
  }
  std::uint32_t triangle(std::uint32_t piece, std::uint32_t i) const {
    return pieces_.triangles[pieces_.first[piece] + i];
  }
  glm::dvec3 point(std::uint32_t h) const {
    return to_dvec(topology_.points[topology_.corner_vertex[h]]);
  }

  Digest digest(std::uint32_t piece) {
    Digest d;
    d.piece = piece;
    const std::uint32_t n = count(piece);
    for (std::uint32_t i = 0; i < n; ++i) place_[triangle(piece, i)] = i;
    glm::dvec3 low(std::numeric_limits<double>::infinity()), high(-low);
    std::uint32_t vertices = 0;
    d.hash = mixed(0, n);
    for (std::uint32_t i = 0; i < n; ++i) {
      const std::uint32_t t = triangle(piece, i);
      if (!density_.empty()) d.hash = mixed(d.hash, std::bit_cast<std::uint32_t>(density_[t]));
      for (std::uint32_t h = 3 * t; h < 3 * t + 3; ++h) {
        const std::uint32_t v = topology_.corner_vertex[h], o = topology_.opposite[h];
        if (owner_[v] != piece) {
          owner_[v] = piece;
          name_[v] = vertices++;
        }
        d.hash = mixed(d.hash, name_[v]);
        if (!topology_.seam_weights.empty())
          d.hash = mixed(d.hash, std::bit_cast<std::uint32_t>(topology_.seam_weights[v]));
        d.hash = mixed(d.hash, o == kNoIndex ? kNoIndex : 3 * place_[o / 3] + o % 3);
        if (topology_.inner(h)) d.hash = mixed(d.hash, 1);
        const glm::dvec3 p = point(h);
        low = glm::min(low, p);
        high = glm::max(high, p);
        d.edges += glm::distance(p, point(next_half_edge(h)));
      }
    }
    const double size = glm::distance(low, high);
    const glm::dvec3 far = glm::max(glm::abs(low), glm::abs(high));
    const double rounding = kRounding * std::max({far.x, far.y, far.z});
    d.slack = rounding < kMostRounding * size ? kTolerance * size + rounding : 0;
    return d;
  }

  // Returns the latest of the originals with about the same sum of edges that the piece repeats.
  const Digest* original_of(const Digest& own) {
    std::size_t compared = 0;
    for (std::size_t i = originals_.size(); i-- > 0 && compared < kMostCompared; ++compared) {
      const double slack = own.slack + originals_[i].slack;
      if (own.edges - originals_[i].edges > 3.0 * count(own.piece) * slack) break;
      if (alike(originals_[i].piece, own.piece, slack)) return &originals_[i];
    }
    return nullptr;
  }

  bool alike(std::uint32_t a, std::uint32_t b, double slack) {
    if (count(a) != count(b)) return false;
    for (std::uint32_t i = 0; i < count(a); ++i) {
      const std::uint32_t ta = triangle(a, i), tb = triangle(b, i);
      if (!density_.empty() && density_[ta] != density_[tb]) return false;
      for (std::uint32_t c = 0; c < 3; ++c) {
        if (!same_corner(3 * ta + c, 3 * tb + c, b) || !same_edge(3 * ta + c, 3 * tb + c, slack)) {
          return false;
        }
      }
    }
    return true;
  }

  // Whether vertices and links correspond. name_ is the corresponding vertex of piece b.
  bool same_corner(std::uint32_t ha, std::uint32_t hb, std::uint32_t b) {
    const std::uint32_t va = topology_.corner_vertex[ha], vb = topology_.corner_vertex[hb];
    if (owner_[va] != b) {
      owner_[va] = b;
      name_[va] = vb;
    }
    if (name_[va] != vb) return false;
    const std::uint32_t oa = topology_.opposite[ha], ob = topology_.opposite[hb];
    if (oa == kNoIndex || ob == kNoIndex) return oa == ob;
    if (topology_.inner(ha) != topology_.inner(hb)) return false;
    return place_[oa / 3] == place_[ob / 3] && oa % 3 == ob % 3;
  }

  // Whether lengths agree, and folds too: how far the triangle across rises, and to which side.
  bool same_edge(std::uint32_t ha, std::uint32_t hb, double slack) const {
    const double la = glm::distance(point(ha), point(next_half_edge(ha)));
    const double lb = glm::distance(point(hb), point(next_half_edge(hb)));
    if (!(std::abs(la - lb) <= slack)) return false;
    const std::uint32_t oa = topology_.opposite[ha], ob = topology_.opposite[hb];
    if (oa == kNoIndex || oa < ha) return true;
    const double wa = glm::distance(point(previous_half_edge(ha)), point(previous_half_edge(oa)));
    const double wb = glm::distance(point(previous_half_edge(hb)), point(previous_half_edge(ob)));
    if (!(std::abs(wa - wb) <= slack)) return false;
    const double ra = rise(ha, oa), rb = rise(hb, ob);
    return ra * rb >= 0 || std::min(std::abs(ra), std::abs(rb)) <= 4 * slack;
  }

  double rise(std::uint32_t h, std::uint32_t o) const {
    return glm::dot(to_dvec(topology_.normals[h / 3]), point(previous_half_edge(o)) - point(h));
  }

  const Topology& topology_;
  std::span<const float> density_;
  PieceList pieces_;
  std::vector<std::uint32_t> place_;         // one per triangle: its index in its piece
  std::vector<std::uint32_t> name_, owner_;  // one per vertex: in the last piece that visited it
  std::vector<Digest> originals_;            // with the current hash, by sum of edges
};

}  // namespace

PieceCopies find_copies(const Topology& topology, std::span<const float> density) {
  return Finder(topology, density).run();
}

ChartCopier::ChartCopier(const FlattenInput& input, const PieceList& pieces)
    : input_(input), pieces_(pieces) {}

bool ChartCopier::copy(const FlatChart& chart, std::uint32_t from, std::uint32_t to,
                       FlatChart& out) const {
  const Topology& topology = input_.topology;
  const auto first = pieces_.triangles.begin() + pieces_.first[from];
  const auto last = pieces_.triangles.begin() + pieces_.first[from + 1];
  out = chart;
  std::vector<Vec3d> positions(chart.uvs.size());
  std::vector<double> density;
  const Vec3f origin =
      topology
          .points[topology.corner_vertex[3 * std::size_t{pieces_.triangles[pieces_.first[to]]}]];
  for (std::size_t i = 0; i < chart.triangles.size(); ++i) {
    const auto place = std::lower_bound(first, last, chart.triangles[i]) - first;
    const std::uint32_t t =
        pieces_.triangles[pieces_.first[to] + static_cast<std::uint32_t>(place)];
    out.triangles[i] = t;
    if (!input_.density.empty()) density.push_back(input_.density[t]);
    for (std::uint32_t c = 0; c < 3; ++c) {
      const std::uint32_t v = topology.corner_vertex[3 * std::size_t{t} + c];
      const Vec3f p = topology.points[v];
      out.vertex[chart.corners[i][c]] = v;
      positions[chart.corners[i][c]] = {double(p.x) - origin.x, double(p.y) - origin.y,
                                        double(p.z) - origin.z};
    }
  }
  out.cone = normal_cone(topology.normals, out.triangles);
  out.distortion = measure_distortion({positions, out.corners, density}, out.uvs);
  const double cone = radians(input_.options.cone_degrees);
  return out.distortion.flips == 0 && out.distortion.degenerate == 0 &&
         (chart.triangles.size() == 1 ||
          out.distortion.stretch_999 <= input_.options.max_stretch) &&
         (cone == 0 || out.cone.angle <= cone);
}

}  // namespace atlas
