#include "libatlas/param/descent/first_rotations.h"

#include <array>
#include <limits>

#include "libatlas/param/descent/workspace.h"

namespace atlas::param {
namespace {

// Seen edge-on or from behind, a triangle has no rotation near its map. The smaller singular value
// must be more than a quarter of the larger one, which holds within about 75 degrees of the view.
bool trustworthy(const Jacobian& j) {
  return j.det() > 4.0 / 17 * (glm::dot(j.x, j.x) + glm::dot(j.y, j.y));
}

// Returns the map of an element that a frame implies, times the element's length.
Jacobian map_of_frame(const LocalMesh& mesh, const Element& e, const std::array<Vec3f, 2>& frame) {
  const glm::dvec3 p = to_glm(mesh.positions[e.v[0]]), a = to_dvec(frame[0]), b = to_dvec(frame[1]);
  const glm::dvec3 base = to_glm(mesh.positions[e.v[1]]) - p;
  const glm::dvec3 side = to_glm(mesh.positions[e.v[2]]) - p;
  const glm::dvec2 x(glm::dot(a, base), glm::dot(b, base));
  const glm::dvec2 y(glm::dot(a, side), glm::dot(b, side));
  return {x, (e.length * y - e.foot * x) / e.altitude};
}

std::uint32_t middle_triangle(const LocalMesh& mesh) {
  glm::dvec3 centre(0);
  const auto middle = [&](const std::array<std::uint32_t, 3>& tri) {
    return (to_glm(mesh.positions[tri[0]]) + to_glm(mesh.positions[tri[1]]) +
            to_glm(mesh.positions[tri[2]])) /
           3.0;
  };
  for (const auto& tri : mesh.triangles) centre += middle(tri);
  centre /= static_cast<double>(mesh.triangles.size());
  std::uint32_t best = 0;
  double least = std::numeric_limits<double>::infinity();
  for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t) {
    const glm::dvec3 d = middle(mesh.triangles[t]) - centre;
    if (glm::dot(d, d) < least) {
      least = glm::dot(d, d);
      best = t;
    }
  }
  return best;
}

// Returns the unit vector from a to b, both corners of e, in e's rest plane.
glm::dvec2 edge_direction(const Element& e, std::uint32_t a, std::uint32_t b) {
  const auto place = [&](std::uint32_t v) {
    return v == e.v[0]   ? glm::dvec2(0)
           : v == e.v[1] ? glm::dvec2(e.length, 0)
                         : glm::dvec2(e.foot, e.altitude);
  };
  const glm::dvec2 d = place(b) - place(a);
  const double l = glm::length(d);
  return l > 0 ? d / l : glm::dvec2(1, 0);
}

// Returns the rotation of the triangle across half-edge h that unfolds it along that edge.
glm::dvec2 carried(const ParamWorkspace::Impl& w, std::uint32_t h) {
  const std::uint32_t t = HalfEdges::triangle(h);
  const std::uint32_t other = HalfEdges::triangle(w.half_edges.opposite(h));
  const std::uint32_t a = w.half_edges.from(h), b = w.half_edges.to(h);
  const glm::dvec2 here = edge_direction(w.elements[t], a, b);
  const glm::dvec2 there = edge_direction(w.elements[other], a, b);
  // Rotation of `other` = rotation of t * here / there, as complex numbers of unit length.
  const glm::dvec2 r(w.rotations[t]);
  const glm::dvec2 turn(glm::dot(here, there), cross(there, here));
  return glm::normalize(glm::dvec2(r.x * turn.x - r.y * turn.y, r.x * turn.y + r.y * turn.x));
}

// Gives a rotation to every triangle whose rotation is (0, 0), breadth-first from w.queue: each is
// unfolded along the edge by which it is reached.
void flood_rotations(ParamWorkspace::Impl& w) {
  for (std::size_t i = 0; i < w.queue.size(); ++i) {
    const std::uint32_t t = w.queue[i];
    for (std::uint32_t h = 3 * t; h < 3 * t + 3; ++h) {
      const std::uint32_t g = w.half_edges.opposite(h);
      if (g == kNoIndex || w.rotations[HalfEdges::triangle(g)] != glm::vec2(0)) continue;
      w.rotations[HalfEdges::triangle(g)] = carried(w, h);
      w.queue.push_back(HalfEdges::triangle(g));
    }
  }
}

// Gives triangles that were left without a rotation, since their map was doubtful, that of their
// neighbours.
void complete_rotations(const LocalMesh& mesh, ParamWorkspace::Impl& w) {
  w.queue.clear();
  bool complete = true;
  for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t) {
    complete &= w.rotations[t] != glm::vec2(0);
  }
  if (complete) return;
  w.half_edges.build(mesh);
  for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t) {
    if (w.rotations[t] != glm::vec2(0)) w.queue.push_back(t);
  }
  if (w.queue.empty()) return carry_rotations(mesh, w);
  flood_rotations(w);
  for (glm::vec2& r : w.rotations) {
    if (r == glm::vec2(0)) r = {1, 0};
  }
}

}  // namespace

void carry_rotations(const LocalMesh& mesh, ParamWorkspace::Impl& w) {
  w.half_edges.build(mesh);
  w.rotations.assign(mesh.triangles.size(), glm::vec2(0));
  const auto flood = [&](std::uint32_t start) {
    w.rotations[start] = {1, 0};
    w.queue.assign(1, start);
    flood_rotations(w);
  };
  flood(middle_triangle(mesh));
  for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t) {
    if (w.rotations[t] == glm::vec2(0)) flood(t);  // a second piece, against the precondition
  }
}

void rotations_from_frames(const LocalMesh& mesh, const FrameView& frames,
                           ParamWorkspace::Impl& w) {
  w.rotations.resize(w.elements.size());
  for (std::size_t t = 0; t < w.elements.size(); ++t) {
    const Jacobian j = map_of_frame(mesh, w.elements[t], frames(t));
    w.rotations[t] = trustworthy(j) ? glm::vec2(nearest_rotation(j)) : glm::vec2(0);
  }
  complete_rotations(mesh, w);
}

}  // namespace atlas::param
