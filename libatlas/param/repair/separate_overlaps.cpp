// Finds what overlaps: the arcs of the border between crossings.
#include <algorithm>
#include <cmath>

#include "libatlas/core/portable_math.h"
#include "libatlas/param/repair/separate.h"

namespace atlas::param {
namespace {

constexpr std::size_t longest_arc = 64;        // vertices
constexpr std::size_t most_candidates = 2000;  // half-edges; with more the overlap is not small
constexpr int extra_vertices = 2;  // vertices beyond each end of an overlap, checked as well

// Returns where on ab, from 0 to 1, the line cd meets it.
double meeting_place(glm::dvec2 a, glm::dvec2 b, glm::dvec2 c, glm::dvec2 d) {
  const double from = cross(d - c, a - c), to = cross(d - c, b - c);
  if (from == to) return 0.5;
  return std::clamp(from / (from - to), 0.0, 1.0);
}

}  // namespace

void Separator::map_border(const LocalMesh& mesh) {
  half_edges_.build(mesh);
  half_edges_.border(border_);
  next_.assign(mesh.positions.size(), kNoIndex);
  previous_.assign(mesh.positions.size(), kNoIndex);
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

// Returns the angle that the triangles at a vertex fill in uv, which exceeds a full turn if they
// overlap.
double Separator::corner_angle(std::uint32_t vertex, std::span<const Vec2d> uvs) const {
  double sum = 0;
  for (std::uint32_t i = corners_->first[vertex]; i < corners_->first[vertex + 1]; ++i) {
    const auto v = elements_[corners_->corner[i] / 3].v;
    const std::uint32_t k = corners_->corner[i] % 3;
    const glm::dvec2 p = to_glm(uvs[vertex]);
    const glm::dvec2 a = to_glm(uvs[v[(k + 1) % 3]]) - p, b = to_glm(uvs[v[(k + 2) % 3]]) - p;
    sum += portable::atan2(cross(a, b), glm::dot(a, b));
  }
  return sum;
}

// An arc that returns to the crossing that it came from goes around the end of a slit, where the
// border turns back. Keeps only the bank that it begins with, up to that end.
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

// Finds the arc that leads from half_edge, where it crosses `other`, into the triangles there, up
// to its next crossing. Returns false if it is too long.
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
      if (double(out.within.size()) > longest_arc * fineness_) return false;
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

// Marks, for one arc, its own half-edges and those that cross them.
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

// Returns the area that each boundary loop encloses, counter-clockwise. The sum is the triangles'
// area.
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

// Handles loops that nothing crosses but that turn the wrong way: holes that are inside out.
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
    if (end - begin > 2 * longest_arc * fineness_) return false;
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
    // Both sides move half-way. If one side has no vertices within the other, the other moves all
    // the way.
    draw_out(arcs_[i], arcs_[i ^ 1].within.empty() ? 1.1 : 0.6, uvs);
    mark(arcs_[i], crossings, false);
  }
  return !springs_.empty();
}

}  // namespace atlas::param
