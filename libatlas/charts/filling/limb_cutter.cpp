#include "libatlas/charts/filling/limb_cutter.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>
#include <span>
#include <utility>

#include "libatlas/charts/filling/chord_paths.h"
#include "libatlas/charts/filling/chords.h"
#include "libatlas/charts/filling/middle_cut.h"
#include "libatlas/core/hull.h"
#include "libatlas/core/portable_math.h"
#include "libatlas/core/sort_total.h"
#include "libatlas/param/mesh/halfedges.h"

namespace atlas {
namespace {

constexpr std::size_t kMostPieces = 32;
// This many charts pack closely, whatever their rectangles, once they fill kHullFill of their
// convex hulls. With this rule 157 meshes have as many charts as with at most a dozen pieces, and
// the worst page is filled to 0.67 instead of 0.63.
constexpr std::size_t kMany = 12;
constexpr double kHullFill = 0.75;
constexpr double kLeastFall = 0.01;     // of the chart's sprawl by one cut
constexpr double kLeastPiece = 0.0005;  // of the chart's area
// The share of the rectangles' area that a seam as long as the square root of the chart's area must
// gain.
constexpr double kSeamPrice = 0.12;
constexpr std::size_t kChordsTried = 12;
// A piece that leaves this share of its hull empty when no chord is left is a frame, or bent. If
// its rectangle covers at least kFrameBox of all charts' area, it is divided near its middle even
// without gain, after all cuts that pay by themselves (hence the low score). Smaller frames nest in
// each other: when they were cut as well, two parts of concentric rings had half as many charts
// again.
constexpr double kFrame = 0.25, kFrameBox = 0.05, kFrameScore = 1e-9;
// The most holes of a frame: dividing a sieve into 32 pieces only gives smaller sieves.
constexpr std::size_t kMostHoles = 100;

using Triangles = std::vector<std::uint32_t>;  // indices into the chart's triangles

// Cuts one flat chart into pieces.
class LimbCutter {
 public:
  LimbCutter(const FlatChart& chart, const LimbLimits& limits, const Context& context)
      : chart_(chart),
        all_charts_(limits.all_charts),
        context_(context),
        polygons_(limits.polygons),
        half_edges_(built(chart)),
        piece_of_(chart.triangles.size(), 0),
        paths_(chart, half_edges_, piece_of_, polygons_, context) {
    const std::size_t n = chart.triangles.size();
    side_.resize(n);
    seen_.resize(3 * n);
    blocked_.assign(3 * n, 0);
    Piece whole;
    for (std::uint32_t t = 0; t < n; ++t) whole.triangles.push_back(t);
    measure(whole, 0);
    least_fall_ = kLeastFall * whole.sprawl;
    pieces_.push_back(std::move(whole));
  }

  // Returns the triangles of each piece, ascending; empty if cutting does not pay.
  std::vector<Triangles> run(double wanted) {
    const double box = pieces_[0].box, area = pieces_[0].area;
    // Rectangles never cover less than their pieces do.
    const double most_gain = box - area, price = kSeamPrice * box / std::sqrt(area);
    while (!filled(wanted) && pieces_.size() < kMostPieces && price * seam_ <= most_gain) {
      if (!cut_best() || context_.cancelled()) break;
    }
    heal(std::max(boxes(), area / wanted));
    std::vector<Triangles> result;
    if (pieces_.size() == 1 || context_.cancelled()) return result;
    double seam = 0;
    for (const auto& [pair, length] : seams()) seam += length;
    if (box - boxes() < price * seam) return result;
    for (Piece& piece : pieces_) result.push_back(std::move(piece.triangles));
    sort_total(result.begin(), result.end(),
               [](const Triangles& a, const Triangles& b) { return a.front() < b.front(); });
    return result;
  }

 private:
  struct Piece {
    Triangles triangles;
    std::vector<std::uint32_t> outline;  // uvs along the loop that encloses most area
    std::vector<Vec2d> corners;          // of its convex hull
    std::size_t borders = 0;
    double area = 0, hull = 0, box = 0, sprawl = 0;
    bool searched = false;
    double score = 0, length = 0;  // of its best cut; no score: none
    std::vector<Triangles> parts;  // by that cut
  };

  bool filled(double wanted) const {
    double area = 0, hulls = 0;
    for (const Piece& piece : pieces_) {
      area += piece.area;
      hulls += piece.hull;
    }
    return area >= wanted * boxes() || (pieces_.size() >= kMany && area >= kHullFill * hulls);
  }

  static param::HalfEdges built(const FlatChart& chart) {
    param::HalfEdges half_edges;
    half_edges.build(chart.corners, chart.uvs.size());
    return half_edges;
  }

  double boxes() const {
    double sum = 0;
    for (const Piece& piece : pieces_) sum += piece.box;
    return sum;
  }

  std::uint32_t uv_at(std::uint32_t h) const { return chart_.corners[h / 3][h % 3]; }

  // Returns the half-edge opposite to h, if it is in the same piece.
  std::uint32_t across(std::uint32_t h) const {
    const std::uint32_t o = half_edges_.opposite(h);
    return o != kNoIndex && piece_of_[o / 3] == piece_of_[h / 3] ? o : kNoIndex;
  }

  // Computes what follows from the triangles, and assigns these to the piece with that number.
  void measure(Piece& piece, std::uint32_t number) {
    piece.area = 0;
    piece.borders = 0;
    for (const std::uint32_t t : piece.triangles) {
      const auto& c = chart_.corners[t];
      piece.area += 0.5 * cross(chart_.uvs[c[0]], chart_.uvs[c[1]], chart_.uvs[c[2]]);
      piece_of_[t] = number;
    }
    for (const std::uint32_t t : piece.triangles) std::fill_n(&seen_[3 * t], 3, 0);
    double most = 0;
    for (const std::uint32_t t : piece.triangles) {
      for (std::uint32_t h = 3 * t; h < 3 * t + 3; ++h) {
        if (seen_[h] || across(h) != kNoIndex) continue;
        std::vector<std::uint32_t> loop = trace(h);
        ++piece.borders;
        const double area = signed_area(loop);
        if (area <= most) continue;
        most = area;
        piece.outline = std::move(loop);
      }
    }
    std::vector<Vec2d> points = positions(piece.outline);
    piece.hull = hull_area(points, piece.corners);
    piece.box = box_area(piece.corners);
    piece.sprawl = sprawl(piece.hull, piece.box);
    piece.searched = false;
    piece.score = 0;
  }

  std::vector<std::uint32_t> trace(std::uint32_t start) {
    std::vector<std::uint32_t> loop;
    std::uint32_t h = start;
    do {
      seen_[h] = 1;
      loop.push_back(uv_at(h));
      h = next_half_edge(h);
      while (across(h) != kNoIndex) h = next_half_edge(across(h));
    } while (h != start);
    return loop;
  }

  std::vector<Vec2d> positions(const std::vector<std::uint32_t>& uvs) const {
    std::vector<Vec2d> points;
    points.reserve(uvs.size());
    for (const std::uint32_t i : uvs) points.push_back(chart_.uvs[i]);
    return points;
  }

  double signed_area(const std::vector<std::uint32_t>& loop) const {
    double twice = 0;
    for (std::size_t i = 2; i < loop.size(); ++i) {
      twice += cross(chart_.uvs[loop[0]], chart_.uvs[loop[i - 1]], chart_.uvs[loop[i]]);
    }
    return 0.5 * twice;
  }

  bool cut_best() {
    std::size_t best = pieces_.size();
    for (std::size_t i = 0; i < pieces_.size(); ++i) {
      if (context_.cancelled()) return false;
      if (!pieces_[i].searched) search(pieces_[i]);
      if (pieces_[i].score > 0 &&
          (best == pieces_.size() || pieces_[i].score > pieces_[best].score))
        best = i;
    }
    if (best == pieces_.size()) return false;
    seam_ += pieces_[best].length;
    std::vector<Triangles> parts = std::move(pieces_[best].parts);
    std::vector<std::size_t> numbers;
    for (Triangles& part : parts) {
      const std::size_t number = numbers.empty() ? best : pieces_.size();
      if (!numbers.empty()) pieces_.emplace_back();
      for (const std::uint32_t t : part) piece_of_[t] = std::uint32_t(number);
      pieces_[number] = {};
      pieces_[number].triangles = std::move(part);
      numbers.push_back(number);
    }
    for (const std::size_t number : numbers) measure(pieces_[number], std::uint32_t(number));
    return true;
  }

  void search(Piece& piece) {
    piece.searched = true;
    const std::vector<Vec2d> outline = positions(piece.outline);
    const ChordPaths::Piece place{piece.triangles, piece.outline};
    const std::vector<Chord> chords =
        find_chords(outline, paths_.edges_across(place), least_fall_, context_);
    for (std::size_t i = 0; i < std::min(chords.size(), kChordsTried); ++i) {
      const std::vector<std::uint32_t> path =
          paths_.find(place, piece.outline[chords[i].a], piece.outline[chords[i].b]);
      if (path.empty() || !divide(piece, path)) continue;
      piece.score = chords[i].score;
      piece.length = length_of(path);
      return;
    }
    const double waste = piece.hull - piece.area;
    if (waste > kFrame * piece.hull && piece.box > kFrameBox * all_charts_ &&
        piece.borders <= kMostHoles) {
      divide_frame(piece);
    }
  }

  void divide_frame(Piece& piece) {
    MiddleCut cut = cut_middle(chart_, half_edges_, piece.triangles,
                               {kLeastPiece * chart_area(), least_fall_, polygons_, &context_});
    if (cut.parts.empty()) return;
    piece.length = cut.length;
    piece.score = cut.fall >= least_fall_ ? cut.fall / cut.length
                                          : kFrameScore * (piece.hull - piece.area) / chart_area();
    piece.parts = std::move(cut.parts);
  }

  // Fills piece.parts with the two sides of the path. Returns false if one of them is too small.
  bool divide(Piece& piece, const std::vector<std::uint32_t>& path) {
    const auto block = [&](std::uint8_t value) {
      for (const std::uint32_t h : path) blocked_[h] = blocked_[half_edges_.opposite(h)] = value;
    };
    block(1);
    for (const std::uint32_t t : piece.triangles) side_[t] = 0;
    Triangles queue{path.front() / 3};
    side_[queue[0]] = 1;
    for (std::size_t i = 0; i < queue.size(); ++i) {
      for (std::uint32_t h = 3 * queue[i]; h < 3 * queue[i] + 3; ++h) {
        const std::uint32_t o = across(h);
        if (o == kNoIndex || blocked_[h] || side_[o / 3]) continue;
        side_[o / 3] = 1;
        queue.push_back(o / 3);
      }
    }
    block(0);
    piece.parts.assign(2, {});
    double area[2] = {0, 0};
    for (const std::uint32_t t : piece.triangles) {
      const auto& c = chart_.corners[t];
      piece.parts[side_[t]].push_back(t);
      area[side_[t]] += 0.5 * cross(chart_.uvs[c[0]], chart_.uvs[c[1]], chart_.uvs[c[2]]);
    }
    return std::min(area[0], area[1]) > kLeastPiece * (chart_area());
  }

  double length_of(const std::vector<std::uint32_t>& path) const {
    double length = 0;
    for (const std::uint32_t h : path) {
      length += distance(chart_.uvs[half_edges_.from(h)], chart_.uvs[half_edges_.to(h)]);
    }
    return length;
  }

  double chart_area() const { return chart_.distortion.uv_area; }

  // Returns the length of the cut between each two pieces.
  std::map<std::pair<std::uint32_t, std::uint32_t>, double> seams() const {
    std::map<std::pair<std::uint32_t, std::uint32_t>, double> lengths;
    for (std::uint32_t h = 0; h < 3 * piece_of_.size(); ++h) {
      const std::uint32_t o = half_edges_.opposite(h);
      if (o == kNoIndex) continue;
      const std::uint32_t p = piece_of_[h / 3], q = piece_of_[o / 3];
      const Vec2d &a = chart_.uvs[uv_at(h)], &b = chart_.uvs[uv_at(next_half_edge(h))];
      if (p < q) lengths[{p, q}] += portable::hypot(b.x - a.x, b.y - a.y);
    }
    return lengths;
  }

  // Joins pieces again, those first whose seam is longest for the harm, while the sum of the
  // rectangles stays within `most`.
  void heal(double most) {
    while (pieces_.size() > 1) {
      double best = 0;
      std::pair<std::uint32_t, std::uint32_t> join{0, 0};
      const double now = boxes();
      if (context_.cancelled()) return;
      for (const auto& [pair, seam] : seams()) {
        const Piece &p = pieces_[pair.first], &q = pieces_[pair.second];
        std::vector<Vec2d> points = p.corners, hull;
        points.insert(points.end(), q.corners.begin(), q.corners.end());
        hull_area(points, hull);
        const double harm = std::max(1e-3 * now, box_area(hull) - p.box - q.box);
        if (now + harm > most || seam / harm <= best) continue;
        best = seam / harm;
        join = pair;
      }
      if (best == 0) return;
      unite(join.first, join.second);
    }
  }

  void unite(std::uint32_t p, std::uint32_t q) {
    Triangles both;
    std::merge(pieces_[p].triangles.begin(), pieces_[p].triangles.end(),
               pieces_[q].triangles.begin(), pieces_[q].triangles.end(), std::back_inserter(both));
    pieces_[p].triangles = std::move(both);
    for (const std::uint32_t t : pieces_[p].triangles) piece_of_[t] = p;
    measure(pieces_[p], p);
    if (q + 1 < pieces_.size()) {
      pieces_[q] = std::move(pieces_.back());
      for (const std::uint32_t t : pieces_[q].triangles) piece_of_[t] = q;
    }
    pieces_.pop_back();
  }

  const FlatChart& chart_;
  double all_charts_;  // area of all charts
  const Context& context_;
  std::span<const std::uint32_t> polygons_;
  param::HalfEdges half_edges_;
  std::vector<std::uint32_t> piece_of_;  // one per triangle of the chart
  ChordPaths paths_;
  std::vector<std::uint8_t> side_;            // one per triangle: its side of a path
  std::vector<std::uint8_t> seen_, blocked_;  // one per half-edge
  std::vector<Piece> pieces_;
  double least_fall_ = 0;
  double seam_ = 0;  // length of all cuts made
};

}  // namespace

std::vector<std::vector<std::uint32_t>> limbs_of(const FlatChart& chart, const LimbLimits& limits,
                                                 const Context& context) {
  return LimbCutter(chart, limits, context).run(limits.wanted);
}

}  // namespace atlas
