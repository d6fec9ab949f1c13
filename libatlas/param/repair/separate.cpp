#include "libatlas/param/repair/separate.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "libatlas/param/repair/border_check.h"

namespace atlas::param {
namespace {

// Charts with more vertices than fine_chart are fine: an overlap that is small relative to their
// width is many edges deep. In fine charts arcs may be longer, and more rings give way: in
// proportion to the chart's width in edges, or rings_a_depth times the depth of the overlaps in
// edges. With two rings, overlaps of 1.6 edges in charts of 10^6 vertices did not come apart. In
// coarser charts more rings took 4 to 11 % more of all time for as many charts (527 meshes).
constexpr double fine_chart = 20000, rings_a_depth = 10;
constexpr int least_rings = 2, most_rings = 40;
constexpr std::size_t most_crossings = 256;
// More crossings than few_crossings that do not get fewer in a number of rounds could hardly ever
// be removed; a few crossings often could after many rounds (measured on cuts under scan noise).
constexpr std::size_t few_crossings = 4;
constexpr int patience = 3, patience_with_many = 2;
// Borders with this many crossings more than at their best came apart twice in 400 times, and took
// a sixth of all time (measured).
constexpr std::size_t most_growth = 5;
// After `rounds` rounds, the smallest total length of springs in the `recent` last rounds must be
// below `share` of the smallest one before. Of 3000 overlaps in 170 meshes this ended 250 of 490
// that would have stayed and 55 of 1590 that would have come apart; in the second way, 300 and 28
// of 134.
struct Stall {
  std::size_t rounds, recent;
  double share;
};
constexpr Stall first_way{6, 4, 0.9}, second_way{4, 3, 0.7};
// Overlaps where a first spring is longer than this share of the chart's width hardly ever come
// apart within the bound. Leaving them alone spared 88 meshes a tenth of the time, with as many
// charts.
constexpr double longest_pull = 0.1;
constexpr double usual_gain = 0.05;   // of a sweep; settling ends with less
constexpr double gap_of_edge = 0.01;  // the gap to be left, as a share of an edge's length
// If a spring did not reach its goal, it is lengthened by at least this share of its present
// length.
constexpr double drawn_on = 0.5;

// Returns the unit vector to the right of the border's direction, away from its triangles.
glm::dvec2 outward(glm::dvec2 a, glm::dvec2 b) {
  const glm::dvec2 d = b - a;
  const double l = glm::length(d);
  return l > 0 ? glm::dvec2(d.y, -d.x) / l : glm::dvec2(0);
}

bool simple(const Injectivity& border) {
  return border.crossings.empty() && !border.nested;
}

}  // namespace

// Measures the depth against all candidates except the vertex's own arc: where several crossings
// make one overlap, its other side consists of several arcs.
Separator::Depth Separator::depth(std::uint32_t vertex, bool may_be_within, int most_role,
                                  std::span<const Vec2d> uvs) const {
  const std::uint32_t before = half_edges_.from(previous_[vertex]);
  const std::uint32_t after = half_edges_.to(next_[vertex]);
  const glm::dvec2 p = to_glm(uvs[vertex]);
  Depth result{std::numeric_limits<double>::infinity(), 0, glm::dvec2(0)};
  double least = std::numeric_limits<double>::infinity();
  for (const std::uint32_t h : candidates_) {
    if (role_[h] > most_role) continue;
    const std::uint32_t a = half_edges_.from(h), b = half_edges_.to(h);
    if (a == vertex || b == vertex) continue;
    const glm::dvec2 pa = to_glm(uvs[a]), pb = to_glm(uvs[b]), d = pb - pa;
    const double squared = glm::dot(d, d);
    const double t = squared > 0 ? std::clamp(glm::dot(p - pa, d) / squared, 0.0, 1.0) : 0;
    // The near end of a neighbouring edge says nothing about sides.
    if ((t == 0 && (a == before || a == after)) || (t == 1 && (b == before || b == after)))
      continue;
    const glm::dvec2 q = pa + t * d;
    const double distance = glm::length(p - q);
    if (distance >= least) continue;
    least = distance;
    glm::dvec2 out = outward(pa, pb);
    if (t == 0) out += outward(to_glm(uvs[half_edges_.from(previous(h))]), pa);
    if (t == 1) out += outward(pb, to_glm(uvs[half_edges_.to(next(h))]));
    const double norm = glm::length(out);
    if (norm > 0) out /= norm;
    const bool inside = may_be_within && glm::dot(p - q, out) < 0;
    result.margin = gap_of_edge * std::sqrt(squared);
    result.outside = inside ? -distance : distance;
    // The shortest way, unless it is too short to have a reliable direction.
    result.out = distance > 0.1 * result.margin ? (inside ? q - p : p - q) / distance : out;
  }
  return result;
}

void Separator::draw(std::uint32_t vertex, const Depth& depth, double share,
                     std::span<const Vec2d> uvs) {
  if (!(depth.outside < depth.margin)) return;
  const double pull =
      depth.outside < 0 ? depth.margin - share * depth.outside : depth.margin - depth.outside;
  if (place_[vertex] == 0) {
    springs_.push_back({vertex, {}});
    place_[vertex] = static_cast<std::uint32_t>(springs_.size());
  } else if (pull <= pulled_[vertex]) {
    return;
  }
  pulled_[vertex] = pull;
  const auto before = fine() ? targets_.find(vertex) : targets_.end();
  const glm::dvec2 at = to_glm(uvs[vertex]);
  const glm::dvec2 held = before == targets_.end() ? glm::dvec2(0) : to_glm(before->second) - at;
  const double so_far = std::max(0.0, glm::dot(held, depth.out));
  springs_[place_[vertex] - 1].target =
      from_glm(at + held + depth.out * std::max(pull, drawn_on * so_far));
}

// Adds springs that pull the arc's vertices out of the candidates' triangles.
void Separator::draw_out(const Arc& arc, double share, std::span<const Vec2d> uvs) {
  const auto draw_vertex = [&](std::uint32_t v, bool may_be_within) {
    Depth d = depth(v, may_be_within, across_ ? free_edge : crossing_edge, uvs);
    if (!std::isfinite(d.outside)) d = depth(v, may_be_within, crossing_edge, uvs);
    draw(v, d, share, uvs);
  };
  for (const std::uint32_t v : arc.within) draw_vertex(v, true);
  for (const std::uint32_t v : arc.beside) draw_vertex(v, false);
}

// Triangles stay positive all the time, so only the border has to be checked.
Injectivity Separator::check(std::span<const Vec2d> uvs) const {
  Injectivity out;
  check_border({half_edges_, border_}, uvs, {.max_crossings = most_crossings}, out);
  return out;
}

// Spreads the distortion around the moved vertices, with these held where they are.
void Separator::settle(Relaxer& relaxer, double least_gain, std::span<Vec2d> uvs) {
  constexpr int rings = 10, sweeps = 30;
  saved_.assign(uvs.begin(), uvs.end());
  std::sort(moved_.begin(), moved_.end());
  springs_.clear();
  for (const std::uint32_t v : moved_) springs_.push_back({v, uvs[v]});
  relaxer.pull(elements_, *corners_, {springs_, rings, sweeps, least_gain}, uvs);
  if (!simple(check(uvs))) std::copy(saved_.begin(), saved_.end(), uvs.begin());
}

// Returns the length of the longest current spring.
double Separator::longest() const {
  double longest = 0;
  for (const Relaxer::Spring& s : springs_) longest = std::max(longest, pulled_[s.vertex]);
  return longest;
}

// Returns how many rings give way to the current springs.
int Separator::rings(std::span<const Vec2d> uvs) const {
  if (!fine()) return least_rings;
  double edges = 0;
  for (const std::uint32_t h : candidates_) {
    edges += glm::distance(to_glm(uvs[half_edges_.from(h)]), to_glm(uvs[half_edges_.to(h)]));
  }
  const double deep = longest() * double(candidates_.size());  // times the edges' mean length
  if (!(deep * rings_a_depth < edges * most_rings)) return most_rings;
  return std::max(int(least_rings * fineness_), int(std::lround(rings_a_depth * deep / edges)));
}

// Springs yield to the vertices that they pull. A spring therefore starts where the last one ended,
// not where that left its vertex, and so gets there in the end. Vertices that need no further pull
// are held; they would fall back otherwise. In coarser charts holding spared 13 of 31 402 charts
// (527 meshes), but stretched what came apart so much that 3 more of 81 ramps with a tooth over
// their beginning were divided.
void Separator::hold_moved() {
  for (const Relaxer::Spring& s : springs_) {
    if (targets_.insert_or_assign(s.vertex, s.target).second) moved_.push_back(s.vertex);
  }
  if (!fine()) return;
  for (const std::uint32_t v : moved_) {
    if (place_[v] == 0) springs_.push_back({v, targets_.at(v)});
  }
}

// Whether the current springs are too long to begin with, or those of recent rounds are hardly
// shorter than earlier ones.
bool Separator::stalled() {
  double pull = 0;
  for (const Relaxer::Spring& s : springs_) pull += pulled_[s.vertex];
  pulls_.push_back(pull);
  deep_ = deep_ || (!across_ && pulls_.size() == 1 && longest() > longest_pull * width_);
  if (deep_) return true;
  const Stall& stall = across_ ? second_way : first_way;
  if (pulls_.size() <= stall.rounds) return false;
  const auto recent = pulls_.end() - static_cast<std::ptrdiff_t>(stall.recent);
  return *std::min_element(recent, pulls_.end()) >=
         stall.share * *std::min_element(pulls_.begin(), recent);
}

bool Separator::draw_until_simple(Relaxer& relaxer, std::span<Vec2d> uvs) {
  // More sweeps per round, or more rings, let the rest of intricate borders drift into new
  // crossings: with five rings seventeen meshes took a tenth more time for a hundredth more charts.
  constexpr int rounds = 16, sweeps_a_ring = 6;
  std::size_t fewest = most_crossings;
  int last_gain = 0;
  saved_.assign(uvs.begin(), uvs.end());
  moved_.clear();
  targets_.clear();
  pulls_.clear();
  for (int round = 0; round <= rounds; ++round) {
    const Injectivity now = check(uvs);
    if (simple(now)) {
      if (round > 0) settle(relaxer, usual_gain, uvs);
      return true;
    }
    if (left_.empty() || now.crossings.size() < left_.size()) left_ = now.crossings;
    if (now.crossings.size() < fewest) {
      fewest = now.crossings.size();
      last_gain = round;
    }
    if (fewest >= most_crossings || now.crossings.size() > fewest + most_growth) break;
    const int limit = fewest > 2 * few_crossings ? patience_with_many : patience;
    if (fewest > few_crossings && round - last_gain >= limit) break;
    if (round == rounds || !collect(now.crossings, uvs) || stalled()) break;
    const int wide = rings(uvs);
    hold_moved();
    relaxer.pull(elements_, *corners_, {springs_, wide, sweeps_a_ring * wide}, uvs);
  }
  std::copy(saved_.begin(), saved_.end(), uvs.begin());
  return false;
}

void Separator::take(const LocalMesh& mesh, ElementView elements, const CornerLists& corners) {
  elements_ = elements;
  corners_ = &corners;
  fineness_ = std::max(1.0, std::sqrt(double(mesh.positions.size()) / fine_chart));
  map_border(mesh);
}

bool Separator::separate(Relaxer& relaxer, std::span<Vec2d> uvs) {
  left_.clear();
  const std::vector<double> areas = loop_areas(uvs);
  width_ = std::sqrt(std::max(0.0, std::accumulate(areas.begin(), areas.end(), 0.0)));
  deep_ = false;
  // The first way takes the nearest way out. Near the corner of a band that lies on another, this
  // leads across the edge that crosses the band, along the overlap and not out of it. The second
  // way therefore excludes such edges.
  for (const bool across : {false, true}) {
    across_ = across;
    if (draw_until_simple(relaxer, uvs)) return true;
    if (deep_ || left_.size() > 2 * few_crossings) break;
  }
  return false;
}

}  // namespace atlas::param
