#include "libatlas/charts/tiles.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <numeric>
#include <utility>

#include "libatlas/charts/chart_set_check.h"
#include "libatlas/charts/chart_triangles.h"
#include "libatlas/charts/filling/line_cut.h"
#include "libatlas/charts/flattening/part_of_chart.h"
#include "libatlas/charts/totals.h"
#include "libatlas/core/bounds.h"
#include "libatlas/core/glm_bridge.h"
#include "libatlas/core/hull.h"
#include "libatlas/core/parallel.h"
#include "libatlas/param/mesh/halfedges.h"

namespace atlas {
namespace {

// How far a cut may stray to be short, relative to a piece's even share of the length: as far as
// the piece stays within its limit, but between kLeastBand and kMostBand.
constexpr double kLeastBand = 0.1, kMostBand = 0.25, kNoBand = 1e-9;
// A piece this many times as long as its triangles is not cut: its parts would be hardly shorter.
// At 1, the rounding of a quarter of a disc decides whether it is cut again. A few triangles are
// cut all the same, since the light of each is linear, and needs few texels: a lit room of 360
// triangles, most of them in walls of two, takes a quarter of the texels, at 61.7 instead of 59.9
// dB.
constexpr double kHardlyLonger = 1.25;
constexpr std::size_t kFewTriangles = 8;
// Parts below this share of a piece's area stay with the other side of a cut.
constexpr double kCrumb = 0.01;

using Box = Bounds<glm::dvec2>;

Box box_of(std::span<const Vec2d> uvs) {
  Box box;
  for (const Vec2d& p : uvs) box.add(to_glm(p));
  return box;
}

double longer_side(const Box& box) {
  return std::max(box.size().x, box.size().y);
}

// Returns the mean length of a piece's triangles, weighted by their areas; 0 without area.
double mean_length(const FlatChart& piece) {
  double sum = 0, area = 0;
  for (const auto& [a, b, c] : piece.corners) {
    const double twice = std::abs(cross(piece.uvs[a], piece.uvs[b], piece.uvs[c]));
    const glm::dvec2 p = to_glm(piece.uvs[a]), q = to_glm(piece.uvs[b]), r = to_glm(piece.uvs[c]);
    sum += twice * std::max({glm::distance(p, q), glm::distance(q, r), glm::distance(r, p)});
    area += twice;
  }
  return area > 0 ? sum / area : 0;
}

bool names_uv_twice(const std::array<std::uint32_t, 3>& c) {
  return c[0] == c[1] || c[1] == c[2] || c[2] == c[0];
}

struct TileLimit {
  double side, max_stretch;  // see TileLimits
};

// Cuts one chart into pieces.
class Tiler {
 public:
  // Given charts are not turned.
  Tiler(const MeshView& mesh, const TileLimit& limit, bool given)
      : mesh_(mesh), limit_(limit.side), max_stretch_(limit.max_stretch), given_(given) {}

  // Returns the pieces, in the order of the cuts, each measured.
  std::vector<FlatChart> run(FlatChart chart) {
    cut(std::move(chart));
    return std::move(pieces_);
  }

 private:
  void cut(FlatChart piece) {
    const Box box = box_of(piece.uvs);
    const bool few = piece.triangles.size() <= kFewTriangles;
    const double limit = few ? limit_ : std::max(limit_, kHardlyLonger * mean_length(piece));
    if (longer_side(box) <= limit && keeps_to_bound(piece)) {
      pieces_.push_back(std::move(piece));
      return;
    }
    const std::vector<std::vector<std::uint32_t>> parts = divide(piece, box);
    // A single triangle, or no cut separates anything.
    if (parts.empty()) {
      keeps_to_bound(piece);
      pieces_.push_back(std::move(piece));
      return;
    }
    for (const std::vector<std::uint32_t>& part : parts) {
      FlatChart smaller = take_triangles(piece, part);
      if (!given_) turn_for_packing(smaller);
      cut(std::move(smaller));
    }
  }

  std::vector<std::vector<std::uint32_t>> divide(const FlatChart& piece, const Box& box) const {
    std::vector<std::uint32_t> all(piece.triangles.size());
    std::iota(all.begin(), all.end(), 0u);
    param::HalfEdges half_edges;
    half_edges.build(piece.corners, piece.uvs.size());
    LineCutter cutter(piece, half_edges, all, mesh_.polygons);
    const glm::dvec2 size = box.size();
    const int axis = size.x >= size.y ? 0 : 1;
    cutter.face(axis == 0 ? 0 : std::numbers::pi / 2);
    const double shares = std::max(2.0, std::ceil(size[axis] / limit_));
    const double share = size[axis] / shares, line = box.low[axis] + share * std::ceil(shares / 2);
    const double band = std::clamp(limit_ / share - 1, kLeastBand, kMostBand) * share;
    const double crumb = kCrumb * size.x * size.y / shares;
    LineCut cut = cutter.cut(line, band, crumb);
    // Triangles as large as the piece are divided by their centroids.
    if (cut.parts.empty()) {
      cut = cutter.cut((cutter.low() + cutter.high()) / 2, kNoBand * share, 0);
    }
    std::vector<std::vector<std::uint32_t>> parts;
    for (LineCut::Part& part : cut.parts) parts.push_back(std::move(part.triangles));
    return parts;
  }

  bool keeps_to_bound(FlatChart& piece) const {
    std::vector<Vec3f> positions;
    for (const std::uint32_t v : piece.vertex) positions.push_back(mesh_.positions[v]);
    std::vector<double> density;
    if (!mesh_.density.empty()) {
      for (const std::uint32_t t : piece.triangles) density.push_back(mesh_.density[t]);
    }
    keep_to_bound({PositionView(positions, positions[0]), piece.corners, density}, max_stretch_,
                  piece);
    return piece.distortion.stretch_999 <= max_stretch_ || piece.triangles.size() == 1;
  }

  const MeshView& mesh_;
  double limit_, max_stretch_;
  bool given_;
  std::vector<FlatChart> pieces_;
};

// Builds the new chart set, chart by chart, with some charts divided.
class Rebuilder {
 public:
  Rebuilder(const MeshView& mesh, const ChartSet& old) : mesh_(mesh), old_(old), fresh_(old) {
    fresh_.charts.clear();
    fresh_.chart_triangles.clear();
    fresh_.uvs.clear();
    fresh_.uv_vertex.clear();
    opposite_.assign(old.triangle_chart.size(), 0);
    for (const std::uint32_t t : old.flipped_triangles) {
      if (t < opposite_.size()) opposite_[t] = 1;
    }
  }

  void keep(const Chart& old) {
    Chart chart = old;
    chart.first_triangle = std::uint32_t(fresh_.chart_triangles.size());
    chart.first_uv = std::uint32_t(fresh_.uvs.size());
    for (std::uint32_t i = 0; i < old.uv_count; ++i) {
      fresh_.uvs.push_back(old_.uvs[old.first_uv + i]);
      fresh_.uv_vertex.push_back(old_.uv_vertex[old.first_uv + i]);
    }
    for (const std::uint32_t t : triangles_of(old_, old)) {
      take(t);
      for (std::size_t k = 3 * std::size_t{t}; k < 3 * std::size_t{t} + 3; ++k) {
        fresh_.triangle_uv[k] = old_.triangle_uv[k] - old.first_uv + chart.first_uv;
      }
    }
    fresh_.charts.push_back(chart);
  }

  // A chart's pieces, one at most if it stays whole. May be called for several charts at once.
  std::vector<FlatChart> pieces_of(const Chart& old, double limit, double max_stretch) const {
    FlatChart whole = flat(old);
    if (whole.triangles.empty()) return {};
    // Given charts keep their shapes, and charts beyond the bound need not keep to it.
    const bool bounded = !old.kept && old.distortion.stretch_999 <= max_stretch;
    if (!bounded) max_stretch = std::numeric_limits<double>::infinity();
    return Tiler(mesh_, {limit, max_stretch}, old.kept).run(std::move(whole));
  }

  void divide(const Chart& old, std::vector<FlatChart> pieces) {
    const std::vector<OwnedEdge> edges = edges_of(pieces);
    fresh_.seam_length += length_between(edges);
    std::vector<std::vector<std::uint32_t>> loose = loose_triangles(old, pieces, edges);
    for (std::size_t i = 0; i < pieces.size(); ++i) add(old, pieces[i], loose[i]);
  }

  ChartSet finish() {
    fresh_.distortion = total_distortion(fresh_.charts);
    return std::move(fresh_);
  }

 private:
  std::array<std::uint32_t, 3> old_uvs(std::uint32_t t) const {
    const std::uint32_t* const c = &old_.triangle_uv[3 * std::size_t{t}];
    return {c[0], c[1], c[2]};
  }
  void take(std::uint32_t t) {
    fresh_.chart_triangles.push_back(t);
    fresh_.triangle_chart[t] = std::uint32_t(fresh_.charts.size());
  }

  // Once local_ has the new numbers of a triangle's uvs.
  void name_uvs(std::uint32_t t) {
    for (std::size_t k = 3 * std::size_t{t}; k < 3 * std::size_t{t} + 3; ++k)
      fresh_.triangle_uv[k] = local_[old_.triangle_uv[k]];
  }

  // Returns the triangles that cover something in uv. Vertices are those of the mesh.
  FlatChart flat(const Chart& chart) const {
    FlatChart flat;
    for (std::uint32_t i = chart.first_uv; i < chart.first_uv + chart.uv_count; ++i) {
      flat.uvs.push_back(old_.uvs[i]);
      flat.vertex.push_back(old_.uv_vertex[i]);
    }
    for (const std::uint32_t t : triangles_of(old_, chart)) {
      std::array<std::uint32_t, 3> corners = old_uvs(t);
      if (names_uv_twice(corners)) continue;
      if (opposite_[t]) std::swap(corners[1], corners[2]);
      corners = from_lowest(corners);
      for (std::uint32_t& c : corners) c -= chart.first_uv;
      flat.triangles.push_back(t);
      flat.corners.push_back(corners);
    }
    return flat;
  }

  // A piece's edge, as uvs of the old set.
  using UvEdge = std::array<std::uint32_t, 2>;
  static UvEdge edge(std::uint32_t a, std::uint32_t b) { return {std::min(a, b), std::max(a, b)}; }
  struct OwnedEdge {
    UvEdge uvs;
    std::uint32_t piece;
    bool operator<(const OwnedEdge& other) const {
      return uvs != other.uvs ? uvs < other.uvs : piece < other.piece;
    }
  };

  std::vector<OwnedEdge> edges_of(const std::vector<FlatChart>& pieces) const {
    std::vector<OwnedEdge> edges;
    for (std::uint32_t i = 0; i < pieces.size(); ++i) {
      for (const std::uint32_t t : pieces[i].triangles) {
        const auto c = old_uvs(t);
        for (int k = 0; k < 3; ++k) edges.push_back({edge(c[k], c[(k + 1) % 3]), i});
      }
    }
    std::sort(edges.begin(), edges.end());
    return edges;
  }

  // Returns the length on the surface of the edges along which a chart was cut.
  double length_between(const std::vector<OwnedEdge>& edges) const {
    double length = 0;
    for (std::size_t i = 1; i < edges.size(); ++i) {
      const OwnedEdge &a = edges[i - 1], &b = edges[i];
      if (a.uvs != b.uvs || a.piece == b.piece) continue;
      length += glm::distance(to_dvec(mesh_.positions[old_.uv_vertex[a.uvs[0]]]),
                              to_dvec(mesh_.positions[old_.uv_vertex[a.uvs[1]]]));
    }
    return length;
  }

  // Assigns triangles without area to pieces on whose edge or corner they lie. One list per piece.
  std::vector<std::vector<std::uint32_t>> loose_triangles(
      const Chart& chart, const std::vector<FlatChart>& pieces,
      const std::vector<OwnedEdge>& edges) const {
    std::vector<std::vector<std::uint32_t>> loose(pieces.size());
    std::vector<std::uint32_t> piece_of(chart.uv_count, 0);
    for (std::uint32_t i = std::uint32_t(pieces.size()); i-- > 0;) {
      for (const std::uint32_t t : pieces[i].triangles) {
        for (const std::uint32_t uv : old_uvs(t)) piece_of[uv - chart.first_uv] = i;
      }
    }
    for (const std::uint32_t t : triangles_of(old_, chart)) {
      const auto c = old_uvs(t);
      if (!names_uv_twice(c)) continue;
      std::uint32_t piece = piece_of[c[0] - chart.first_uv];
      const UvEdge on = c[0] != c[1] ? edge(c[0], c[1]) : edge(c[1], c[2]);
      const auto found = std::lower_bound(edges.begin(), edges.end(), OwnedEdge{on, 0});
      if (found != edges.end() && found->uvs == on) piece = found->piece;
      loose[piece].push_back(t);
    }
    return loose;
  }

  void add(const Chart& parent, FlatChart& piece, std::span<const std::uint32_t> loose) {
    Chart chart = parent;
    lay_along_u(piece, chart);
    chart.distortion = piece.distortion;
    chart.first_triangle = std::uint32_t(fresh_.chart_triangles.size());
    chart.triangle_count = std::uint32_t(piece.triangles.size() + loose.size());
    chart.first_uv = std::uint32_t(fresh_.uvs.size());
    chart.uv_count = std::uint32_t(piece.uvs.size());
    fresh_.uvs.insert(fresh_.uvs.end(), piece.uvs.begin(), piece.uvs.end());
    fresh_.uv_vertex.insert(fresh_.uv_vertex.end(), piece.vertex.begin(), piece.vertex.end());
    const std::size_t first = fresh_.chart_triangles.size();
    for (std::size_t i = 0; i < piece.triangles.size(); ++i) {
      const std::uint32_t t = piece.triangles[i];
      take(t);
      std::array<std::uint32_t, 3> old = old_uvs(t);
      if (opposite_[t]) std::swap(old[1], old[2]);
      old = from_lowest(old);
      for (std::size_t k = 0; k < 3; ++k) local_[old[k]] = chart.first_uv + piece.corners[i][k];
      name_uvs(t);
    }
    for (const std::uint32_t t : loose) {
      take(t);
      name_uvs(t);
    }
    if (!mesh_.materials.empty()) chart.material = mesh_.materials[fresh_.chart_triangles[first]];
    fresh_.charts.push_back(chart);
  }

  static void lay_along_u(FlatChart& piece, Chart& chart) {
    const Box box = box_of(piece.uvs);
    const glm::dvec2 size = box.size();
    const bool turn = size.y > size.x;
    for (Vec2d& p : piece.uvs) {
      p = turn ? Vec2d{box.high.y - p.y, p.x - box.low.x} : Vec2d{p.x - box.low.x, p.y - box.low.y};
    }
    chart.size = {std::max(size.x, size.y), std::min(size.x, size.y)};
  }

  const MeshView& mesh_;
  const ChartSet& old_;
  ChartSet fresh_;
  // One per triangle: its orientation is opposite to its chart's.
  std::vector<std::uint8_t> opposite_;
  std::vector<std::uint32_t> local_ = std::vector<std::uint32_t>(old_.uvs.size(), kNoIndex);
};

// Charts whose pieces are made at a time have about so many triangles together, which bounds what
// pieces take besides the charts themselves.
constexpr std::size_t kTrianglesAtOnce = std::size_t{1} << 20;

// The end of the charts from `first` on that are cut at a time.
std::size_t end_of_batch(const std::vector<Chart>& charts, std::size_t first) {
  std::size_t end = first, triangles = 0;
  while (end < charts.size() && triangles < kTrianglesAtOnce)
    triangles += charts[end++].triangle_count;
  return end;
}

Status check(const MeshView& mesh, const TileLimits& limits, const ChartSet& charts) {
  const std::vector<Chart>& old = charts.charts;
  if (limits.sides.size() != old.size())
    return {ErrorCode::bad_input,
            fmt::format("tiles: {} limits for {} charts", limits.sides.size(), old.size())};
  for (std::size_t c = 0; c < old.size(); ++c) {
    if (!(limits.sides[c] > 0) && old[c].size.x > 0)
      return {ErrorCode::bad_input,
              fmt::format("tiles: the limit of chart {} is {} (above 0)", c, limits.sides[c])};
  }
  if (!(limits.max_stretch > 1))
    return {ErrorCode::bad_option,
            fmt::format("tiles: max_stretch is {} (above 1)", limits.max_stretch)};
  if (charts.triangle_chart.size() != mesh.indices.size() / 3)
    return {ErrorCode::bad_input,
            fmt::format("tiles: the charts are not those of the mesh: {} triangle_chart for {} "
                        "triangles",
                        charts.triangle_chart.size(), mesh.indices.size() / 3)};
  return check_chart_set(mesh, charts, "tiles");
}

}  // namespace

Result<std::size_t> cut_to_limits(const MeshView& mesh, const TileLimits& limits, ChartSet& charts,
                                  const Context& context) {
  if (Status s = check(mesh, limits, charts); !s.ok()) return s;
  const std::vector<Chart>& old = charts.charts;
  const auto too_long = [&](std::size_t c) { return old[c].size.x > limits.sides[c]; };
  std::size_t first = 0;
  while (first < old.size() && !too_long(first)) ++first;
  if (first == old.size()) return std::size_t{0};
  Rebuilder fresh(mesh, charts);
  std::size_t count = 0;
  for (std::size_t begin = 0, end = 0; begin < old.size(); begin = end) {
    end = end_of_batch(old, begin);
    std::vector<std::vector<FlatChart>> pieces(end - begin);
    parallel_for(context, end - begin, 1, [&](std::size_t i, std::size_t) {
      if (!too_long(begin + i)) return;
      pieces[i] = fresh.pieces_of(old[begin + i], limits.sides[begin + i], limits.max_stretch);
    });
    if (context.cancelled()) return Status::cancelled();
    for (std::size_t i = 0; i < pieces.size(); ++i) {
      if (pieces[i].size() < 2) {
        fresh.keep(old[begin + i]);
        continue;
      }
      fresh.divide(old[begin + i], std::move(pieces[i]));
      ++count;
    }
  }
  charts = fresh.finish();
  return count;
}

}  // namespace atlas
