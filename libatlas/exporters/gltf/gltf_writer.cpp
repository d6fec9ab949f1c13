// glTF 2.0 and GLB with unlit materials (KHR_materials_unlit), one per page.
#include <fmt/format.h>

#include <algorithm>
#include <optional>
#include <utility>

#include "libatlas/core/glm_bridge.h"
#include "libatlas/exporters/gltf/gltf_document.h"
#include "libatlas/exporters/viewing/camera.h"
#include "libatlas/exporters/viewing/visitor.h"
#include "libatlas/exporters/world.h"
#include "libatlas/exporters/writing/far_origin.h"
#include "libatlas/exporters/writing/page_sides.h"
#include "libatlas/exporters/writing/scene_writers.h"
#include "libatlas/exporters/writing/unify_vertices.h"
#include "libatlas/files/file_extension.h"
#include "libatlas/scene/files/file_bytes.h"
#include "libatlas/scene/scene.h"

namespace atlas {
namespace fs = std::filesystem;
using nlohmann::json;
namespace {

class PagesWriter {
 public:
  PagesWriter(const World& world, GltfDocument& document) : world_(world), document_(document) {
    if (world.compress_slip) grid_ = position_grid(world.positions, *world.compress_slip);
  }

  Status add_page(std::size_t number, WorldFile& result) {
    const Page& page = world_.pages[number];
    const std::string name = fmt::format("page{}", number);
    const PageSides both(page);
    json primitives = json::array();
    for (const PageSides::Side& side : both.sides()) {
      primitives.push_back(add_side(side, !page.image.empty(), result));
      primitives.back()["material"] = document_.json["materials"].size() + primitives.size() - 1;
    }
    document_.json["meshes"].push_back({{"name", name}, {"primitives", std::move(primitives)}});
    Result<json> material = material_of(page, name);
    if (!material.ok()) return material.status();
    for (const PageSides::Side& side : both.sides()) {
      json of_side = *material;
      of_side["doubleSided"] = !side.one_sided;
      if (side.one_sided) of_side["name"] = name + "_one_sided";
      document_.json["materials"].push_back(std::move(of_side));
    }
    return {};
  }

  // Adds the nodes and the camera; to be called when all meshes are known.
  void add_scene(WorldFile& result) {
    const double scale = world_.metres_per_unit;
    const Viewpoint& view = world_.viewpoint;
    result.far_origin = too_far_for_floats(world_);
    const Vec3d origin = result.far_origin ? Vec3d{} : world_.origin;
    json camera = {{"name", "start"}, {"camera", 0}};
    camera["translation"] = gltf_position(world_, from_glm(to_glm(origin) + to_glm(view.position)));
    const glm::dvec3 direction = to_glm(view.direction);
    camera["rotation"] = camera_rotation(world_.up == Up::z ? z_up_to_y_up(direction) : direction);
    // From outside, a near plane as near as inside would leave the depth buffer of a large world
    // with steps of metres.
    const Visitor visitor = visitor_of(world_);
    const double far = 4 * std::max(visitor.farthest, 1e-6) * scale;
    const double near = visitor.outside ? visitor.near_plane() * scale : std::min(0.02, far * 1e-4);
    // zfar is optional by the standard, but Castle Game Engine insists on it.
    const json lens = {{"yfov", view.fov}, {"znear", near}, {"zfar", far}};
    json& file = document_.json;
    file["cameras"] = json::array({{{"type", "perspective"}, {"perspective", lens}}});
    file["nodes"] = json::array({gltf_root(world_, origin), camera});
    for (std::size_t i = 0; i < file["meshes"].size(); ++i) {
      file["nodes"][0]["children"].push_back(i + 2);
      file["nodes"].push_back({{"name", file["meshes"][i]["name"]}, {"mesh", i}});
      if (!grid_) continue;
      file["nodes"].back()["translation"] = {grid_->low.x, grid_->low.y, grid_->low.z};
      file["nodes"].back()["scale"] = {grid_->step, grid_->step, grid_->step};
    }
    json roots = {0, 1};
    if (result.far_origin) {
      const std::size_t above = file["nodes"].size();
      file["nodes"].push_back(gltf_far_origin(world_, std::exchange(roots, json::array({above}))));
    }
    file["scenes"] = json::array({{{"nodes", std::move(roots)}}});
    file["scene"] = 0;
  }

 private:
  // Returns a primitive that has no material yet.
  json add_side(const PageSides::Side& side, bool has_image, WorldFile& result) {
    auto unified = unify_vertices<2>(side.indices.size(), [&](std::size_t k) {
      return std::array{side.indices[k], side.uv_indices[k]};
    });
    if (world_.compress_slip) {
      const auto where = order_for_packing(unified.indices, unified.vertices.size());
      const auto vertices = unified.vertices;
      for (std::size_t v = 0; v < where.size(); ++v) unified.vertices[where[v]] = vertices[v];
    }
    json primitive;
    const auto positions = gather(world_.positions, unified.vertices, 0);
    primitive["attributes"]["POSITION"] =
        grid_ ? document_.add_positions(positions, *grid_) : document_.add_positions(positions);
    // Uvs without an image were rounded so that no texel is drawn for two charts, and stay so.
    const auto uvs = gather(world_.uvs, unified.vertices, 1);
    primitive["attributes"]["TEXCOORD_0"] =
        world_.compress_slip && has_image ? document_.add_short_uvs(uvs) : document_.add_uvs(uvs);
    primitive["indices"] = document_.add_indices(unified.indices);
    result.triangles += unified.indices.size() / 3;
    result.vertices += unified.vertices.size();
    result.uvs += unified.vertices.size();
    return primitive;
  }

  // Adds the page's image, and returns a material that shows it.
  Result<json> material_of(const Page& page, const std::string& name) {
    json& file = document_.json;
    json material = {{"name", name}, {"doubleSided", true}};
    material["pbrMetallicRoughness"] = {{"metallicFactor", 0}, {"roughnessFactor", 1}};
    // A page without an image is lit by the viewer: unlit, it would be a silhouette.
    if (!page.image.empty()) {
      material["extensions"]["KHR_materials_unlit"] = json::object();
      document_.use("KHR_materials_unlit");
      file["samplers"] = json::array({{{"magFilter", kLinear},
                                       {"minFilter", kLinearMipmapLinear},
                                       {"wrapS", kClampToEdge},
                                       {"wrapT", kClampToEdge}}});
      Result<std::size_t> texture = add_texture(page, name);
      if (!texture.ok()) return texture.status();
      material["pbrMetallicRoughness"]["baseColorTexture"] = {{"index", *texture}};
    }
    return material;
  }

  // Adds the page's image as a texture, and returns its number.
  Result<std::size_t> add_texture(const Page& page, const std::string& name) {
    constexpr const char* kWebp = "EXT_texture_webp";
    const bool webp = lower_extension(page.image) == ".webp";
    json& file = document_.json;
    json image;
    if (document_.binary()) {
      auto bytes = read_image_bytes(page);
      if (!bytes.ok()) return bytes.status();
      image = document_.embedded_image(bytes->text(), webp ? "image/webp" : "image/png");
    } else {
      image = GltfDocument::image_beside(page.image);
    }
    image["name"] = name;
    file["images"].push_back(std::move(image));
    const std::size_t index = file["images"].size() - 1;
    json texture = {{"sampler", 0}};
    if (webp) {
      document_.use(kWebp, true);
      texture["extensions"][kWebp]["source"] = index;
    } else {
      texture["source"] = index;
    }
    file["textures"].push_back(std::move(texture));
    return index;
  }

  static Result<FileBytes> read_image_bytes(const Page& page) {
    auto bytes = read_file_bytes(page.image_source);
    if (!bytes.ok() || bytes->size == 0) {
      return Status(ErrorCode::io,
                    fmt::format("the page's image {} cannot be read from '{}' to embed it "
                                "(Page::image_source names where it lies)",
                                page.image, page.image_source.string()));
    }
    return bytes;
  }

  const World& world_;
  GltfDocument& document_;
  std::optional<PositionGrid> grid_ = {};  // of positions that become whole numbers
};

}  // namespace

Result<WorldFile> write_gltf(const World& world, const fs::path& path, AtomicFiles& files,
                             const Context& context) {
  if (Status s = check_world(world); !s.ok()) return s;
  if (Status s = check_only_triangles(world); !s.ok()) return s;
  if (world.scene != nullptr)
    return world.scene->source ? write_gltf_file(world, path, files, context)
                               : write_gltf_scene(world, path, files, context);
  WorldFile result;
  GltfDocument document(world, lower_extension(path) == ".glb");
  PagesWriter writer(world, document);
  for (std::size_t i = 0; i < world.pages.size(); ++i) {
    if (context.cancelled()) return Status::cancelled();
    if (world.pages[i].indices.empty()) continue;  // glTF forbids empty meshes
    if (Status s = writer.add_page(i, result); !s.ok()) return s;
    context.report("writing the world", double(i + 1) / double(world.pages.size()));
  }
  if (result.triangles == 0) {
    return Status(ErrorCode::bad_input,
                  path.string() + ": a glTF world needs at least one triangle");
  }
  writer.add_scene(result);
  if (Status s = document.write(path, files, result); !s.ok()) return s;
  return result;
}

}  // namespace atlas
