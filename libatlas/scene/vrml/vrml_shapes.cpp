#include "libatlas/scene/vrml/vrml_shapes.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <span>
#include <tuple>
#include <utility>

#include "libatlas/core/glm_bridge.h"

namespace atlas {
namespace {

constexpr Vec3f kNoColour{std::numeric_limits<float>::quiet_NaN(), 0, 0};

auto key_of(const RawMaterial& m) {
  return std::tie(m.name, m.texture, m.wrap_u, m.wrap_v, m.uv_u, m.uv_v, m.opacity, m.double_sided,
                  m.unlit, m.diffuse.x, m.diffuse.y, m.diffuse.z, m.emission.x, m.emission.y,
                  m.emission.z);
}

std::int64_t index(std::int32_t value, std::size_t count, std::size_t base) {
  return value >= 0 && std::size_t(value) < count ? value + std::int64_t(base) : -1;
}

}  // namespace

bool VrmlShapes::Less::operator()(const RawMaterial& a, const RawMaterial& b) const {
  return key_of(a) < key_of(b);
}

void VrmlShapes::add(VrmlShape shape, RawMaterial material, const glm::dmat4& matrix) {
  if (!shape.colours.empty()) {  // which take the place of that of the material
    give_points_colours(shape);
    material.diffuse = {1, 1, 1};
  }
  if (material.texture >= 0 && shape.uvs.empty()) add_default_uvs(shape);
  material.double_sided = !shape.solid;
  shape.material = material_of(std::move(material));
  const std::size_t base = builder_.positions.size();
  for (const Vec3d& p : shape.points) {
    const glm::dvec3 q = glm::dvec3(matrix * glm::dvec4(to_glm(p), 1));
    builder_.positions.push_back(from_glm(q));
  }
  if (!shape.colours.empty()) {
    builder_.illumination.resize(base, kNoColour);
    builder_.illumination.insert(builder_.illumination.end(), shape.colours.begin(),
                                 shape.colours.end());
  }
  bases_.push_back({base, builder_.texcoords.size(), glm::determinant(glm::dmat3(matrix)) < 0});
  builder_.texcoords.insert(builder_.texcoords.end(), shape.uvs.begin(), shape.uvs.end());
  shape.points = {};
  shape.colours = {};
  shapes_.push_back(std::move(shape));
}

// Returns the index of a material that is the same in all that is read. Those of different names
// are kept apart, as in other formats.
std::uint32_t VrmlShapes::material_of(RawMaterial&& material) {
  const auto next = static_cast<std::uint32_t>(builder_.materials.size());
  const auto [at, is_new] = material_ids_.try_emplace(material, next);
  if (!is_new) return at->second;
  if (material.name.empty()) material.name = fmt::format("material{}", next);
  if (!is_reflectance(material.diffuse)) {
    builder_.defects.add(DefectKind::reflectance_beyond_one, [&] {
      return fmt::format("{}: material '{}'", builder_.file, material.name);
    });
  }
  builder_.materials.push_back(std::move(material));
  return next;
}

// Sets points without a colour to 0 in a scene where others have one.
void VrmlShapes::finish_colours() {
  if (builder_.illumination.empty()) return;
  builder_.illumination.resize(builder_.positions.size(), kNoColour);
  for (std::size_t i = 0; i < builder_.illumination.size(); ++i) {
    if (!std::isnan(builder_.illumination[i].x)) continue;
    builder_.illumination[i] = {};
    builder_.defects.add(DefectKind::illumination_missing,
                         [&] { return fmt::format("{}: vertex {}", builder_.file, i); });
  }
}

void VrmlShapes::add_faces(double begun, const Context& context) {
  finish_colours();
  builder_.check_positions(
      [&](std::size_t i) { return fmt::format("{}: vertex {}", builder_.file, i); });
  for (std::size_t i = 0; i < shapes_.size(); ++i) {
    if (context.cancelled()) return;  // so says SceneBuilder::finish()
    const double done = double(i) / double(shapes_.size());
    context.report("reading", begun + (1 - begun) * done);
    add_faces(shapes_[i], i);
    shapes_[i] = {};
  }
}

// Returns how many points the shape has in the builder.
std::size_t VrmlShapes::points(std::size_t number) const {
  const std::size_t end =
      number + 1 < bases_.size() ? bases_[number + 1].position : builder_.positions.size();
  return end - bases_[number].position;
}

void VrmlShapes::add_faces(const VrmlShape& shape, std::size_t number) {
  builder_.material = shape.material;
  builder_.object = static_cast<std::uint32_t>(number);
  builder_.objects.push_back(fmt::format("shape{}", number));
  const Base& base = bases_[number];
  const auto& own = shape.uv_corners.empty() ? shape.corners : shape.uv_corners;
  const bool textured = !shape.uvs.empty();
  // An index beyond its own list must not reach into the next shape's.
  const std::size_t count = points(number);
  std::vector<std::int64_t> vertices, uvs;
  std::size_t face = 0;
  for (std::size_t k = 0; k <= shape.corners.size(); ++k) {
    if (k < shape.corners.size() && shape.corners[k] != -1) {
      vertices.push_back(index(shape.corners[k], count, base.position));
      const std::int32_t uv = textured && k < own.size() ? own[k] : -1;
      uvs.push_back(index(uv, shape.uvs.size(), base.texcoord));
      continue;
    }
    if (vertices.empty()) continue;
    if (base.mirrored != shape.clockwise) {
      std::reverse(vertices.begin(), vertices.end());
      std::reverse(uvs.begin(), uvs.end());
    }
    builder_.add_face(
        {vertices, std::span<const std::int64_t>(uvs).first(textured ? uvs.size() : 0)},
        [&] { return fmt::format("{}: shape {} face {}", builder_.file, number, face); });
    ++face;
    vertices.clear();
    uvs.clear();
  }
}

}  // namespace atlas
