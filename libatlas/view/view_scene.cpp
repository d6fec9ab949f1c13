#include "libatlas/view/view_scene.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <span>
#include <tuple>

#include "libatlas/core/counting_sort.h"
#include "libatlas/core/degrees.h"
#include "libatlas/core/first_index.h"
#include "libatlas/core/glm_bridge.h"
#include "libatlas/scene/check_scene.h"
#include "libatlas/view/view_geometry.h"
#include "libatlas/view/view_light.h"

namespace atlas {
namespace {

constexpr std::uint32_t kNone = Scene::kNoTexcoord;

// Polls for cancellation and reports progress in loops.
class Steps {
 public:
  explicit Steps(const Context& context) : context_(context) {}

  // Returns whether the loop may go on with item i of n. The loop's share of the whole work is from
  // `from` to `to`.
  bool go_on(std::size_t i, std::size_t n, double from, double to) const {
    if (i % kItems != 0) return true;
    context_.report("preparing", from + (to - from) * double(i) / double(n));
    return !context_.cancelled();
  }
  void done() const { context_.report("preparing", 1); }
  bool cancelled() const { return context_.cancelled(); }

 private:
  static constexpr std::size_t kItems = 1 << 15;
  const Context& context_;
};

// Welds positions that are equal (-0 and 0 are). Readers keep what files say, and many files repeat
// every corner, which would otherwise make every edge a crease.
std::vector<std::uint32_t> weld(const std::vector<Vec3f>& positions, const Steps& steps) {
  FirstIndex first(positions.size());
  std::vector<std::uint32_t> out(positions.size());
  for (std::uint32_t i = 0; i < out.size() && steps.go_on(i, out.size(), 0, 0.05); ++i) {
    const Vec3f& p = positions[i];
    std::uint32_t& entry = first.find(hash_words<3>({word_of(p.x), word_of(p.y), word_of(p.z)}),
                                      [&](std::uint32_t k) { return positions[k] == p; });
    if (entry == kNoIndex) entry = i;
    out[i] = entry;
  }
  return out;
}

// Returns the corners at each welded vertex.
Buckets corners_by_vertex(const std::vector<std::uint32_t>& welded,
                          const std::vector<std::uint32_t>& indices) {
  return sort_into_buckets(indices.size(), welded.size(),
                           [&](std::size_t corner) { return welded[indices[corner]]; });
}

// Returns area-weighted normals of all triangles, relative to the square of the largest coordinate,
// since areas leave the range of float sooner than lengths. Degenerate triangles have the normal 0.
std::vector<glm::vec3> face_normals(const Scene& scene, const Steps& steps) {
  std::vector<glm::vec3> normals(scene.triangle_count());
  double largest = 1e-300;
  for (const Vec3f& p : scene.positions)
    largest =
        std::max({largest, double(std::abs(p.x)), double(std::abs(p.y)), double(std::abs(p.z))});
  const std::size_t n = normals.size();
  for (std::size_t t = 0; t < n && steps.go_on(t, n, 0.1, 0.15); ++t) {
    const glm::dvec3 a = to_dvec(scene.positions[scene.indices[3 * t]]),
                     b = to_dvec(scene.positions[scene.indices[3 * t + 1]]),
                     c = to_dvec(scene.positions[scene.indices[3 * t + 2]]);
    normals[t] = glm::vec3(glm::cross((b - a) / largest, (c - a) / largest));
  }
  return normals;
}

// One vertex is drawn for each different corner: position, both texcoords, material, and the normal
// in steps of 1/16000.
using CornerKey = std::array<std::uint32_t, 6>;

std::uint32_t two_words(float low, float high) {
  const auto word = [](float n) { return std::uint32_t(std::uint16_t(std::lround(n * 16000))); };
  return word(low) | word(high) << 16;
}

// Returns no emission if a texture shapes it. Such textures are not read, and their factor alone
// would light up what they leave dark.
Vec3f plain_emission(const Material& material) {
  return material.emission_textured ? Vec3f{} : material.emission;
}

class Builder {
 public:
  Builder(const Scene& scene, const ViewSceneOptions& options, const Context& context)
      : scene_(scene),
        steps_(context),
        hold_light_(options.textures_hold_light),
        welded_(weld(scene.positions, steps_)),
        corners_at_(corners_by_vertex(welded_, scene.indices)),
        faces_(face_normals(scene, steps_)),
        cosine_(float(cosine_of(options.crease_degrees))),
        first_(scene.indices.size()) {
    coloured_ = options.vertices_hold_colours && scene.lit();
    lit_ = scene.lit() && !coloured_;
    textured_ = scene.textured() && !scene.texcoord_indices.empty() && !coloured_;
    emits_ = std::any_of(scene.materials.begin(), scene.materials.end(),
                         [](const Material& m) { return plain_emission(m) != Vec3f{}; });
    std::size_t unlit = 0;
    for (const std::uint32_t m : scene.triangle_material) unlit += is_unlit(scene.materials[m]);
    view_.unlit = unlit == 0                        ? Unlit::none
                  : unlit == scene.triangle_count() ? Unlit::all
                                                    : Unlit::some;
    if (scene.lightmap) use_lightmap();
  }

  ViewScene::Look look_of(std::uint32_t triangle) const {
    const Material& m = material_of(triangle);
    const bool unlit = is_unlit(m), one_sided = unlit && !m.double_sided;
    const std::int32_t light = light_page_of(triangle);
    if (!shows_texture(m)) return {.one_sided = one_sided, .light_page = light};
    const bool page = unlit && m.wrap_u == TextureWrap::clamp && m.wrap_v == TextureWrap::clamp;
    return {m.texture, m.wrap_u, m.wrap_v, one_sided, page, cutoff_of(m), light};
  }

  // Returns the triangles grouped by look, and within each look along a curve that keeps neighbours
  // together. If cancelled, returns none.
  std::vector<std::uint32_t> order() const {
    glm::dvec3 low(1e300), high(-1e300);
    for (const Vec3f& p : scene_.positions) {
      low = glm::min(low, to_dvec(p));
      high = glm::max(high, to_dvec(p));
    }
    const glm::dvec3 size = high - low;
    const double scale = 1023.0 / std::max({size.x, size.y, size.z, 1e-300});
    std::vector<std::uint32_t> triangles, codes(scene_.triangle_count());
    for (std::uint32_t t = 0; t < codes.size(); ++t)
      if (!is_invisible(material_of(t))) triangles.push_back(t);
    for (std::size_t t = 0; t < codes.size(); ++t) {
      if (!steps_.go_on(t, codes.size(), 0.15, 0.2)) return {};
      glm::dvec3 sum(0);
      for (int k = 0; k < 3; ++k) sum += to_dvec(scene_.positions[scene_.indices[3 * t + k]]);
      codes[t] = morton_code((sum / 3.0 - low) * scale);
    }
    std::sort(triangles.begin(), triangles.end(), [&](std::uint32_t a, std::uint32_t b) {
      const auto key = [&](std::uint32_t t) { return std::tuple(look_of(t), codes[t], t); };
      return key(a) < key(b);
    });
    return triangles;
  }

  // If cancelled, returns a part.
  ViewScene build(std::uint32_t cluster_triangles) {
    const std::vector<std::uint32_t> triangles = order();
    for (std::size_t i = 0; i < triangles.size(); ++i) {
      if (!steps_.go_on(i, triangles.size(), 0.35, 0.85)) return std::move(view_);
      const std::uint32_t t = triangles[i];
      const ViewScene::Look look = look_of(t);
      if (view_.clusters.empty() || view_.clusters.back().look != look ||
          view_.clusters.back().count >= 3 * cluster_triangles)
        view_.clusters.push_back({std::uint32_t(view_.indices.size()), 0, look, {}, 0});
      for (int k = 0; k < 3; ++k) view_.indices.push_back(vertex(t, k));
      view_.clusters.back().count += 3;
    }
    for (ViewScene::Cluster& c : view_.clusters) enclose(view_, c);
    add_casters();
    if (steps_.cancelled()) return std::move(view_);
    measure();
    view_.light_scale = light_scale_of(view_);
    const auto full = float(1 / view_.light_scale);
    for (const std::uint32_t v : on_pages_) view_.illumination[v] = {full, full, full};
    steps_.done();
    return std::move(view_);
  }

 private:
  const Material& material_of(std::uint32_t triangle) const {
    return scene_.materials[scene_.triangle_material[triangle]];
  }
  // Returns whether holes of a mask depend on a texture.
  bool has_holes(const Material& m) const {
    return m.alpha_mode == AlphaMode::mask && shows_texture(m) &&
           scene_.textures[std::size_t(m.texture)].image.channels % 2 == 0;
  }
  bool is_invisible(const Material& m) const {
    return m.alpha_mode == AlphaMode::mask && !has_holes(m) && m.opacity < m.alpha_cutoff;
  }
  // A share of the texture's alpha remains, so the limit is higher; 2 is more than any alpha.
  float cutoff_of(const Material& m) const {
    if (!has_holes(m) || m.alpha_cutoff <= 0) return 0;
    return m.opacity * 2 > m.alpha_cutoff ? m.alpha_cutoff / m.opacity : 2.0f;
  }
  // More than half of the light passes through what casts none.
  bool casts_by_itself(const Material& m) const {
    const bool clear = m.alpha_mode == AlphaMode::blend && m.opacity < 0.5f;
    return !clear && !is_invisible(m) && cutoff_of(m) == 0;
  }
  bool shows_texture(const Material& m) const { return textured_ && m.texture >= 0; }
  bool is_unlit(const Material& m) const {
    if (!hold_light_) return m.unlit;
    return *hold_light_ && (m.unlit || shows_texture(m));
  }

  // Leaves out the lightmap where no triangle shows it, and the vertices' light where all do.
  void use_lightmap() {
    bool some = false, all = true;
    for (std::uint32_t t = 0; t < scene_.triangle_count(); ++t) {
      if (is_invisible(material_of(t))) continue;
      const bool mapped = light_page_of(t) >= 0;
      some |= mapped;
      all &= mapped;
    }
    if (!some) return;
    view_.lightmap = scene_.lightmap;
    lit_ = lit_ && !all;
  }

  // Returns the triangle's page of the lightmap, or -1. Unlit materials show their own light.
  std::int32_t light_page_of(std::uint32_t triangle) const {
    if (!scene_.lightmap || is_unlit(material_of(triangle)) ||
        scene_.lightmap->texcoord_indices[3 * std::size_t(triangle)] == kNone)
      return -1;
    return std::int32_t(scene_.lightmap->triangle_page[triangle]);
  }

  // Returns the colour that textures multiply. A texture that only the caller calls unlit shows
  // light, to which the vertices' own adds nothing.
  Vec3f colour_of(const Material& m, std::uint32_t position) const {
    if (scene_.unlit_colours.empty() || !m.unlit || !is_unlit(m) || !shows_texture(m))
      return m.diffuse;
    const Vec3f& factor = scene_.unlit_colours[position];
    return {m.diffuse.x * factor.x, m.diffuse.y * factor.y, m.diffuse.z * factor.z};
  }

  std::uint32_t vertex(std::uint32_t t, int k) {
    const std::uint32_t corner = 3 * t + std::uint32_t(k), p = scene_.indices[corner];
    const glm::vec3 n = corner_normal(corners_at_[welded_[p]], faces_, t, cosine_);
    const std::uint32_t material = scene_.triangle_material[t],
                        texcoord = textured_ ? scene_.texcoord_indices[corner] : kNone;
    const bool mapped = light_page_of(t) >= 0;
    const std::uint32_t light_texcoord = mapped ? scene_.lightmap->texcoord_indices[corner] : kNone;
    const bool own_values = scene_.lit() || !scene_.unlit_colours.empty();
    const CornerKey key{own_values ? p : welded_[p], texcoord,         light_texcoord, material,
                        two_words(n.x, n.y),         two_words(n.z, 0)};
    std::uint32_t& vertex =
        first_.find(hash_words(key), [&](std::uint32_t v) { return keys_[v] == key; });
    if (vertex != kNoIndex) return vertex;
    vertex = std::uint32_t(keys_.size());
    keys_.push_back(key);
    view_.positions.push_back(scene_.positions[p]);
    view_.normals.push_back(from_glm(n));
    const Material& m = scene_.materials[material];
    view_.colours.push_back(coloured_ ? scene_.illumination[p] : colour_of(m, p));
    if (emits_) view_.emission.push_back(plain_emission(m));
    if (view_.unlit == Unlit::some) view_.unlit_vertices.push_back(is_unlit(m));
    if (textured_)
      view_.texcoords.push_back(texcoord == kNone ? Vec2f{} : scene_.texcoords[texcoord]);
    if (view_.lightmap)
      view_.light_texcoords.push_back(mapped ? scene_.lightmap->texcoords[light_texcoord]
                                             : Vec2f{});
    if (lit_) view_.illumination.push_back(mapped ? Vec3f{} : scene_.illumination[p]);
    if (lit_ && is_unlit(m) && shows_texture(m)) on_pages_.push_back(vertex);
    return vertex;
  }

  void add_casters() {
    std::vector<std::uint32_t> renumbered(scene_.positions.size(), kNone);
    for (std::size_t k = 0; k < scene_.indices.size(); ++k) {
      if (!steps_.go_on(k, scene_.indices.size(), 0.85, 0.95)) return;
      if (!casts_by_itself(material_of(std::uint32_t(k / 3)))) continue;
      const std::uint32_t w = welded_[scene_.indices[k]];
      if (renumbered[w] == kNone) {
        renumbered[w] = std::uint32_t(view_.caster_positions.size());
        view_.caster_positions.push_back(scene_.positions[w]);
      }
      view_.caster_indices.push_back(renumbered[w]);
    }
  }

  void measure() {
    glm::dvec3 low(1e300), high(-1e300);
    for (const Vec3f& p : view_.positions) {
      low = glm::min(low, to_dvec(p));
      high = glm::max(high, to_dvec(p));
    }
    view_.bounds = {from_glm(low), from_glm(high)};
    view_.middle = middle_of(view_.positions);
  }

  const Scene& scene_;
  const Steps steps_;
  std::optional<bool> hold_light_;  // ViewSceneOptions::textures_hold_light
  std::vector<std::uint32_t> welded_;
  Buckets corners_at_;  // of each welded vertex
  std::vector<glm::vec3> faces_;
  float cosine_;
  bool textured_ = false, emits_ = false;
  bool lit_ = false, coloured_ = false;  // what the vertices hold: light, or colours
  std::vector<std::uint32_t> on_pages_;  // vertices whose textures hold light, if others are lit
  ViewScene view_;
  FirstIndex first_;             // into keys_
  std::vector<CornerKey> keys_;  // of view_'s vertices
};

}  // namespace

Result<ViewScene> make_view_scene(const Scene& scene, const ViewSceneOptions& options,
                                  const Context& context) {
  if (scene.triangle_count() == 0)
    return Status{ErrorCode::bad_input, "the scene has no triangles: there is nothing to show"};
  if (Status s = check_scene(scene); !s.ok()) return s;
  ViewScene view = Builder(scene, options, context).build(std::max(options.cluster_triangles, 1u));
  if (context.cancelled()) return Status::cancelled();
  if (view.indices.empty())
    return Status{
        ErrorCode::bad_input,
        "all triangles are invisible (the opacity of their materials is below the cutoff)"};
  if (view.textured()) view.textures = scene.textures;
  view.origin = scene.origin;
  view.metres_per_unit = scene.metres_per_unit;
  return view;
}

}  // namespace atlas
