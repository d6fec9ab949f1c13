#include "libatlas/exporters/obj/obj_text.h"

#include <fmt/format.h>

#include <functional>
#include <numeric>
#include <vector>

#include "libatlas/exporters/world.h"
#include "libatlas/scene/obj/obj_names.h"
#include "libatlas/scene/scene.h"

namespace atlas {
namespace {

// Returns uv + whole as decimals. Ten of them keep uvs apart that differ as floats of the page, as
// the floats of far tiles do not.
std::string in_tile(float uv, std::uint32_t whole) {
  std::string text = fmt::format("{:.10f}", double(uv) + whole);
  text.erase(text.find_last_not_of('0') + 1);
  if (text.back() == '.') text.pop_back();
  return text;
}

}  // namespace

void write_obj_head(TextFile& file, const World& world, const std::filesystem::path& mtl) {
  if (!world.title.empty()) file.write("# " + one_line(world.title) + "\n");
  if (world.up == Up::z) file.write("# " + std::string(kZUpNote) + "\n");
  for (const std::string& line : world.info) file.write("# " + one_line(line) + "\n");
  file.write("mtllib " + mtl.filename().string() + "\n");
}

void write_obj_points(TextFile& file, const World& world, std::span<const std::uint32_t> points,
                      const Context& context) {
  const bool lit = world.scene != nullptr && world.scene->lit() && !world.lightmap;
  file.write_items(points.size(), context, [&](TextBuffer& out, std::size_t i) {
    out.text("v ");
    out.position(world.origin, world.positions[points[i]]);
    if (lit) {
      out.character(' ');
      out.position({}, world.scene->illumination[points[i]]);
    }
    out.character('\n');
  });
}

void write_obj_uvs(TextFile& file, const World& world, std::span<const std::uint32_t> uvs,
                   const Context& context) {
  file.write_items(uvs.size(), context, [&](TextBuffer& out, std::size_t i) {
    out.text("vt ");
    const Vec2f uv = world.uvs[uvs[i]];
    const std::uint32_t tile = world.uv_tiles.empty() ? 0 : world.uv_tiles[uvs[i]];
    if (tile == 0)
      out.uv(uv);
    else
      out.text(in_tile(uv.x, tile % 10) + ' ' + in_tile(uv.y, tile / 10));
    out.character('\n');
  });
}

void write_obj_faces(TextFile& file, const ObjCorners& corners, const Context& context) {
  std::vector<std::size_t> first(corners.sizes.size() + 1, 0);
  std::partial_sum(corners.sizes.begin(), corners.sizes.end(), first.begin() + 1,
                   std::plus<std::size_t>());
  const bool triangles = corners.sizes.empty();
  const std::size_t faces = triangles ? corners.points.size() / 3 : corners.sizes.size();
  file.write_items(faces, context, [&](TextBuffer& out, std::size_t f) {
    out.character('f');
    const std::size_t begin = triangles ? 3 * f : first[f],
                      end = triangles ? 3 * f + 3 : first[f + 1];
    for (std::size_t k = begin; k < end; ++k) {
      out.character(' ');
      out.number(corners.points[k] + 1);
      out.character('/');
      out.number(corners.uvs[k] + 1);
      if (corners.normals.empty()) continue;
      out.character('/');
      out.number(corners.normals[k] + 1);
    }
    out.character('\n');
  });
}

}  // namespace atlas
