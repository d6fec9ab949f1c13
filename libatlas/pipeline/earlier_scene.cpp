#include "libatlas/pipeline/earlier_scene.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#include "libatlas/pipeline/layout_options.h"

namespace atlas {
namespace {

// A page of this shape whose longer side has so many texels.
Extent page_of_aspect(double aspect, std::int32_t side) {
  const auto shorter = [&](double share) {
    return std::max(1, std::int32_t(std::lround(side * std::min(1.0, share))));
  };
  return aspect > 0 ? Extent{shorter(aspect), shorter(1 / aspect)} : Extent{side, side};
}

// Takes the pages that the earlier file names, in the order of their numbers.
void take_pages(const LoadedScene& earlier, std::int32_t side, LikeScene& like) {
  const std::vector<UvPage>& named = earlier.material_uv_pages;
  std::map<std::uint32_t, Extent> extents;
  for (const UvPage& page : named) {
    const bool known = page.width > 0 && page.height > 0;
    extents.try_emplace(page.number, known ? Extent{page.width, page.height}
                                           : page_of_aspect(earlier.uv_aspect, side));
  }
  if (extents.empty()) extents.emplace(0, page_of_aspect(earlier.uv_aspect, side));
  std::map<std::uint32_t, std::uint32_t> index;
  for (const auto& [number, extent] : extents) {
    index.emplace(number, std::uint32_t(like.pages.size()));
    like.pages.push_back(extent);
  }
  for (const std::uint32_t material : earlier.scene.triangle_material)
    like.triangle_page.push_back(material < named.size() ? index.at(named[material].number) : 0);
}

}  // namespace

Result<LikeScene> like_scene(const Scene& scene, const MeshView& mesh,
                             const ExportOptions& options) {
  const Scene& earlier = options.like->scene;
  LikeScene like;
  for (const Vec3f p : earlier.positions)
    like.positions.push_back({float(p.x + (earlier.origin.x - scene.origin.x)),
                              float(p.y + (earlier.origin.y - scene.origin.y)),
                              float(p.z + (earlier.origin.z - scene.origin.z))});
  take_pages(*options.like, options.atlas_size, like);
  like.earlier.positions = like.positions;
  like.earlier.indices = earlier.indices;
  like.earlier.uvs = earlier.texcoords;
  like.earlier.uv_indices = earlier.texcoord_indices;
  like.earlier.triangle_page = like.triangle_page;
  like.earlier.pages = like.pages;
  if (earlier.texcoord_indices.empty()) like.earlier.uvs = {};  // no triangle has any
  if (Status s = check_earlier(like.earlier, "ExportOptions::like"); !s.ok()) return s;
  like.mesh = std::make_unique<LikeMesh>(
      mesh, like.earlier, LikeMesh::Options{options.charts.max_stretch, plain_padding(options)});
  return like;
}

}  // namespace atlas
