#include "libatlas/unwrap/mesh_check.h"

#include <fmt/format.h>

#include <cmath>
#include <string>

#include "libatlas/core/is_finite.h"

namespace atlas {
namespace {

// Checks a mesh that is to be the one with this number.
class MeshCheck {
 public:
  MeshCheck(const StridedMesh& mesh, std::size_t number) : mesh_(mesh), number_(number) {}

  Status run(float density) const {
    if (!usable(density)) return bad(fmt::format("density {} ({})", density, kUsable));
    if (Status s = check_arrays(); !s.ok()) return s;
    if (Status s = check_lengths(); !s.ok()) return s;
    return check_corners(density);
  }

 private:
  static constexpr const char* kUsable = "must be above 0 and finite";
  static bool usable(float density) { return density > 0 && std::isfinite(density); }

  Status bad(const std::string& text) const {
    return {ErrorCode::bad_input, fmt::format("mesh {}: {}", number_, text)};
  }
  Status bad(std::size_t face, const std::string& text) const {
    return bad(fmt::format("{} {}: {}", kind(), face, text));
  }

  bool polygons() const { return !mesh_.polygon_sizes.empty(); }
  const char* kind() const { return polygons() ? "polygon" : "triangle"; }
  std::size_t faces() const {
    return polygons() ? mesh_.polygon_sizes.size() : mesh_.indices.count / 3;
  }

  Status check_arrays() const {
    const std::string mesh = fmt::format("mesh {}: ", number_);
    if (Status s = check_span(mesh + "positions", mesh_.positions); !s.ok()) return s;
    if (Status s = check_span(mesh + "indices", mesh_.indices); !s.ok()) return s;
    if (Status s = check_span(mesh + "normals", mesh_.normals); !s.ok()) return s;
    if (Status s = check_span(mesh + "texcoords", mesh_.texcoords); !s.ok()) return s;
    return check_span(mesh + "texcoord indices", mesh_.texcoord_indices);
  }

  Status check_lengths() const {
    const std::size_t corners = mesh_.indices.count;
    if (corners < 3) return bad("no triangle (nothing to unwrap)");
    if (polygons()) {
      if (Status s = check_sizes(); !s.ok()) return s;
    } else if (corners % 3 != 0) {
      return bad(fmt::format("{} indices are not whole triangles", corners));
    }
    const auto wrong = [](std::size_t count, std::size_t expected) {
      return count > 0 && count != expected;
    };
    if (wrong(mesh_.normals.count, mesh_.positions.count))
      return bad(fmt::format("{} normals for {} positions (one each, or none)", mesh_.normals.count,
                             mesh_.positions.count));
    if (wrong(mesh_.texcoord_indices.count, corners))
      return bad(fmt::format("{} texcoord indices for {} corners (one each, or none)",
                             mesh_.texcoord_indices.count, corners));
    if (mesh_.texcoord_indices.count == 0 && wrong(mesh_.texcoords.count, mesh_.positions.count))
      return bad(fmt::format("{} texcoords for {} positions (one each, or give texcoord indices)",
                             mesh_.texcoords.count, mesh_.positions.count));
    if (wrong(mesh_.materials.size(), faces()))
      return bad(fmt::format("{} materials for {} {}s (one each, or none)", mesh_.materials.size(),
                             faces(), kind()));
    if (wrong(mesh_.density.size(), faces()))
      return bad(fmt::format("{} densities for {} {}s (one each, or none)", mesh_.density.size(),
                             faces(), kind()));
    if (wrong(mesh_.polygons.size(), faces()) || (polygons() && !mesh_.polygons.empty()))
      return bad(
          fmt::format("{} polygon numbers for {} {}s (one for each triangle, or none; none "
                      "with polygon sizes)",
                      mesh_.polygons.size(), faces(), kind()));
    if (wrong(mesh_.seams.size(), corners))
      return bad(
          fmt::format("{} seams for {} edges (one each, or none)", mesh_.seams.size(), corners));
    if (wrong(mesh_.objects.size(), mesh_.positions.count))
      return bad(fmt::format("{} objects for {} positions (one each, or none)",
                             mesh_.objects.size(), mesh_.positions.count));
    if (wrong(mesh_.seam_weights.size(), mesh_.positions.count))
      return bad(fmt::format("{} seam weights for {} positions (one each, or none)",
                             mesh_.seam_weights.size(), mesh_.positions.count));
    return {};
  }

  Status check_sizes() const {
    std::size_t sum = 0;
    for (std::size_t p = 0; p < mesh_.polygon_sizes.size(); ++p) {
      const std::uint32_t size = mesh_.polygon_sizes[p];
      if (size < 3) return bad(p, fmt::format("{} corners (at least 3)", size));
      sum += size;
    }
    if (sum == mesh_.indices.count) return {};
    return bad(fmt::format("{} polygons have {} corners in all, but there are {} indices",
                           mesh_.polygon_sizes.size(), sum, mesh_.indices.count));
  }

  // Returns the face of a corner.
  std::size_t face_of(std::size_t corner) const {
    if (!polygons()) return corner / 3;
    std::size_t face = 0;
    while (corner >= mesh_.polygon_sizes[face]) corner -= mesh_.polygon_sizes[face++];
    return face;
  }

  Status check_corners(float density) const {
    for (std::size_t i = 0; i < mesh_.indices.count; ++i) {
      const std::uint32_t v = mesh_.indices[i];
      if (v >= mesh_.positions.count)
        return bad(face_of(i),
                   fmt::format("vertex index {} names none of the {} positions (indices "
                               "count from 0)",
                               v, mesh_.positions.count));
      if (!is_finite(mesh_.positions[v]))
        return bad(face_of(i), fmt::format("vertex {} has a position that is not finite", v));
      if (mesh_.normals.count > 0 && !is_finite(mesh_.normals[v]))
        return bad(face_of(i), fmt::format("vertex {} has a normal that is not finite", v));
    }
    for (std::size_t v = 0; v < mesh_.seam_weights.size(); ++v)
      if (!(mesh_.seam_weights[v] >= 0) || !std::isfinite(mesh_.seam_weights[v]))
        return bad(fmt::format("vertex {}: seam weight {} (must be at least 0 and finite)", v,
                               mesh_.seam_weights[v]));
    for (std::size_t t = 0; t < mesh_.density.size(); ++t)
      if (!usable(mesh_.density[t]) || !usable(density * mesh_.density[t]))
        return bad(t, fmt::format("density {} times {} ({})", mesh_.density[t], density, kUsable));
    return {};
  }

  const StridedMesh& mesh_;
  std::size_t number_;
};

constexpr std::size_t kMostInstances = std::size_t{1} << 30;

}  // namespace

Status check_instances(std::size_t number, std::size_t count, std::span<const float> densities) {
  const auto bad = [&](const std::string& text) {
    return Status(ErrorCode::bad_input, fmt::format("mesh {}: {}", number, text));
  };
  if (count == 0) return bad("no instance (at least 1)");
  if (!densities.empty() && densities.size() != count)
    return bad(
        fmt::format("{} densities for {} instances (one each, or none)", densities.size(), count));
  if (count >= kMostInstances)
    return {ErrorCode::unsupported,
            fmt::format("mesh {}: {} instances (fewer than 2^30)", number, count)};
  for (std::size_t i = 0; i < densities.size(); ++i)
    if (!(densities[i] > 0) || !std::isfinite(densities[i]))
      return bad(
          fmt::format("instance {}: density {} (must be above 0 and finite)", i, densities[i]));
  return {};
}

Status check_mesh(const StridedMesh& mesh, std::size_t number, float density) {
  return MeshCheck(mesh, number).run(density);
}

}  // namespace atlas
