// Internal: the uvs of an earlier export, as unwrapping takes them.
#pragma once

#include <memory>
#include <vector>

#include "libatlas/pipeline/export_options.h"
#include "libatlas/scene/reader.h"
#include "libatlas/unwrap/like_mesh.h"

namespace atlas {

// The scene with the uvs of an earlier one. `earlier` refers to the arrays.
struct LikeScene {
  std::vector<Vec3f> positions;  // of the earlier scene, relative to the origin of this one
  std::vector<Vec2f> uvs;        // of UDIM tiles: within their tile
  std::vector<std::uint32_t> uv_indices;  // likewise
  std::vector<std::uint32_t> triangle_page;
  std::vector<Extent> pages;
  EarlierUvs earlier;
  std::unique_ptr<LikeMesh> mesh;
};

// `mesh` is that of the scene; it and the earlier scene must outlive the result. Uvs beyond 0..1
// are those of UDIM tiles. A page of which the file says no size has `options.atlas_size` along its
// longer side. Errors: bad_input.
Result<LikeScene> like_scene(const Scene& scene, const MeshView& mesh,
                             const ExportOptions& options);

}  // namespace atlas
