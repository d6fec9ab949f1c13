// Internal: the shapes of a VRML97 world on their way into a SceneBuilder.
#pragma once

#include <cstddef>
#include <cstdint>
#include <glm/mat4x4.hpp>
#include <map>
#include <vector>

#include "libatlas/core/context.h"
#include "libatlas/scene/building/scene_builder.h"
#include "libatlas/scene/vrml/vrml_shape.h"

namespace atlas {

class VrmlShapes {
 public:
  explicit VrmlShapes(SceneBuilder& builder) : builder_(builder) {}

  // Adds the points of a shape, moved by `matrix`, and its material. Its faces wait for
  // add_faces().
  void add(VrmlShape shape, RawMaterial material, const glm::dmat4& matrix);

  // Adds the faces of all shapes, once the points are where they stay. Reports the progress of
  // "reading" from `begun` on. Ends early if cancelled.
  void add_faces(double begun, const Context& context);

 private:
  // Where the arrays of a shape begin in the builder's.
  struct Base {
    std::size_t position = 0, texcoord = 0;
    bool mirrored = false;
  };
  // Materials that neither is less are the same in all that is read.
  struct Less {
    bool operator()(const RawMaterial& a, const RawMaterial& b) const;
  };

  std::uint32_t material_of(RawMaterial&& material);
  void finish_colours();
  void add_faces(const VrmlShape& shape, std::size_t number);
  std::size_t points(std::size_t number) const;

  SceneBuilder& builder_;
  std::vector<VrmlShape> shapes_;
  std::vector<Base> bases_;
  std::map<RawMaterial, std::uint32_t, Less> material_ids_;
};

}  // namespace atlas
