// Internal: which triangles of a scene the nodes of its glTF file show as one mesh, for those who
// do not include tinygltf.
#pragma once

#include <cstddef>
#include <vector>

#include "libatlas/scene/scene.h"

namespace atlas {

// A primitive where a node shows it: consecutive positions and triangles of the scene.
struct ShownPart {
  std::size_t first_position = 0, positions = 0;
  std::size_t first_triangle = 0, triangles = 0;
  bool mirrored = false;  // the corners of its triangles are in the opposite order

  // Returns the scene's corner for corner k of the primitive, where k counts 3 per triangle in the
  // file's own order.
  std::size_t corner(std::size_t k) const {
    return 3 * (first_triangle + k / 3) + (mirrored ? 2 - k % 3 : k % 3);
  }
};

// A mesh where a node, or an instance of it, shows it.
struct ShownMesh {
  std::size_t mesh = 0;
  std::vector<ShownPart> parts = {};
};

// Returns one for each place of the scene's source, in its order; none without a source.
std::vector<ShownMesh> shown_meshes(const Scene& scene);

}  // namespace atlas
