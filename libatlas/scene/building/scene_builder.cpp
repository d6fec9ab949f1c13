#include "libatlas/scene/building/scene_builder.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>
#include <unordered_map>

#include "libatlas/core/glm_bridge.h"
#include "libatlas/core/is_finite.h"
#include "libatlas/core/srgb.h"
#include "libatlas/image/file_kind.h"
#include "libatlas/image/image_io.h"
#include "libatlas/scene/building/frame.h"
#include "libatlas/scene/building/losses.h"
#include "libatlas/scene/files/file_bytes.h"

namespace atlas {
namespace {

constexpr std::uint32_t kUnset = 0xffffffffu;
constexpr double kPlaced = 0.5;  // share of the time of finish() until textures are loaded

// Renumbers ids by first use. Returns the old id of each new one.
std::vector<std::uint32_t> compact(std::vector<std::uint32_t>& ids, std::size_t count) {
  std::vector<std::uint32_t> to(count, kUnset), used;
  for (std::uint32_t& id : ids) {
    if (to[id] == kUnset) {
      to[id] = static_cast<std::uint32_t>(used.size());
      used.push_back(id);
    }
    id = to[id];
  }
  return used;
}

}  // namespace

bool SceneBuilder::may_read(const std::filesystem::path& named, const std::string& place) {
  if (named_files.allows(named)) return true;
  if (refused.ok())
    refused = {
        ErrorCode::bad_input,
        fmt::format("{}: names {}, which lies outside of the scene's folder (put it there, or "
                    "leave out ReadOptions::confine)",
                    place, named.string())};
  return false;
}

void SceneBuilder::take_view(const Vec3d& position, const Vec3d& direction, std::string name) {
  constexpr std::size_t kMostViews = 100;  // more than a menu shows
  const double length = glm::length(to_glm(direction));
  const Vec3d p = position;
  if (!std::isfinite(p.x + p.y + p.z + length) || length == 0) return;
  FileView taken{position, from_glm(to_glm(direction) / length), std::move(name)};
  if (!view)
    view = std::move(taken);
  else if (further_views.size() < kMostViews)
    further_views.push_back(std::move(taken));
}

std::int32_t SceneBuilder::texture_of(const std::filesystem::path& texture_file,
                                      const std::string& place) {
  const auto next = static_cast<std::int32_t>(textures.size());
  const auto [at, is_new] = texture_files_.try_emplace(texture_file, next);
  if (is_new) textures.push_back({texture_file, {}, place});
  return at->second;
}

void SceneBuilder::reserve_triangles(std::size_t count, bool with_texcoords) {
  indices_.reserve(count * 3);
  texcoord_indices_.reserve(with_texcoords ? count * 3 : 0);
  normal_indices_.reserve(wants_normals ? count * 3 : 0);
  triangle_material_.reserve(count);
  triangle_object_.reserve(count);
}

void SceneBuilder::sanitise_values() {
  const std::string& lit_by = illumination_file.empty() ? file : illumination_file;
  const auto vertex = [&](std::size_t i) { return fmt::format("{}: vertex {}", lit_by, i + 1); };
  for (std::size_t i = 0; i < illumination.size(); ++i) {
    float* values[3] = {&illumination[i].x, &illumination[i].y, &illumination[i].z};
    bool usable = true, negative = false;
    for (float* value : values) {
      if (!(std::fabs(*value) <= kMostLight)) *value = 0, usable = false;
      negative |= *value < 0;
    }
    if (!usable) defects.add(DefectKind::illumination_not_finite, [&] { return vertex(i); });
    if (negative) defects.add(DefectKind::illumination_negative, [&] { return vertex(i); });
  }
  for (std::size_t i = 0; i < texcoords.size(); ++i) {
    if (is_finite(texcoords[i])) continue;
    texcoords[i] = {};
    defects.add(DefectKind::texcoord_not_finite,
                [&] { return fmt::format("{}: texture coordinate {}", file, i + 1); });
  }
}

// Values beyond 0..1 have no meaning. They are left out, and counted.
void SceneBuilder::sanitise_opacity() {
  for (float& value : vertex_opacity) {
    if (value >= 0 && value <= 1) continue;
    value = 1;
    ++not_read[kVertexAlphaLoss];
  }
  const auto opaque = [](float value) { return value == 1; };
  if (std::all_of(vertex_opacity.begin(), vertex_opacity.end(), opaque)) vertex_opacity.clear();
}

// Values beyond 0..1 are no encoded colours.
void SceneBuilder::decode_colours() {
  for (Vec3f& rgb : illumination)
    for (float* value : {&rgb.x, &rgb.y, &rgb.z})
      if (*value > 0 && *value < 1) *value = srgb_decode(*value);
}

Status SceneBuilder::place_positions(Scene& scene) {
  FilePositions from{positions, indices_, std::vector<bool>(positions.size(), false)};
  for (const std::uint32_t v : indices_) from.used[v] = true;
  const double diagonal = diagonal_of_used(from);
  if (diagonal > 0 && diagonal < double(std::numeric_limits<float>::min())) {
    return {ErrorCode::unsupported,
            fmt::format("{}: the scene is {:g} units across, too small for single-precision floats "
                        "(export it in a smaller unit)",
                        file, diagonal)};
  }
  if (diagonal > double(std::numeric_limits<float>::max())) {
    return {ErrorCode::unsupported,
            fmt::format("{}: the scene is {:g} units across, too large for single-precision floats "
                        "(export it in a larger unit, and without stray vertices)",
                        file, diagonal)};
  }
  const Frame frame = choose_frame(from);
  scene.origin = frame.origin;
  scene.positions.resize(positions.size());
  for (std::size_t i = 0; i < positions.size(); ++i) {
    const Vec3f q = frame.stored(positions[i]);
    // A vertex that no triangle uses may hold anything, but the array promises finite numbers.
    scene.positions[i] = is_finite(q) ? q : Vec3f{};
  }
  const RoundingLoss loss = rounding_loss(from, frame);
  for (const std::uint32_t v : loss.moved)
    defects.add(DefectKind::position_rounded,
                [&] { return fmt::format("{}: vertex {}", file, v + 1); });
  for (const std::uint32_t t : loss.closed)
    defects.add(DefectKind::triangle_closed, [&] {
      return fmt::format("{}: vertex {} of triangle {}", file, indices_[3 * t] + 1, t + 1);
    });
  return {};
}

void SceneBuilder::keep_used(Scene& scene) {
  for (const std::uint32_t old : compact(triangle_object_, objects.size())) {
    scene.object_names.push_back(std::move(objects[old]));
  }
  std::vector<RawMaterial> kept;
  for (const std::uint32_t old : compact(triangle_material_, materials.size())) {
    kept.push_back(std::move(materials[old]));
  }
  materials = std::move(kept);
  if (source) return;
  std::vector<std::int32_t> texture_to(textures.size(), -1);
  std::vector<RawTexture> kept_textures;
  for (RawMaterial& m : materials) {
    if (m.texture < 0) continue;
    std::int32_t& to = texture_to[m.texture];
    if (to < 0) {
      to = static_cast<std::int32_t>(kept_textures.size());
      kept_textures.push_back(std::move(textures[m.texture]));
    }
    m.texture = to;
  }
  textures = std::move(kept_textures);
}

// Makes a lightmap of light_page. Triangles without texture coordinates are not on it.
void SceneBuilder::lay_on_light_page() {
  auto map = std::make_shared<SceneLightmap>();
  map->pages.push_back(std::move(light_page));
  map->white = light_white;
  map->texcoords = texcoords;
  map->texcoord_indices = texcoord_indices_;
  map->texcoord_indices.resize(indices_.size(), Scene::kNoTexcoord);
  map->triangle_page.assign(triangle_count(), 0);
  std::uint64_t absent = 0;
  for (std::size_t k = 0; k < indices_.size(); k += 3)
    absent += map->texcoord_indices[k] == Scene::kNoTexcoord;
  if (absent == triangle_count()) {
    defects.add(DefectKind::lightmap_unusable, [&] { return file + ": no face has vt"; });
    return;
  }
  if (absent > 0)
    defects.add(
        DefectKind::lightmap_absent, [&] { return file + ": faces without vt"; }, absent);
  lightmap = std::move(map);
}

void SceneBuilder::move_texcoords() {
  std::vector<std::unordered_map<std::uint32_t, std::uint32_t>> moved(materials.size());
  for (std::size_t k = 0; k < texcoord_indices_.size(); ++k) {
    const std::uint32_t m = triangle_material_[k / 3];
    if (texcoord_indices_[k] == Scene::kNoTexcoord || !materials[m].moves_uv()) continue;
    const auto next = static_cast<std::uint32_t>(texcoords.size());
    const auto [at, is_new] = moved[m].try_emplace(texcoord_indices_[k], next);
    if (is_new) {
      const Vec2f uv = texcoords[texcoord_indices_[k]];
      const RawMaterial& raw = materials[m];
      const auto row = [&](const std::array<double, 3>& r) {
        return float(uv.x * r[0] + uv.y * r[1] + r[2]);
      };
      Vec2f to{row(raw.uv_u), row(raw.uv_v)};
      if (!is_finite(to)) {
        to = {};
        defects.add(DefectKind::texcoord_not_finite, [&] {
          return fmt::format("{}: texture coordinate {} as material '{}' moves it", file,
                             texcoord_indices_[k] + 1, raw.name);
        });
      }
      texcoords.push_back(to);
    }
    texcoord_indices_[k] = at->second;
  }
}

// Checks first whether the file exists, because asking the decoder for it would load a large
// library.
Result<TextureImage> SceneBuilder::load_texture(const RawTexture& raw) const {
  if (!raw.bytes.empty()) {
    Result<Image8> image = decode_image8(raw.bytes, raw.path.string());
    if (!image.ok()) return image.status();
    return TextureImage{std::move(*image)};
  }
  std::error_code error;
  if (std::filesystem::status(raw.path, error).type() == std::filesystem::file_type::not_found) {
    return Status(ErrorCode::not_found, raw.path.string());
  }
  return read_texture(raw.path);
}

// If the texture is a PNG or JPEG file, appends it to the scene's textures and returns true. Files
// of formats that glTF holds only by extensions are kept beside a glTF source.
bool SceneBuilder::keep_encoded(std::size_t texture, Scene& scene) {
  RawTexture& raw = textures[texture];
  std::vector<std::uint8_t> read;
  if (raw.bytes.empty()) {
    const auto file_bytes = read_file_bytes(raw.path);
    if (!file_bytes.ok()) return false;
    read.assign(file_bytes->begin(), file_bytes->end());
  }
  std::vector<std::uint8_t>& bytes = raw.bytes.empty() ? read : raw.bytes;
  if (image_extension(bytes).empty()) {
    if (source && (raw.of_extension || !extension_format(bytes).extension.empty()))
      image_files[texture] = bytes;
    return false;
  }
  scene.textures.push_back({raw.path, {}, std::move(bytes)});
  return true;
}

// Adds the texture to the files that are read, unless it is embedded or missing.
void SceneBuilder::note_file(const RawTexture& raw) {
  std::error_code error;
  if (raw.bytes.empty() && std::filesystem::exists(raw.path, error)) files.push_back(raw.path);
}

// Returns which of `other_files` exist and are not among `files`, each once.
std::vector<std::filesystem::path> SceneBuilder::unread_files() const {
  std::set<std::filesystem::path> known(files.begin(), files.end());
  std::vector<std::filesystem::path> unread;
  for (const std::filesystem::path& path : other_files) {
    if (named_files.exists(path) && known.insert(path).second) unread.push_back(path);
  }
  return unread;
}

// Returns which of `textures` materials have.
std::vector<bool> SceneBuilder::textures_of_materials() const {
  std::vector<bool> used(textures.size());
  for (const RawMaterial& m : materials)
    if (m.texture >= 0) used[std::size_t(m.texture)] = true;
  return used;
}

Status SceneBuilder::load_textures(Scene& scene, bool encoded, const Context& context) {
  std::vector<std::int32_t> loaded(textures.size(), -1);
  const std::vector<bool> used = textures_of_materials();
  image_files.resize(textures.size());
  for (std::size_t i = 0; i < textures.size(); ++i) {
    if (context.cancelled()) return Status::cancelled();
    context.report("reading", kPlaced + (1 - kPlaced) * double(i) / double(textures.size()));
    RawTexture& raw = textures[i];
    if (raw.bytes.empty() && !may_read(raw.path, raw.place)) return refused;
    note_file(raw);
    if (encoded && keep_encoded(i, scene)) {
      loaded[i] = static_cast<std::int32_t>(scene.textures.size()) - 1;
      continue;
    }
    const bool kept = !image_files[i].empty();
    if (kept && raw.of_extension && !used[i]) continue;
    auto image = load_texture(raw);
    if (!image.ok() && kept) continue;
    if (image.ok()) {
      if (!raw.of_extension) image_files[i].clear();  // PNG holds it without an extension
      loaded[i] = static_cast<std::int32_t>(scene.textures.size());
      if (image->clipped)
        defects.add(DefectKind::texture_clipped, [&] { return raw.path.string(); });
      scene.textures.push_back({raw.path, std::move(image->image)});
      continue;
    }
    const bool missing = image.status().code() == ErrorCode::not_found;
    defects.add(missing ? DefectKind::texture_missing : DefectKind::texture_unreadable, [&] {
      const std::string path = raw.path.string();
      const std::string place = raw.place.empty() ? path : fmt::format("{} ({})", path, raw.place);
      if (missing) return place;
      const std::string& why = image.status().message();
      return place + ": " + (why.rfind(path + ": ", 0) == 0 ? why.substr(path.size() + 2) : why);
    });
  }
  for (std::size_t i = 0; i < materials.size(); ++i) {
    const std::int32_t t = materials[i].texture;
    scene.materials[i].texture = t < 0 ? -1 : loaded[t];
  }
  texture_numbers = std::move(loaded);
  return {};
}

// Moves the materials into the scene. Their textures follow in load_textures().
void SceneBuilder::place_materials(const ReadOptions& options, Scene& scene) {
  Losses losses;
  losses.add(not_read);
  for (const RawMaterial& m : materials) {
    // The lines of an MTL and a glTF file say themselves which textures there are.
    if (wants_rest && !options.load_textures && m.mtl_lines.empty() && !source)
      losses.add("textures of materials", m.texture >= 0);
    scene.materials.push_back(m);
    scene.materials.back().texture = -1;
    if (wants_rest) continue;
    count_mtl_losses(m, losses);
    scene.materials.back().mtl_lines.clear();
  }
  scene.not_read = losses.counts();
}

void SceneBuilder::place_uv_aspects(LoadedScene& loaded) const {
  std::vector<double> aspects;
  for (const RawMaterial& m : materials) {
    const auto set = m.page_set < 0 ? m.uv_set : m.page_set;
    aspects.push_back(uv_pages.aspect_of(m.name, set));
    loaded.material_uv_pages.push_back(uv_pages.page_of(m.name, set));
  }
  loaded.uv_pages = uv_pages.pages_of(materials.empty()           ? 0
                                      : materials[0].page_set < 0 ? materials[0].uv_set
                                                                  : materials[0].page_set);
  if (aspects.empty()) aspects.push_back(uv_pages.aspect_of({}));
  loaded.uv_aspect = aspects[0];
  if (std::all_of(aspects.begin(), aspects.end(), [&](double a) { return a == aspects[0]; }))
    return;
  loaded.uv_aspect = 0;
  for (double& aspect : aspects)
    if (aspect == 0) aspect = 1;
  loaded.material_uv_aspects = std::move(aspects);
}

Result<LoadedScene> SceneBuilder::finish(const ReadOptions& options, const Context& context) {
  if (context.cancelled()) return Status::cancelled();
  if (triangle_count() == 0) {
    const std::string why = defects.triangles_left_out == 0
                                ? "it holds no face"
                                : fmt::format("all {} faces are unusable: {}",
                                              defects.triangles_left_out, defects.lines().front());
    return Status(
        ErrorCode::bad_input,
        fmt::format("{}: no triangle to work on: {} (export the scene as a triangle mesh)", file,
                    why));
  }
  colour_corners();
  sanitise_values();
  sanitise_opacity();
  if (options.srgb_colours && !linear_light) decode_colours();
  LoadedScene loaded;
  Scene& scene = loaded.scene;
  scene.metres_per_unit = options.metres_per_unit;
  if (Status s = place_positions(scene); !s.ok()) return s;
  std::vector<Vec3d>().swap(positions);
  if (context.cancelled()) return Status::cancelled();
  for (const RawTexture& texture : textures) other_files.push_back(texture.path);
  keep_used(scene);
  if (!light_page.empty()) lay_on_light_page();
  move_texcoords();
  place_materials(options, scene);
  place_uv_aspects(loaded);
  context.report("reading", kPlaced);
  if (options.load_textures && (options.unlit_textures || !illumination.empty())) {
    if (Status s = load_textures(scene, options.encoded_textures, context); !s.ok()) return s;
  }
  loaded.unread_files = unread_files();
  scene.indices = std::move(indices_);
  place_normals(scene);
  scene.polygons = std::move(polygons_);
  scene.source = std::move(source);
  scene.texcoord_indices = std::move(texcoord_indices_);
  scene.texcoords = std::move(texcoords);
  scene.triangle_material = std::move(triangle_material_);
  scene.triangle_object = std::move(triangle_object_);
  scene.illumination = std::move(illumination);
  if (!unlit_colours.empty()) unlit_colours.resize(scene.positions.size(), {1, 1, 1});
  scene.unlit_colours = std::move(unlit_colours);
  scene.vertex_opacity = std::move(vertex_opacity);
  scene.lightmap = std::move(lightmap);
  loaded.view = view;
  loaded.further_views = std::move(further_views);
  loaded.defects = std::move(defects);
  if (context.cancelled()) return Status::cancelled();
  return loaded;
}

}  // namespace atlas
