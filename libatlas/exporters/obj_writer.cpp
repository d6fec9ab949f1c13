// Wavefront OBJ with atlas coordinates: one material a page.
#include <fmt/format.h>

#include <span>

#include "libatlas/exporters/compact_page.h"
#include "libatlas/exporters/text_output.h"
#include "libatlas/exporters/world.h"

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

// A comment must stay on its line.
std::string one_line(std::string text) {
  for (char& c : text) {
    if (c == '\n' || c == '\r' || c == '\\') c = ' ';
  }
  return text;
}

void write_faces(TextFile& file, std::span<const std::uint32_t> points,
                 std::span<const std::uint32_t> uvs, const Context& context) {
  file.write_items(points.size() / 3, context, [&](TextBuffer& out, std::size_t t) {
    out.character('f');
    for (std::size_t k = 3 * t; k < 3 * t + 3; ++k) {
      out.character(' ');
      out.number(points[k] + 1);
      out.character('/');
      out.number(uvs[k] + 1);
    }
    out.character('\n');
  });
}

void write_geometry(TextFile& file, const World& world, WorldFile& result, const Context& context) {
  const auto points = Compactor(world.positions.size()).compact(gather(world, false));
  const auto uvs = Compactor(world.uvs.size()).compact(gather(world, true));
  file.write_items(points.used.size(), context, [&](TextBuffer& out, std::size_t i) {
    out.text("v ");
    out.position(world.origin, world.positions[points.used[i]]);
    out.character('\n');
  });
  file.write_items(uvs.used.size(), context, [&](TextBuffer& out, std::size_t i) {
    out.text("vt ");
    out.uv(world.uvs[uvs.used[i]]);
    out.character('\n');
  });
  std::size_t corner = 0;
  for (std::size_t i = 0; i < world.pages.size(); ++i) {
    const std::size_t triangles = world.pages[i].indices.size() / 3;
    if (triangles == 0) continue;
    file.write(fmt::format("o page{0}\nusemtl page{0}\n", i));
    const auto of_page = [&](const std::vector<std::uint32_t>& indices) {
      return std::span(indices).subspan(corner, 3 * triangles);
    };
    write_faces(file, of_page(points.indices), of_page(uvs.indices), context);
    corner += 3 * triangles;
    result.triangles += triangles;
    context.report("writing the world", double(i + 1) / double(world.pages.size()));
  }
  result.vertices = points.used.size();
  result.uvs = uvs.used.size();
}

}  // namespace

Result<WorldFile> write_obj(const World& world, const fs::path& path, AtomicFiles& files,
                            const Context& context) {
  if (Status s = check_world(world); !s.ok()) return s;
  WorldFile result;
  fs::path mtl_path = path;
  mtl_path.replace_extension(".mtl");
  TextFile mtl(files.path_for(mtl_path), mtl_path, false);
  for (std::size_t i = 0; i < world.pages.size(); ++i) {
    mtl.write(fmt::format("newmtl page{}\nKd 1 1 1\n", i));
    if (!world.pages[i].image.empty()) mtl.write("map_Kd " + world.pages[i].image + "\n");
  }
  if (Status s = mtl.finish(); !s.ok()) return s;
  TextFile file(files.path_for(path), path, false);
  if (!world.title.empty()) file.write("# " + one_line(world.title) + "\n");
  for (const std::string& line : world.info) file.write("# " + one_line(line) + "\n");
  file.write("mtllib " + mtl_path.filename().string() + "\n");
  write_geometry(file, world, result, context);
  if (Status s = file.finish(); !s.ok()) return s;
  result.bytes = mtl.bytes() + file.bytes();
  return result;
}

}  // namespace atlas
