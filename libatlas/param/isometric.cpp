#include "libatlas/param/isometric.h"

#include <algorithm>
#include <cassert>
#include <limits>

#include "libatlas/param/workspace.h"

namespace atlas {
namespace {

using namespace param;

// Up to this many vertices the envelope solver is the fastest (measured).
constexpr std::size_t envelope_limit = 1500;

void rotations_from_frames(const LocalMesh& mesh, std::span<const Element> elements,
                           std::span<const std::array<Vec3d, 2>> frames, Rotations& out) {
  out.resize(elements.size());
  for (std::size_t t = 0; t < elements.size(); ++t) {
    const auto& v = elements[t].v;
    const glm::dvec3 p = to_glm(mesh.positions[v[0]]);
    const glm::dvec3 e = to_glm(mesh.positions[v[1]]) - p, f = to_glm(mesh.positions[v[2]]) - p;
    const double squared = glm::dot(e, e);
    const glm::dvec3 up = squared > 0 ? f - e * (glm::dot(f, e) / squared) : glm::dvec3(0);
    const double base = std::sqrt(squared), height = glm::length(up);
    const glm::dvec3 x = base > 0 ? e / base : glm::dvec3(0);
    const glm::dvec3 y = height > 0 ? up / height : glm::dvec3(0);
    const glm::dvec3 a = to_glm(frames[t][0]), b = to_glm(frames[t][1]);
    out[t] = nearest_rotation({{glm::dot(a, x), glm::dot(b, x)}, {glm::dot(a, y), glm::dot(b, y)}});
  }
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

// The unit vector from a to b, both corners of e, in e's rest plane.
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

// Unfolds triangle after triangle, breadth-first, each along the edge by which it was reached.
void carry_rotations(const LocalMesh& mesh, ParamWorkspace::Impl& w) {
  w.half_edges.build(mesh);
  w.rotations.assign(mesh.triangles.size(), glm::dvec2(0));
  const auto flood = [&](std::uint32_t start) {
    w.rotations[start] = {1, 0};
    w.queue.assign(1, start);
    for (std::size_t i = 0; i < w.queue.size(); ++i) {
      const std::uint32_t t = w.queue[i];
      for (std::uint32_t h = 3 * t; h < 3 * t + 3; ++h) {
        const std::uint32_t g = w.half_edges.opposite(h);
        if (g == HalfEdges::none) continue;
        const std::uint32_t other = HalfEdges::triangle(g);
        if (w.rotations[other] != glm::dvec2(0)) continue;
        const std::uint32_t a = w.half_edges.from(h), b = w.half_edges.to(h);
        const glm::dvec2 here = edge_direction(w.elements[t], a, b);
        const glm::dvec2 there = edge_direction(w.elements[other], a, b);
        // rotation of other = rotation of t * here / there, as complex numbers of unit length
        const glm::dvec2 r = w.rotations[t];
        const glm::dvec2 turn(glm::dot(here, there), cross(there, here));
        const glm::dvec2 carried(r.x * turn.x - r.y * turn.y, r.x * turn.y + r.y * turn.x);
        w.rotations[other] = carried / glm::length(carried);
        w.queue.push_back(other);
      }
    }
  };
  flood(middle_triangle(mesh));
  for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t) {
    if (w.rotations[t] == glm::dvec2(0)) flood(t);  // a second piece, against the precondition
  }
}

void write(std::span<const glm::dvec2> from, std::span<Vec2d> to) {
  for (std::size_t v = 0; v < to.size(); ++v) to[v] = from_glm(from[v]);
}

}  // namespace

ParamWorkspace::ParamWorkspace() : impl_(std::make_unique<Impl>()) {}
ParamWorkspace::~ParamWorkspace() = default;
ParamWorkspace::ParamWorkspace(ParamWorkspace&&) noexcept = default;
ParamWorkspace& ParamWorkspace::operator=(ParamWorkspace&&) noexcept = default;

IsometricResult flatten_isometric(const LocalMesh& mesh, const IsometricStart& start,
                                  const IsometricOptions& options, std::span<Vec2d> uvs,
                                  ParamWorkspace& workspace) {
  assert(uvs.size() == mesh.positions.size() && !mesh.triangles.empty());
  ParamWorkspace::Impl& w = workspace.impl();
  build_elements(mesh, options.min_altitude, w.elements);
  w.corners.build(w.elements, mesh.positions.size());
  build_stiffness(w.elements, w.corners, w.stiffness);
  const bool small = mesh.positions.size() <= envelope_limit || !w.direct.factorize(w.stiffness);
  if (small) w.envelope.factorize(w.stiffness);
  if (!start.uvs.empty()) {
    local_rotations(w.elements, start.uvs, w.rotations);
  } else if (!start.frames.empty()) {
    rotations_from_frames(mesh, w.elements, start.frames, w.rotations);
  } else {
    carry_rotations(mesh, w);
  }
  w.load.resize(uvs.size());
  w.solution.resize(uvs.size());
  for (int i = 0; i < std::max(options.iterations, 1); ++i) {
    if (i > 0) local_rotations(w.elements, uvs, w.rotations);
    rotation_load(w.elements, w.rotations, w.load);
    if (small) {
      w.envelope.solve(w.load, w.solution);
    } else {
      w.direct.solve(w.load, w.solution);
    }
    write(w.solution, uvs);
  }
  return measure_energy(w.elements, uvs);
}

}  // namespace atlas
