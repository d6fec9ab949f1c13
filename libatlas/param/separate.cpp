#include "libatlas/param/separate.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "libatlas/param/border_check.h"

namespace atlas::param {
namespace {

constexpr std::size_t longest_arc = 64;
constexpr std::size_t most_crossings = 256;
constexpr std::size_t most_candidates =
    2000;  // half-edges; beyond it is no little overlap any more
// More crossings than these that do not get fewer in so many rounds hardly ever came apart; a few
// often did after many rounds (measured on cuts under scan noise).
constexpr std::size_t few_crossings = 4;
constexpr int patience = 3, patience_with_many = 2;
// What came to so many crossings more than at its best came apart twice in 400 times, and took a
// sixth of all the time (measured).
constexpr std::size_t most_growth = 5;
// After so many rounds, the least that the springs of the recent ones pull, all together, must be
// below this share of the least before. Of 3000 overlaps in 170 meshes this ended 250 of 490 that
// would have stayed, 55 of 1590 that would not, and the second way 300 and 28 of 134.
struct Stall {
  std::size_t rounds, recent;
  double share;
};
constexpr Stall first_way{6, 4, 0.9}, second_way{4, 3, 0.7};
// Overlaps of which a spring at first reaches further than this share of the chart's width hardly
// ever come apart within the bound: leaving them alone spared 88 meshes a tenth of the time, with
// as many charts.
constexpr double longest_pull = 0.1;
constexpr int extra_vertices = 2;     // looked after beyond the ends of an overlap
constexpr double usual_gain = 0.05;   // of a sweep, with which settling ends
constexpr double gap_of_edge = 0.01;  // the gap left, as part of an edge's length

// Where, from 0 to 1 along ab, the line cd meets it.
double meeting_place(glm::dvec2 a, glm::dvec2 b, glm::dvec2 c, glm::dvec2 d) {
  const double from = cross(d - c, a - c), to = cross(d - c, b - c);
  if (from == to) return 0.5;
  return std::clamp(from / (from - to), 0.0, 1.0);
}

// The unit vector to the right of the border's direction, away from its triangles.
glm::dvec2 outward(glm::dvec2 a, glm::dvec2 b) {
  const glm::dvec2 d = b - a;
  const double l = glm::length(d);
  return l > 0 ? glm::dvec2(d.y, -d.x) / l : glm::dvec2(0);
}

bool simple(const Injectivity& border) {
  return border.crossings.empty() && !border.nested;
}

}  // namespace

void Separator::map_border(const LocalMesh& mesh) {
  half_edges_.build(mesh);
  half_edges_.border(border_);
  next_.assign(mesh.positions.size(), HalfEdges::none);
  previous_.assign(mesh.positions.size(), HalfEdges::none);
  role_.assign(3 * mesh.triangles.size(), free_edge);
  for (const std::uint32_t h : border_.half_edges) {
    next_[half_edges_.from(h)] = h;
    previous_[half_edges_.to(h)] = h;
  }
}

bool Separator::collides(std::uint32_t half_edge) const {
  const auto m = std::lower_bound(meetings_.begin(), meetings_.end(), Meeting{half_edge, 0});
  return m != meetings_.end() && m->half_edge == half_edge;
}

void Separator::widen(Arc& arc, std::uint32_t first, std::uint32_t last) const {
  for (int i = 0; i < extra_vertices; ++i) {
    arc.beside.push_back(half_edges_.from(first));
    arc.beside.push_back(half_edges_.to(last));
    first = previous(first);
    last = next(last);
  }
}

// The angle that the triangles at a vertex fill in uv; beyond a full turn if they overlap there.
double Separator::corner_angle(std::uint32_t vertex, std::span<const Vec2d> uvs) const {
  double sum = 0;
  for (std::uint32_t i = corners_->first[vertex]; i < corners_->first[vertex + 1]; ++i) {
    const auto v = elements_[corners_->corner[i] / 3].v;
    const std::uint32_t k = corners_->corner[i] % 3;
    const glm::dvec2 p = to_glm(uvs[vertex]);
    const glm::dvec2 a = to_glm(uvs[v[(k + 1) % 3]]) - p, b = to_glm(uvs[v[(k + 2) % 3]]) - p;
    sum += std::atan2(cross(a, b), glm::dot(a, b));
  }
  return sum;
}

// A stretch that returns to the very crossing it came from goes round the end of a slit, where the
// border turns back: keep the bank that it begins with, up to there.
void Separator::keep_one_bank(Arc& arc, std::span<const Vec2d> uvs) const {
  std::size_t end = 0;
  double widest = 0;
  for (std::size_t i = 0; i < arc.within.size(); ++i) {
    const double angle = corner_angle(arc.within[i], uvs);
    if (angle <= widest) continue;
    widest = angle;
    end = i;
  }
  arc.within.resize(end);
  arc.half_edges.resize(end + 1);
}

// The stretch of border that goes through half_edge, where it crosses `other`, into the triangles
// there, up to its next crossing.
bool Separator::reach(std::uint32_t half_edge, std::uint32_t other, std::span<const Vec2d> uvs,
                      Arc& out) {
  const auto from = [&](std::uint32_t h) { return to_glm(uvs[half_edges_.from(h)]); };
  const auto to = [&](std::uint32_t h) { return to_glm(uvs[half_edges_.to(h)]); };
  out.half_edges.assign(1, half_edge);
  out.within.clear();
  out.beside.clear();
  const double side_from = cross(to(other) - from(other), from(half_edge) - from(other));
  const double side_to = cross(to(other) - from(other), to(half_edge) - from(other));
  const bool forward = side_to > side_from;
  const double along = meeting_place(from(half_edge), to(half_edge), from(other), to(other));
  auto m = std::lower_bound(meetings_.begin(), meetings_.end(), Meeting{half_edge, along});
  const bool leaves_at_once =
      forward ? m != meetings_.end() && m + 1 != meetings_.end() && (m + 1)->half_edge == half_edge
              : m != meetings_.begin() && (m - 1)->half_edge == half_edge;
  std::uint32_t h = half_edge;
  if (!leaves_at_once) {
    do {
      if (out.within.size() > longest_arc) return false;
      out.within.push_back(forward ? half_edges_.to(h) : half_edges_.from(h));
      h = forward ? next(h) : previous(h);
      out.half_edges.push_back(h);
    } while (!collides(h) && h != half_edge);
  }
  if (h == other) {
    keep_one_bank(out, uvs);
    h = out.half_edges.back();
  }
  widen(out, forward ? half_edge : h, forward ? h : half_edge);
  return true;
}

// Measured against all the stretches but the vertex's own: where several crossings make one
// overlap, its other side is put together from them.
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
    // The shortest way, unless it is too short to have a direction.
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
  springs_[place_[vertex] - 1].target = from_glm(to_glm(uvs[vertex]) + depth.out * pull);
}

// Draws the stretch's vertices out of the candidates' triangles.
void Separator::draw_out(const Arc& arc, double share, std::span<const Vec2d> uvs) {
  const auto draw_vertex = [&](std::uint32_t v, bool may_be_within) {
    Depth d = depth(v, may_be_within, across_ ? free_edge : crossing_edge, uvs);
    if (!std::isfinite(d.outside)) d = depth(v, may_be_within, crossing_edge, uvs);
    draw(v, d, share, uvs);
  };
  for (const std::uint32_t v : arc.within) draw_vertex(v, true);
  for (const std::uint32_t v : arc.beside) draw_vertex(v, false);
}

// Marks, for one stretch, its own half-edges and those that cross them.
void Separator::mark(const Arc& arc, std::span<const BorderCrossing> crossings, bool set) {
  for (const std::uint32_t h : arc.half_edges) role_[h] = set ? own_edge : free_edge;
  for (const BorderCrossing& c : crossings) {
    const std::uint32_t e = next_[c.a[0]], f = next_[c.b[0]];
    if (!set) {
      role_[e] = role_[f] = free_edge;
    } else if (role_[e] == own_edge && role_[f] != own_edge) {
      role_[f] = crossing_edge;
    } else if (role_[f] == own_edge && role_[e] != own_edge) {
      role_[e] = crossing_edge;
    }
  }
}

// What each loop of the border goes around, counter-clockwise; together what the triangles cover.
std::vector<double> Separator::loop_areas(std::span<const Vec2d> uvs) const {
  std::vector<double> area(border_.loop_start.size() - 1, 0);
  for (std::size_t l = 0; l < area.size(); ++l) {
    const std::uint32_t begin = border_.loop_start[l], end = border_.loop_start[l + 1];
    const glm::dvec2 origin = to_glm(uvs[half_edges_.from(border_.half_edges[begin])]);
    for (std::uint32_t i = begin; i < end; ++i) {
      const std::uint32_t h = border_.half_edges[i];
      area[l] += 0.5 * cross(to_glm(uvs[half_edges_.from(h)]) - origin,
                             to_glm(uvs[half_edges_.to(h)]) - origin);
    }
  }
  return area;
}

// Loops that nothing crosses but that turn the wrong way: a hole pulled inside out.
bool Separator::collect_turned_loops(std::span<const Vec2d> uvs) {
  const std::vector<double> area = loop_areas(uvs);
  const std::size_t loops = area.size();
  std::size_t outer = 0;
  for (std::size_t l = 0; l < loops; ++l) {
    if (std::abs(area[l]) > std::abs(area[outer])) outer = l;
  }
  if (loops == 0 || !(area[outer] > 0)) return false;
  for (std::size_t l = 0; l < loops; ++l) {
    const std::uint32_t begin = border_.loop_start[l], end = border_.loop_start[l + 1];
    if (l == outer || area[l] < 0) continue;
    if (end - begin > 2 * longest_arc) return false;
    candidates_.assign(border_.half_edges.begin() + begin, border_.half_edges.begin() + end);
    Arc loop;
    for (const std::uint32_t h : candidates_) loop.within.push_back(half_edges_.from(h));
    draw_out(loop, 0.6, uvs);
  }
  return !springs_.empty();
}

bool Separator::collect(std::span<const BorderCrossing> crossings, std::span<const Vec2d> uvs) {
  springs_.clear();
  place_.assign(uvs.size(), 0);
  pulled_.resize(uvs.size());
  if (crossings.empty()) return collect_turned_loops(uvs);
  meetings_.clear();
  for (const BorderCrossing& c : crossings) {
    const glm::dvec2 a = to_glm(uvs[c.a[0]]), b = to_glm(uvs[c.a[1]]);
    const glm::dvec2 p = to_glm(uvs[c.b[0]]), q = to_glm(uvs[c.b[1]]);
    meetings_.push_back({next_[c.a[0]], meeting_place(a, b, p, q)});
    meetings_.push_back({next_[c.b[0]], meeting_place(p, q, a, b)});
  }
  std::sort(meetings_.begin(), meetings_.end());
  arcs_.resize(2 * crossings.size());
  candidates_.clear();
  for (std::size_t i = 0; i < crossings.size(); ++i) {
    const std::uint32_t e = next_[crossings[i].a[0]], f = next_[crossings[i].b[0]];
    if (!reach(e, f, uvs, arcs_[2 * i]) || !reach(f, e, uvs, arcs_[2 * i + 1])) return false;
    for (const std::size_t k : {2 * i, 2 * i + 1}) {
      candidates_.insert(candidates_.end(), arcs_[k].half_edges.begin(), arcs_[k].half_edges.end());
    }
  }
  std::sort(candidates_.begin(), candidates_.end());
  candidates_.erase(std::unique(candidates_.begin(), candidates_.end()), candidates_.end());
  if (candidates_.size() > most_candidates) return false;
  for (std::size_t i = 0; i < arcs_.size(); ++i) {
    mark(arcs_[i], crossings, true);
    // Both sides move half-way; a side that has no vertices within the other cannot.
    draw_out(arcs_[i], arcs_[i ^ 1].within.empty() ? 1.1 : 0.6, uvs);
    mark(arcs_[i], crossings, false);
  }
  return !springs_.empty();
}

// Triangles stay positive all the time, so the border alone decides.
Injectivity Separator::check(std::span<const Vec2d> uvs) const {
  Injectivity out;
  check_border(half_edges_, border_, uvs, {.max_crossings = most_crossings}, out);
  return out;
}

// Lets the distortion of what moved spread, with the border held where it is now.
void Separator::settle(Relaxer& relaxer, double least_gain, std::span<Vec2d> uvs) {
  constexpr int rings = 10, sweeps = 30;
  saved_.assign(uvs.begin(), uvs.end());
  std::sort(moved_.begin(), moved_.end());
  moved_.erase(std::unique(moved_.begin(), moved_.end()), moved_.end());
  springs_.clear();
  for (const std::uint32_t v : moved_) springs_.push_back({v, uvs[v]});
  relaxer.pull(elements_, *corners_, {springs_, rings, sweeps, least_gain}, uvs);
  if (!simple(check(uvs))) std::copy(saved_.begin(), saved_.end(), uvs.begin());
}

// Whether the springs at hand are too long to begin with; or, as those of the rounds before, hardly
// shorter than earlier ones.
bool Separator::stalled() {
  double pull = 0, longest = 0;
  for (const Relaxer::Spring& s : springs_) {
    pull += pulled_[s.vertex];
    longest = std::max(longest, pulled_[s.vertex]);
  }
  pulls_.push_back(pull);
  deep_ = deep_ || (!across_ && pulls_.size() == 1 && longest > longest_pull * width_);
  if (deep_) return true;
  const Stall& stall = across_ ? second_way : first_way;
  if (pulls_.size() <= stall.rounds) return false;
  const auto recent = pulls_.end() - static_cast<std::ptrdiff_t>(stall.recent);
  return *std::min_element(recent, pulls_.end()) >=
         stall.share * *std::min_element(pulls_.begin(), recent);
}

bool Separator::draw_until_simple(Relaxer& relaxer, std::span<Vec2d> uvs) {
  // More sweeps a round, or wider rings, would let the rest of the border drift into new crossings:
  // with five rings seventeen intricate meshes took a tenth more time for a hundredth more charts.
  constexpr int rounds = 16, rings = 2, sweeps = 12;
  std::size_t fewest = most_crossings;
  int last_gain = 0;
  saved_.assign(uvs.begin(), uvs.end());
  moved_.clear();
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
    for (const Relaxer::Spring& s : springs_) moved_.push_back(s.vertex);
    relaxer.pull(elements_, *corners_, {springs_, rings, sweeps}, uvs);
  }
  std::copy(saved_.begin(), saved_.end(), uvs.begin());
  return false;
}

bool Separator::separate(const LocalMesh& mesh, ElementView elements, const CornerLists& corners,
                         Relaxer& relaxer, std::span<Vec2d> uvs) {
  elements_ = elements;
  corners_ = &corners;
  map_border(mesh);
  left_.clear();
  const std::vector<double> areas = loop_areas(uvs);
  width_ = std::sqrt(std::max(0.0, std::accumulate(areas.begin(), areas.end(), 0.0)));
  deep_ = false;
  // The nearest way out first. Near the corner of a band that lies on another that way leads across
  // the edge that crosses the band, along the overlap and not out of it; so it is closed the second
  // time.
  for (const bool across : {false, true}) {
    across_ = across;
    if (draw_until_simple(relaxer, uvs)) return true;
    if (deep_ || left_.size() > 2 * few_crossings) break;
  }
  return false;
}

}  // namespace atlas::param
