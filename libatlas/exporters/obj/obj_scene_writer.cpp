// Wavefront OBJ of a scene with atlas coordinates: its objects, materials and normals.
#include <fmt/format.h>

#include <algorithm>
#include <set>
#include <string_view>

#include "libatlas/core/small_letters.h"
#include "libatlas/exporters/obj/obj_text.h"
#include "libatlas/exporters/writing/compact_page.h"
#include "libatlas/exporters/writing/scene_parts.h"
#include "libatlas/exporters/writing/scene_writers.h"
#include "libatlas/scene/gltf/gltf_losses.h"
#include "libatlas/scene/gltf/gltf_source.h"
#include "libatlas/scene/obj/obj_names.h"

namespace atlas {
namespace fs = std::filesystem;
namespace {

// Returns the names of the materials, all different, because MTL identifies a material only by its
// name.
std::vector<std::string> material_names(const Scene& scene) {
  std::vector<std::string> names;
  std::set<std::string> taken;
  for (const Material& material : scene.materials) names.push_back(obj_name(material.name));
  for (const std::string& name : names) taken.insert(name);
  std::set<std::string> given;
  for (std::size_t i = 0; i < names.size(); ++i) {
    std::string name = names[i];
    for (std::size_t k = i; name.empty() || given.contains(name); ++k) {
      name = names[i].empty() ? fmt::format("material{}", k) : fmt::format("{}_{}", names[i], k);
      if (taken.contains(name)) name.clear();
    }
    given.insert(name);
    names[i] = name;
  }
  return names;
}

// Returns whether a line of an MTL names a texture.
bool names_texture(std::string_view line) {
  const std::string keyword = small_letters(std::string(line.substr(0, line.find_first_of(" \t"))));
  constexpr std::string_view kOthers[] = {"bump", "disp", "decal", "refl", "norm"};
  return keyword.starts_with("map_") ||
         std::find(std::begin(kOthers), std::end(kOthers), keyword) != std::end(kOthers);
}

// Returns the lines that the material's MTL had. Those that name textures become comments, because
// the textures would be drawn at the new uvs.
std::string other_lines(const Material& material, Losses& losses) {
  std::string text;
  for (const std::string& line : material.mtl_lines) {
    if (is_opacity_line(line) && material.opacity < 1) continue;  // see write_materials()
    const bool texture = names_texture(line);
    if (texture) losses.add("textures of materials (lines of the MTL, now comments)");
    if (texture) text += '#';
    text += one_line(line);
    text += '\n';
  }
  return text;
}

std::string line_of(std::string_view keyword, const Vec3f& colour) {
  TextBuffer line;
  line.text(keyword);
  for (const float value : {colour.x, colour.y, colour.z}) {
    line.character(' ');
    line.number(value);
  }
  line.character('\n');
  return std::string(line.bytes());
}

void write_materials(TextFile& mtl, const Scene& scene, const std::vector<std::string>& names,
                     Losses& losses) {
  mtl.write(
      "# The texture coordinates are new ones; the scene's textures (map_Kd) need its own, for\n"
      "# which this format has no room beside them. glTF has.\n");
  for (std::size_t i = 0; i < names.size(); ++i) {
    const Material& material = scene.materials[i];
    mtl.write(fmt::format("newmtl {}\n{}", names[i], line_of("Kd", material.diffuse)));
    if (material.alpha_mode == AlphaMode::blend && material.opacity < 1)
      mtl.write(fmt::format("d {}\n", material.opacity));
    if (material.mtl_lines.empty() && !material.emission_textured && material.emission != Vec3f{})
      mtl.write(line_of("Ke", material.emission));
    mtl.write(other_lines(material, losses));
  }
}

std::size_t triangles_with_uvs(const Scene& scene) {
  const auto& uvs = scene.texcoord_indices;
  std::size_t count = 0;
  for (std::size_t k = 0; k < uvs.size(); k += 3)
    count += std::any_of(&uvs[k], &uvs[k] + 3, [](auto uv) { return uv != Scene::kNoTexcoord; });
  return count;
}

// Counts what the scene's file has and this one does not. If the scene holds its source file, that
// tells more than what the reader has counted.
void count_file_losses(const Scene& scene, Losses& losses) {
  count_vertex_alpha(scene, losses);
  if (scene.source) return count_losses(scene.source->model, losses);
  losses.add(scene.not_read);
  losses.add("triangles with uvs of their own", triangles_with_uvs(scene));
  for (const Material& material : scene.materials)
    losses.add("textures of materials", material.mtl_lines.empty() && material.texture >= 0);
}

// The corners of all parts, one after the other, as numbers of the file's lines.
struct Lines {
  Compactor::Compact points, uvs, normals;  // normals: of the parts that have them
};

Lines lines_of(const World& world, const std::vector<ScenePart>& parts) {
  const Scene& scene = *world.scene;
  const auto normal = first_equals(scene.normals);
  std::vector<std::uint32_t> points, uvs, normals;
  points.reserve(scene.indices.size());
  uvs.reserve(scene.indices.size());
  for (const ScenePart& part : parts) {
    for (const std::uint32_t t : part.triangles) {
      for (std::size_t k = 3 * std::size_t(t); k < 3 * std::size_t(t) + 3; ++k) {
        points.push_back(scene.indices[k]);
        uvs.push_back(world.pages[0].uv_indices[k]);
        if (part.normals) normals.push_back(normal[scene.normal_indices[k]]);
      }
    }
  }
  return {Compactor(world.positions.size()).compact(points),
          Compactor(world.uvs.size()).compact(uvs),
          Compactor(scene.normals.size()).compact(normals)};
}

void write_normals(TextFile& file, const Scene& scene, const std::vector<std::uint32_t>& normals,
                   const Context& context) {
  file.write_items(normals.size(), context, [&](TextBuffer& out, std::size_t i) {
    out.text("vn ");
    out.position({}, scene.normals[normals[i]]);
    out.character('\n');
  });
}

WorldFile write_parts(TextFile& file, const World& world, const std::vector<std::string>& names,
                      const Context& context) {
  const Scene& scene = *world.scene;
  const std::vector<ScenePart> parts = scene_parts(scene);
  const Lines lines = lines_of(world, parts);
  write_obj_points(file, world, lines.points.used, context);
  write_obj_uvs(file, world, lines.uvs.used, context);
  write_normals(file, scene, lines.normals.used, context);
  std::size_t corner = 0, normal = 0;
  for (std::size_t i = 0; i < parts.size(); ++i) {
    const ScenePart& part = parts[i];
    const std::size_t corners = 3 * part.triangles.size();
    const bool new_object = i == 0 || part.object != parts[i - 1].object;
    if (new_object) file.write(obj_object_line(scene, part.object));
    if (new_object || part.material != parts[i - 1].material)
      file.write("usemtl " + names[part.material] + "\n");
    const std::span normals(lines.normals.indices);
    write_obj_faces(file,
                    {std::span(lines.points.indices).subspan(corner, corners),
                     std::span(lines.uvs.indices).subspan(corner, corners),
                     normals.subspan(normal, part.normals ? corners : 0)},
                    context);
    corner += corners;
    normal += part.normals ? corners : 0;
    context.report("writing the world", double(i + 1) / double(parts.size()));
  }
  WorldFile result;
  result.triangles = corner / 3;
  result.vertices = lines.points.used.size();
  result.uvs = lines.uvs.used.size();
  return result;
}

}  // namespace

Result<WorldFile> write_obj_scene(const World& world, const fs::path& path, AtomicFiles& files,
                                  const Context& context) {
  if (world.lightmap && world.lightmap->images.size() > 1)
    return Status{ErrorCode::bad_input,
                  path.string() +
                      ": OBJ cannot say on which page of a lightmap a triangle is (write "
                      "glTF, or one page)"};
  const fs::path mtl_path = safely_beside(path, ".mtl");
  const std::vector<std::string> names = material_names(*world.scene);
  TextFile mtl(files.path_for(mtl_path), mtl_path, false);
  Losses losses;
  write_materials(mtl, *world.scene, names, losses);
  count_file_losses(*world.scene, losses);
  if (Status s = mtl.finish(); !s.ok()) return s;
  TextFile file(files.path_for(path), path, false);
  write_obj_head(file, world, mtl_path);
  WorldFile result = write_parts(file, world, names, context);
  if (Status s = file.finish(); !s.ok()) return s;
  result.bytes = mtl.bytes() + file.bytes();
  result.uv_set = "vt";
  result.not_kept = losses.lines();
  return result;
}

}  // namespace atlas
