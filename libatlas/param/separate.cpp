#include "libatlas/param/separate.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "libatlas/core/predicates.h"

namespace atlas::param {
namespace {

constexpr std::size_t longest_arc = 48;

glm::dvec2 nearest_on_segment(glm::dvec2 p, glm::dvec2 a, glm::dvec2 b) {
  const glm::dvec2 d = b - a;
  const double squared = glm::dot(d, d);
  const double t = squared > 0 ? std::clamp(glm::dot(p - a, d) / squared, 0.0, 1.0) : 0;
  return a + t * d;
}

}  // namespace

void Separator::map_border(const LocalMesh& mesh) {
  half_edges_.build(mesh);
  half_edges_.border(border_);
  next_.assign(mesh.positions.size(), HalfEdges::none);
  previous_.assign(mesh.positions.size(), HalfEdges::none);
  for (const std::uint32_t h : border_.half_edges) {
    next_[half_edges_.from(h)] = h;
    previous_[half_edges_.to(h)] = h;
  }
}

// From the end of half_edge that lies on the inner side of `other`, along the border to the next
// crossing.
bool Separator::walk(std::uint32_t half_edge, std::uint32_t other, std::span<const Vec2d> uvs,
                     Arc& out) {
  out.vertices.clear();
  out.half_edges.assign(1, half_edge);
  const Vec2d a = uvs[half_edges_.from(other)], b = uvs[half_edges_.to(other)];
  const bool forward = orientation(a, b, uvs[half_edges_.to(half_edge)]) > 0;
  if (!forward && orientation(a, b, uvs[half_edges_.from(half_edge)]) <= 0) return true;
  std::uint32_t h = half_edge;
  for (std::size_t step = 0; step < longest_arc; ++step) {
    const std::uint32_t v = forward ? half_edges_.to(h) : half_edges_.from(h);
    out.vertices.push_back(v);
    h = forward ? next_[v] : previous_[v];
    out.half_edges.push_back(h);
    if (crosses_[h]) return true;
  }
  return false;
}

// Springs that draw from's vertices towards the nearest points of `to`.
void Separator::attract(const Arc& from, const Arc& to, std::span<const Vec2d> uvs) {
  // Both sides move; a side that has no vertices within the overlap cannot, and the other goes all
  // the way.
  const double share = to.vertices.empty() ? 1.2 : 0.65;
  for (const std::uint32_t v : from.vertices) {
    const glm::dvec2 p = to_glm(uvs[v]);
    double least = std::numeric_limits<double>::infinity(), length = 0;
    glm::dvec2 target = p;
    for (const std::uint32_t h : to.half_edges) {
      const std::uint32_t a = half_edges_.from(h), b = half_edges_.to(h);
      if (a == v || b == v) continue;
      const glm::dvec2 q = nearest_on_segment(p, to_glm(uvs[a]), to_glm(uvs[b]));
      const double d = glm::length(q - p);
      if (d >= least) continue;
      least = d;
      length = glm::length(to_glm(uvs[b]) - to_glm(uvs[a]));
      // A few thousandths of the edge beyond: the gap that is left in the end.
      target = p + (q - p) * (share + (d > 0 ? std::min(0.01 * length / d, 10.0) : 0));
    }
    if (!std::isfinite(least)) continue;
    if (place_[v] == 0) {
      springs_.push_back({v, from_glm(target)});
      place_[v] = static_cast<std::uint32_t>(springs_.size());
      distance_[v] = least;
    } else if (least < distance_[v]) {
      springs_[place_[v] - 1].target = from_glm(target);
      distance_[v] = least;
    }
  }
}

bool Separator::collect(std::span<const BorderCrossing> crossings, std::span<const Vec2d> uvs) {
  springs_.clear();
  place_.assign(uvs.size(), 0);
  distance_.resize(uvs.size());
  std::uint32_t largest = 0;
  for (const std::uint32_t h : border_.half_edges) largest = std::max(largest, h);
  crosses_.assign(largest + 1, 0);
  for (const BorderCrossing& c : crossings) {
    crosses_[next_[c.a[0]]] = 1;
    crosses_[next_[c.b[0]]] = 1;
  }
  for (const BorderCrossing& c : crossings) {
    const std::uint32_t e = next_[c.a[0]], f = next_[c.b[0]];
    if (!walk(e, f, uvs, arc_[0]) || !walk(f, e, uvs, arc_[1])) return false;
    attract(arc_[0], arc_[1], uvs);
    attract(arc_[1], arc_[0], uvs);
  }
  return !springs_.empty();
}

bool Separator::separate(const LocalMesh& mesh, std::span<const Element> elements,
                         const CornerLists& corners, Relaxer& relaxer, std::span<Vec2d> uvs) {
  constexpr int rounds = 12;
  constexpr std::size_t most_crossings = 256;
  map_border(mesh);
  saved_.assign(uvs.begin(), uvs.end());
  for (int round = 0; round <= rounds; ++round) {
    const Injectivity check = check_injectivity(mesh, uvs, {.max_crossings = most_crossings});
    if (check.injective) return true;
    if (!check.flipped.empty() || check.nested || check.crossings.size() >= most_crossings) break;
    if (round == rounds || !collect(check.crossings, uvs)) break;
    relaxer.pull(elements, corners, springs_, uvs);
  }
  std::copy(saved_.begin(), saved_.end(), uvs.begin());
  return false;
}

}  // namespace atlas::param
