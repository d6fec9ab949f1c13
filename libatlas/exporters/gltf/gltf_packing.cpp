#include "libatlas/exporters/gltf/gltf_packing.h"

#include <meshoptimizer.h>

#include <algorithm>
#include <cmath>

#include "libatlas/core/bounds.h"
#include "libatlas/core/glm_bridge.h"

namespace atlas {
namespace {

constexpr double kMost = 65535;

std::uint16_t nearest(float value, float low, float step) {
  return std::uint16_t(std::lround(std::clamp((double(value) - low) / step, 0.0, kMost)));
}

}  // namespace

std::string pack_vertices(const void* data, std::size_t count, std::size_t stride) {
  meshopt_encodeVertexVersion(0);  // the one that the extension has
  std::string out(meshopt_encodeVertexBufferBound(count, stride), '\0');
  out.resize(meshopt_encodeVertexBuffer(reinterpret_cast<unsigned char*>(out.data()), out.size(),
                                        data, count, stride));
  return out;
}

std::string pack_triangles(std::span<const std::uint32_t> indices) {
  meshopt_encodeIndexVersion(1);
  const std::uint32_t last = *std::max_element(indices.begin(), indices.end());
  std::string out(meshopt_encodeIndexBufferBound(indices.size(), std::size_t(last) + 1), '\0');
  out.resize(meshopt_encodeIndexBuffer(reinterpret_cast<unsigned char*>(out.data()), out.size(),
                                       indices.data(), indices.size()));
  return out;
}

std::vector<std::uint32_t> order_for_packing(std::vector<std::uint32_t>& indices,
                                             std::size_t vertices) {
  std::vector<std::uint32_t> ordered(indices.size()), where(vertices);
  meshopt_optimizeVertexCacheStrip(ordered.data(), indices.data(), indices.size(), vertices);
  meshopt_optimizeVertexFetchRemap(where.data(), ordered.data(), ordered.size(), vertices);
  for (std::size_t i = 0; i < ordered.size(); ++i) indices[i] = where[ordered[i]];
  return where;
}

std::array<std::uint16_t, 4> PositionGrid::at(const Vec3f& position) const {
  return {nearest(position.x, low.x, step), nearest(position.y, low.y, step),
          nearest(position.z, low.z, step), 0};
}

std::optional<PositionGrid> position_grid(std::span<const Vec3f> positions, double slip) {
  Bounds<glm::dvec3> box;
  for (const Vec3f& p : positions) box.add(to_dvec(p));
  const glm::dvec3 size = box.size();
  const double step = std::max({size.x, size.y, size.z}) / kMost;
  if (!(step > 0) || step / 2 > slip) return std::nullopt;
  PositionGrid grid;
  grid.low = {float(box.low.x), float(box.low.y), float(box.low.z)};
  grid.step = std::nextafter(float(step), float(2 * step));  // all numbers reach the far side
  return grid;
}

}  // namespace atlas
