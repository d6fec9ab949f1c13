// Atlases with instances, in which every mesh lies in a rectangle of its own.
#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "libatlas/unwrap/atlas.h"
#include "libatlas/unwrap/blocks.h"
#include "libatlas/unwrap/join_unwrapped.h"

namespace atlas {
namespace {

template <class T>
std::span<const T> slice(const std::vector<T>& values, std::size_t begin, std::size_t end) {
  if (values.empty()) return {};
  return std::span(values).subspan(begin, end - begin);
}

Vec2f on_page(const MeshInstance& at, Vec2f uv) {
  const auto within = [](float v) { return std::clamp(v, 0.0f, 1.0f); };
  return {within(at.offset.x + uv.x * at.scale.x), within(at.offset.y + uv.y * at.scale.y)};
}

// Moves placements from the mesh's own page to where an instance has its rectangle.
void move_placements(const MeshInstance& at, const Rect& rect, const Extent& page,
                     UnwrappedMesh& mesh) {
  const Extent own = mesh.pages[0];
  const double by = own.width > 0 ? double{at.scale.x} * page.width / own.width : 1;
  const bool same = std::abs(by - 1) < 1e-6;
  for (ChartPlacement& p : mesh.placements) {
    const auto texels = [&](std::int32_t t) { return same ? t : std::int32_t(std::floor(by * t)); };
    const std::int32_t right = p.x + p.width, top = p.y + p.height;
    p.page = std::int32_t(at.page);
    p.x = rect.x + texels(p.x);
    p.y = rect.y + texels(p.y);
    p.width = rect.x + (same ? right : std::int32_t(std::ceil(by * right))) - p.x;
    p.height = rect.y + (same ? top : std::int32_t(std::ceil(by * top))) - p.y;
    p.offset = {rect.x + (same ? 1 : by) * p.offset.x, rect.y + (same ? 1 : by) * p.offset.y};
    if (!same) p.texels_per_unit = {by * p.texels_per_unit.x, by * p.texels_per_unit.y};
  }
}

}  // namespace

Atlas::SubMesh Atlas::mesh_view(std::size_t mesh) const {
  const std::size_t v = first_position_[mesh], v_end = first_position_[mesh + 1];
  const std::size_t t = first_triangle_[mesh], t_end = first_triangle_[mesh + 1];
  SubMesh out;
  for (const std::uint32_t i : slice(indices_, 3 * t, 3 * t_end))
    out.indices.push_back(std::uint32_t(i - v));
  for (const std::uint32_t i : slice(texcoord_indices_, 3 * t, 3 * t_end))
    out.texcoord_indices.push_back(i);
  out.view.positions = slice(positions_, v, v_end);
  out.view.indices = out.indices;
  out.view.materials = slice(materials_, t, t_end);
  out.view.density = slice(density_, t, t_end);
  out.view.texcoords = texcoords_;
  out.view.texcoord_indices = out.texcoord_indices;
  out.view.seams = slice(seams_, 3 * t, 3 * t_end);
  out.view.objects = slice(objects_, v, v_end);
  out.view.polygons = slice(polygons_, t, t_end);
  out.view.seam_weights = slice(seam_weights_, v, v_end);
  return out;
}

Result<UnwrappedMesh> Atlas::unwrap_in_blocks(
    const UnwrapOptions& options, const Context& context,
    std::vector<std::vector<MeshInstance>>& instances) const {
  static constexpr std::array kOnce{1.0f};
  std::vector<SubMesh> meshes(mesh_count());
  std::vector<BlockMesh> blocks;
  for (std::size_t i = 0; i < mesh_count(); ++i) {
    meshes[i] = mesh_view(i);
    blocks.push_back({meshes[i].view, instances_[i].empty()
                                          ? std::span<const float>(kOnce)
                                          : std::span<const float>(instances_[i])});
  }
  Result<Blocks> made = unwrap_blocks(blocks, options, context);
  if (!made.ok()) return made.status();
  UnwrappedMesh all;
  all.pages = made->pages;
  all.texels_per_unit = made->texels_per_unit;
  all.utilization = made->utilization;
  for (std::size_t i = 0; i < mesh_count(); ++i) {
    UnwrappedMesh& mesh = made->meshes[i];
    const MeshInstance first = made->instances[i][0];
    move_placements(first, made->rects[i][0], all.pages[first.page], mesh);
    for (std::uint32_t& page : mesh.triangle_page) page = first.page;
    if (instances_[i].empty()) {
      for (Vec2f& uv : mesh.uvs) uv = on_page(first, uv);
      made->instances[i].clear();
    }
    append_unwrapped(std::move(mesh), first_position_[i], all);
  }
  instances = std::move(made->instances);
  return all;
}

}  // namespace atlas
