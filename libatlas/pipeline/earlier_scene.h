// Internal: the uvs of an earlier export, as unwrapping takes them.
#pragma once

#include <memory>
#include <vector>

#include "libatlas/pipeline/export_options.h"
#include "libatlas/scene/reader.h"
#include "libatlas/unwrap/like_mesh.h"

namespace atlas {

// The scene with the uvs of an earlier one. The arrays lie in one place, since views refer to them.
struct LikeScene {
  std::vector<Vec3f> positions;  // of the earlier scene, relative to the origin of this one
  std::vector<std::uint32_t> triangle_page;
  std::vector<Extent> pages;
  EarlierUvs earlier;
  std::unique_ptr<LikeMesh> mesh;
};

// `mesh` is that of the scene; it and the earlier scene must outlive the result. A page of which
// the file says no size has `options.atlas_size` along its longer side. Errors: bad_input.
Result<LikeScene> like_scene(const Scene& scene, const MeshView& mesh,
                             const ExportOptions& options);

}  // namespace atlas
