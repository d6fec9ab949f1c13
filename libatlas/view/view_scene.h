// A scene as arrays that can be drawn: normals made, corners welded, triangles grouped by texture.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "libatlas/core/status.h"
#include "libatlas/scene/scene.h"
#include "libatlas/shadow/fit.h"

namespace atlas {

struct ViewScene {
  // Per vertex; an array is empty where the scene has no such thing.
  std::vector<Vec3f> positions, normals;
  std::vector<Vec3f> colours;  // diffuse reflectance of the material, linear
  std::vector<Vec2f> texcoords;
  std::vector<Vec3f> illumination;  // linear, as given
  std::vector<std::uint32_t> indices;

  // Consecutive triangles with the same texture (-1: none, drawn with a white one).
  struct Batch {
    std::uint32_t first = 0, count = 0;  // indices
    std::int32_t texture = -1;
  };
  std::vector<Batch> batches;

  // What casts shadows: the same triangles over welded positions.
  std::vector<Vec3f> caster_positions;
  std::vector<std::uint32_t> caster_indices;

  std::vector<Texture> textures;
  bool textures_hold_light = false;  // atlases with baked light
  Box3 bounds;                       // of the positions that triangles use
  double light_scale = 1;            // exposure that puts the 99th percentile of the light at 1

  std::size_t triangle_count() const { return caster_indices.size() / 3; }
  bool textured() const { return !texcoords.empty(); }
  bool baked() const { return !illumination.empty() || textures_hold_light; }
};

struct ViewSceneOptions {
  double crease_degrees = 40;  // faces that meet at less than this are shaded as one surface
  bool textures_hold_light = false;
};

// bad_input if no triangle is left to draw.
Result<ViewScene> make_view_scene(const Scene& scene, const ViewSceneOptions& options);

}  // namespace atlas
