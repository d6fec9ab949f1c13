#include "libatlas/scene/building/coloured_points.h"

#include <fmt/format.h>

#include <bit>

#include "libatlas/scene/building/scene_builder.h"

namespace atlas {

ColouredPoints::Key ColouredPoints::key_of(std::uint32_t point, const VertexColour& colour) {
  const auto bits = [](float value) { return std::bit_cast<std::uint32_t>(value); };
  const Vec3f& c = colour.light;
  return {{point, bits(c.x), bits(c.y), bits(c.z), bits(colour.opacity)}};
}

std::size_t ColouredPoints::Hash::operator()(const Key& key) const {
  std::uint64_t hash = 14695981039346656037u;
  for (const std::uint32_t word : key.words) {
    hash = (hash ^ word) * 0x9e3779b97f4a7c15u;
    hash ^= hash >> 29;
  }
  return hash;
}

std::uint32_t ColouredPoints::coloured(std::uint32_t point, const VertexColour& colour) {
  const Key key = key_of(point, colour);
  if (!colours_[point]) colours_[point] = colour;
  if (key == key_of(point, *colours_[point])) return point;
  const auto next = static_cast<std::uint32_t>(colours_.size());
  const auto [at, is_new] = copies_.try_emplace(key, next);
  if (is_new) {
    colours_.push_back(colour);
    original_.push_back(point);
  }
  return at->second;
}

void SceneBuilder::colour_corners() {
  if (triangle_colours.empty() || !illumination_file.empty()) return;
  triangle_colours.resize(triangle_count());
  const std::size_t count = positions.size();
  ColouredPoints points(count);
  std::vector<bool> bare(count);  // corners of triangles without a colour
  for (std::size_t k = 0; k < indices_.size(); ++k) {
    const auto& colour = triangle_colours[k / 3];
    if (!colour) bare[indices_[k]] = true;
    indices_[k] = points.coloured(indices_[k], colour.value_or(VertexColour{}));
  }
  for (std::size_t v = 0; v < count; ++v)
    if (bare[v])
      defects.add(DefectKind::illumination_missing,
                  [&] { return fmt::format("{}: vertex {}", file, v + 1); });
  for (std::size_t v = count; v < points.original().size(); ++v)
    positions.push_back(Vec3d(positions[points.original()[v]]));
  illumination.clear();
  vertex_opacity.clear();
  for (const auto& colour : points.colours()) {
    illumination.push_back(colour.value_or(VertexColour{}).light);
    if (wants_rest) vertex_opacity.push_back(colour.value_or(VertexColour{}).opacity);
  }
}

}  // namespace atlas
