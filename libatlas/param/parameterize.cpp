#include "libatlas/param/parameterize.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "libatlas/core/glm_bridge.h"
#include "libatlas/core/is_enumerator.h"
#include "libatlas/core/is_finite.h"
#include "libatlas/core/no_index.h"
#include "libatlas/param/descent/arap_solver.h"
#include "libatlas/param/descent/descent.h"
#include "libatlas/param/descent/flatten_disc.h"
#include "libatlas/param/descent/judge.h"
#include "libatlas/param/descent/planar.h"

namespace atlas {
namespace param {
namespace {

// Writes the projection along `axis` to uvs. Returns its distortion if that is within the bound.
std::optional<Distortion> project(const LocalMesh& mesh, Vec3d axis, double bound,
                                  std::span<Vec2d> uvs) {
  // At the area-preserving scale the square root of this product is 1 / s2 of every triangle.
  if (mesh.density.empty() && !(bound * bound * projected_share(mesh, axis) >= 1)) return {};
  project_planar(mesh, axis, uvs);
  const Distortion d = measure_distortion(mesh, uvs);
  if (!is_within(d, bound) || d.flips > 0) return {};
  return d;
}

// Up to this power of two, and down to its inverse, the fourth powers of lengths, and of much
// shorter ones beside them, are doubles with all their digits.
constexpr int kUsualPower = 100;

// Returns the power of two by which lengths are divided if the largest has this magnitude.
int excess_power(double largest) {
  if (!(largest > 0)) return 0;
  const int power = std::ilogb(largest);
  return std::abs(power) <= kUsualPower ? 0 : power;
}

double largest_coordinate(const Vec3d& p) {
  return std::max({std::abs(p.x), std::abs(p.y), std::abs(p.z)});
}

Vec3d divided(const Vec3d& p, int power) {
  return {std::ldexp(p.x, -power), std::ldexp(p.y, -power), std::ldexp(p.z, -power)};
}

Vec3d axis_for(const LocalMesh& mesh, const FlattenOptions& options) {
  const Vec3d& axis = options.axis;
  const double largest = largest_coordinate(axis);
  const bool usable = largest > 0 && std::isfinite(axis.x + axis.y + axis.z);
  return usable ? divided(axis, excess_power(largest)) : mean_normal(mesh);
}

// Flattens the mesh in a unit of 2^power.
ParamResult flatten_in_unit(const LocalMesh& mesh, ParamOptions options, int power,
                            ParamWorkspace& workspace) {
  std::vector<Vec3d> positions(mesh.positions.size());
  for (std::size_t v = 0; v < positions.size(); ++v) {
    positions[v] = divided(mesh.positions[v], power);
  }
  const auto in_unit = [](std::span<const Vec2d> uvs, int by) {
    std::vector<Vec2d> scaled;
    for (const Vec2d uv : uvs) scaled.push_back({std::ldexp(uv.x, by), std::ldexp(uv.y, by)});
    return scaled;
  };
  LocalMesh near = mesh;
  near.positions = positions;
  const std::vector<Vec2d> start = in_unit(options.start.uvs, -power);
  options.start.uvs = start;
  options.min_altitude = std::ldexp(options.min_altitude, -power);
  ParamResult r = flatten_disc(near, {options}, workspace);
  r.uvs = in_unit(r.uvs, power);
  r.distortion.surface_area = std::ldexp(r.distortion.surface_area, 2 * power);
  r.distortion.uv_area = std::ldexp(r.distortion.uv_area, 2 * power);
  return r;
}

ParamResult with_room(const LocalMesh& mesh) {
  ParamResult r;
  r.uvs.resize(mesh.positions.size());
  return r;
}

// Returns the projection along `axis` if it was asked for, or is good enough.
std::optional<ParamResult> projection(const LocalMesh& mesh, Vec3d axis,
                                      const FlattenOptions& options) {
  if (options.method == ParamMethod::isometric) return {};
  ParamResult r = with_room(mesh);
  r.planar = true;
  if (options.method == ParamMethod::planar) {
    project_planar(mesh, axis, r.uvs);
    judge(mesh, options, r);
    return r;
  }
  const double bound =
      options.max_planar_stretch > 0 ? options.max_planar_stretch : options.max_stretch;
  const std::optional<Distortion> projected = project(mesh, axis, bound, r.uvs);
  if (!projected) return {};
  judge(mesh, options, r, &*projected);
  if (!r.injective) return {};
  return r;
}

// Parts that fit this well, relative to the shortest edge at a vertex, need no solving.
constexpr double kExactFit = 1e-3;

// Places each vertex at the mean of its corners in corner_uvs. Returns the largest distance of a
// corner from there, relative to the shorter edge of its triangle.
double lay_side_by_side(const LocalMesh& mesh, std::span<const Vec2d> corner_uvs,
                        std::span<Vec2d> uvs) {
  std::vector<glm::dvec3> sum(uvs.size(), glm::dvec3(0));
  for (std::size_t c = 0; c < corner_uvs.size(); ++c) {
    sum[mesh.triangles[c / 3][c % 3]] += glm::dvec3(to_glm(corner_uvs[c]), 1);
  }
  for (std::size_t v = 0; v < uvs.size(); ++v) uvs[v] = from_glm(glm::dvec2(sum[v]) / sum[v].z);
  double misfit = 0;
  for (std::size_t c = 0; c < corner_uvs.size(); ++c) {
    const auto& v = mesh.triangles[c / 3];
    const glm::dvec2 at = to_glm(uvs[v[c % 3]]);
    const double shorter = std::min(glm::distance(at, to_glm(uvs[v[(c + 1) % 3]])),
                                    glm::distance(at, to_glm(uvs[v[(c + 2) % 3]])));
    misfit = std::max(misfit, glm::distance(at, to_glm(corner_uvs[c])) / shorter);
  }
  return misfit;
}

}  // namespace

ParamResult flatten_disc(const LocalMesh& mesh, const FlattenOptions& options,
                         ParamWorkspace& workspace) {
  PhaseClock clock(mesh, workspace);
  const Vec3d axis = axis_for(mesh, options);
  if (std::optional<ParamResult> planar = projection(mesh, axis, options))
    return std::move(*planar);
  ParamResult r = with_room(mesh);
  IsometricStart start = options.start;
  // Within a hemisphere the projection is as good a start as any, and free of holonomy.
  if (start.uvs.empty() && !start.frames && planar_stretch_bound(mesh, axis) < 4) {
    project_planar(mesh, axis, r.uvs);
    start.uvs = r.uvs;
    start.rough = true;
  }
  ArapSolver solver(mesh, {.min_altitude = options.min_altitude}, workspace.impl());
  const auto descend_from = [&](const IsometricStart& from, ParamResult& to) {
    solver.start(from);
    solver.iterate(std::max(options.iterations, 1), to.uvs);
    solver.rest();
    Descent(mesh, options, solver, clock).run(FirstUvs::solved, to);
  };
  descend_from(start, r);
  const bool unfolded = start.uvs.empty() && !start.frames;
  const bool folded = r.unflipped > 0 || r.distortion.flips > 0;
  if (r.injective || unfolded || !folded) return r;
  // A bad start leaves folds that no descent removes well; unfolding triangle by triangle has none.
  ParamResult other = with_room(mesh);
  descend_from({}, other);
  return other.injective ? other : r;
}

ParamResult resume_flattening(const LocalMesh& mesh, std::span<const Vec2d> uvs,
                              const FlattenOptions& options, ParamWorkspace& workspace) {
  PhaseClock clock(mesh, workspace);
  ParamResult r;
  r.uvs.assign(uvs.begin(), uvs.end());
  ArapSolver solver(mesh, {.min_altitude = options.min_altitude}, workspace.impl());
  solver.rest();
  Descent(mesh, options, solver, clock).run(FirstUvs::solved, r);
  return r;
}

ParamResult join_flat_parts(const LocalMesh& mesh, const FlatParts& parts,
                            const FlattenOptions& options, ParamWorkspace& workspace) {
  if (std::optional<ParamResult> planar = projection(mesh, axis_for(mesh, options), options))
    return std::move(*planar);
  PhaseClock clock(mesh, workspace);
  ParamResult r = with_room(mesh);
  const double misfit = lay_side_by_side(mesh, parts.corner_uvs, r.uvs);
  ArapSolver solver(mesh, {.min_altitude = options.min_altitude}, workspace.impl());
  if (parts.patch || misfit < kExactFit) {
    solver.start(IsometricStart{.uvs = r.uvs});
  } else {
    solver.join(parts.corner_uvs, r.uvs);
  }
  solver.rest();
  Descent(mesh, options, solver, clock).run(FirstUvs::joined, r);
  return r;
}

}  // namespace param

namespace {

Status check_start(const IsometricStart& start, std::size_t vertices) {
  if (!start.uvs.empty() && start.frames)
    return {ErrorCode::bad_input, "parameterize: start has uvs and frames (give one of them)"};
  if (!start.uvs.empty() && start.uvs.size() != vertices)
    return {ErrorCode::bad_input, fmt::format("parameterize: start has {} uvs for {} vertices",
                                              start.uvs.size(), vertices)};
  for (std::size_t v = 0; v < start.uvs.size(); ++v)
    if (!is_finite(start.uvs[v]))
      return {ErrorCode::bad_input, fmt::format("parameterize: uv {} of start is not finite", v)};
  return {};
}

Status check_options(const ParamOptions& o) {
  const auto must = [](const char* field, double value, const char* range) {
    return Status(ErrorCode::bad_option,
                  fmt::format("ParamOptions::{} is {:g}; it must be {}", field, value, range));
  };
  if (!(o.max_stretch > 1)) return must("max_stretch", o.max_stretch, "a number above 1");
  if (!is_enumerator(o.method, ParamMethod::isometric))
    return must("method", int(o.method), "a ParamMethod");
  if (o.iterations < 0) return must("iterations", o.iterations, "at least 0");
  if (o.squeeze_iterations < 0)
    return must("squeeze_iterations", o.squeeze_iterations, "at least 0");
  if (!(o.min_altitude >= 0) || !std::isfinite(o.min_altitude))
    return must("min_altitude", o.min_altitude, "a length, or 0");
  return {};
}

}  // namespace

Status check_local_mesh(const LocalMesh& mesh) {
  const auto wrong = [](std::string text) {
    return Status(ErrorCode::bad_input, "local mesh: " + std::move(text));
  };
  const std::size_t vertices = mesh.positions.size(), triangles = mesh.triangles.size();
  for (std::size_t v = 0; v < vertices; ++v)
    if (!is_finite(mesh.positions[v])) return wrong(fmt::format("position {} is not finite", v));
  for (std::size_t t = 0; t < triangles; ++t) {
    const auto& [a, b, c] = mesh.triangles[t];
    if (std::max({a, b, c}) >= vertices || a == b || b == c || c == a)
      return wrong(fmt::format("triangle {} has the vertices {}, {} and {} (three of {})", t, a, b,
                               c, vertices));
  }
  if (!mesh.density.empty() && mesh.density.size() != triangles)
    return wrong(fmt::format("{} densities for {} triangles (one each, or none)",
                             mesh.density.size(), triangles));
  for (std::size_t t = 0; t < mesh.density.size(); ++t)
    if (!(mesh.density[t] > 0) || !std::isfinite(mesh.density[t]))
      return wrong(fmt::format("triangle {} has a density of {} (above 0)", t, mesh.density[t]));
  if (!mesh.opposite.empty() && mesh.opposite.size() != 3 * triangles)
    return wrong(fmt::format("{} opposites for {} half-edges (one each, or none)",
                             mesh.opposite.size(), 3 * triangles));
  for (std::size_t h = 0; h < mesh.opposite.size(); ++h)
    if (mesh.opposite[h] != kNoIndex && mesh.opposite[h] >= 3 * triangles)
      return wrong(fmt::format("half-edge {} has the opposite {} of {}", h, mesh.opposite[h],
                               3 * triangles));
  return {};
}

Result<ParamResult> parameterize(const LocalMesh& mesh, const ParamOptions& options,
                                 ParamWorkspace& workspace) {
  if (Status s = check_options(options); !s.ok()) return s;
  if (Status s = check_local_mesh(mesh); !s.ok()) return s;
  if (Status s = check_start(options.start, mesh.positions.size()); !s.ok()) return s;
  if (mesh.triangles.empty()) return param::with_room(mesh);
  double largest = 0;
  for (std::size_t v = 0; v < mesh.positions.size(); ++v) {
    largest = std::max(largest, param::largest_coordinate(mesh.positions[v]));
  }
  const int power = param::excess_power(largest);
  if (power != 0) return param::flatten_in_unit(mesh, options, power, workspace);
  return param::flatten_disc(mesh, {options}, workspace);
}

}  // namespace atlas
