// Wavefront OBJ with atlas coordinates: one material per page.
#include <fmt/format.h>

#include <span>
#include <string>

#include "libatlas/exporters/obj/obj_text.h"
#include "libatlas/exporters/world.h"
#include "libatlas/exporters/writing/compact_page.h"
#include "libatlas/exporters/writing/scene_writers.h"

namespace atlas {
namespace fs = std::filesystem;
namespace {

std::vector<std::uint32_t> gather(const World& world, bool uvs) {
  std::vector<std::uint32_t> all;
  for (const Page& page : world.pages) {
    const auto& indices = uvs ? page.uv_indices : page.indices;
    all.insert(all.end(), indices.begin(), indices.end());
  }
  return all;
}

void write_geometry(TextFile& file, const World& world, WorldFile& result, const Context& context) {
  const auto points = Compactor(world.positions.size()).compact(gather(world, false));
  const auto uvs = Compactor(world.uvs.size()).compact(gather(world, true));
  write_obj_points(file, world, points.used, context);
  write_obj_uvs(file, world, uvs.used, context);
  std::size_t corner = 0;
  for (std::size_t i = 0; i < world.pages.size(); ++i) {
    const std::size_t corners = world.pages[i].indices.size();
    if (corners == 0) continue;
    const std::span<const std::uint32_t> sizes = world.pages[i].face_sizes;
    file.write(fmt::format("o page{0}\nusemtl page{0}\n", i));
    const auto of_page = [&](const std::vector<std::uint32_t>& indices) {
      return std::span(indices).subspan(corner, corners);
    };
    write_obj_faces(file, {of_page(points.indices), of_page(uvs.indices), {}, sizes}, context);
    corner += corners;
    result.triangles += sizes.empty() ? corners / 3 : corners - 2 * sizes.size();
    context.report("writing the world", double(i + 1) / double(world.pages.size()));
  }
  result.vertices = points.used.size();
  result.uvs = uvs.used.size();
}

// A page holds light: it is shown as it is, without highlights, which readers add unless they are
// told not to.
std::string material_of(const Page& page, std::size_t number) {
  const std::string name = fmt::format("newmtl page{}\n", number);
  if (page.image.empty()) return name + "Kd 1 1 1\n";
  return name + "Ka 0 0 0\nKd 1 1 1\nKs 0 0 0\nillum 0\nmap_Kd " + page.image + "\n";
}

}  // namespace

Result<WorldFile> write_obj(const World& world, const fs::path& path, AtomicFiles& files,
                            const Context& context) {
  if (Status s = check_world(world); !s.ok()) return s;
  if (world.scene != nullptr) return write_obj_scene(world, path, files, context);
  WorldFile result;
  const fs::path mtl_path = safely_beside(path, ".mtl");
  TextFile mtl(files.path_for(mtl_path), mtl_path, false);
  for (std::size_t i = 0; i < world.pages.size(); ++i) {
    mtl.write(material_of(world.pages[i], i));
  }
  if (Status s = mtl.finish(); !s.ok()) return s;
  TextFile file(files.path_for(path), path, false);
  write_obj_head(file, world, mtl_path);
  write_geometry(file, world, result, context);
  if (Status s = file.finish(); !s.ok()) return s;
  result.bytes = mtl.bytes() + file.bytes();
  return result;
}

}  // namespace atlas
