#include "libatlas/pipeline/earlier_scene.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numeric>
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

// Moves the uvs of UDIM tiles into these. Returns the tile of each triangle (0: 1001), or nothing
// where all uvs lie in the first.
std::vector<std::uint32_t> take_tiles(const Scene& earlier, LikeScene& like) {
  constexpr std::uint32_t kColumns = 10, kMost = 9000;
  std::vector<std::uint32_t> tiles;
  bool beyond = false;
  for (std::size_t i = 0; i < earlier.texcoord_indices.size(); i += 3) {
    Vec2d middle;
    std::array<Vec2f, 3> uvs;
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint32_t uv = earlier.texcoord_indices[i + k];
      uvs[k] = uv < earlier.texcoords.size() ? earlier.texcoords[uv] : Vec2f{NAN, NAN};
      middle = {middle.x + uvs[k].x / 3.0, middle.y + uvs[k].y / 3.0};
    }
    const double u = std::floor(middle.x), v = std::floor(middle.y);
    const bool tile = u >= 0 && u < kColumns && v >= 0 && v * kColumns + u < kMost;
    tiles.push_back(tile ? std::uint32_t(v * kColumns + u) : 0);
    beyond = beyond || tiles.back() > 0;
    for (const Vec2f uv : uvs)
      like.uvs.push_back(tile ? Vec2f{float(uv.x - u), float(uv.y - v)} : uv);
  }
  if (!beyond) tiles.clear();
  return tiles;
}

// Takes the pages that the earlier file names, or those of its tiles, in the order of their
// numbers.
void take_pages(const LoadedScene& earlier, std::int32_t side, LikeScene& like) {
  std::vector<std::uint32_t> number = take_tiles(earlier.scene, like);
  if (number.empty()) {
    like.uvs = earlier.scene.texcoords;
    like.uv_indices = earlier.scene.texcoord_indices;
    for (const std::uint32_t m : earlier.scene.triangle_material)
      number.push_back(m < earlier.material_uv_pages.size() ? earlier.material_uv_pages[m].number
                                                            : 0);
  } else {
    like.uv_indices.resize(like.uvs.size());
    std::iota(like.uv_indices.begin(), like.uv_indices.end(), 0u);
  }
  std::map<std::uint32_t, Extent> extents;
  const auto add = [&](const UvPage& page) {
    extents.try_emplace(page.number, page.width > 0 && page.height > 0
                                         ? Extent{page.width, page.height}
                                         : page_of_aspect(earlier.uv_aspect, side));
  };
  for (const UvPage& page : earlier.uv_pages) add(page);
  for (const std::uint32_t page : number) add({page, 0, 0});
  if (extents.empty()) add({});
  std::map<std::uint32_t, std::uint32_t> index;
  for (const auto& [page, extent] : extents) {
    index.emplace(page, std::uint32_t(like.pages.size()));
    like.pages.push_back(extent);
  }
  for (const std::uint32_t page : number) like.triangle_page.push_back(index.at(page));
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
  like.earlier.uvs = like.uvs;
  like.earlier.uv_indices = like.uv_indices;
  like.earlier.triangle_page = like.triangle_page;
  like.earlier.pages = like.pages;
  if (like.uv_indices.empty()) like.earlier.uvs = {};  // no triangle has any
  if (Status s = check_earlier(like.earlier, "ExportOptions::like"); !s.ok()) return s;
  like.mesh = std::make_unique<LikeMesh>(
      mesh, like.earlier, LikeMesh::Options{options.charts.max_stretch, plain_padding(options)});
  return like;
}

}  // namespace atlas
