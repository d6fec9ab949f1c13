#include "libatlas/texture/luminance.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <cstring>

#include "libatlas/core/glm_bridge.h"
#include "libatlas/texture/texture_levels.h"

namespace atlas {
namespace {

// The number of texels that are kept decoded, over all textures: 16 MiB. Decoding takes a third of
// the time of a lookup. Textures that repeat over a surface are looked up most, and they are small.
constexpr std::size_t kDecodedTexels = std::size_t{1} << 20;

// The largest texture coordinate of a triangle, in texels, at which the texture is still looked up.
constexpr float kMostTexels = 1 << 23;

// The inputs that one output of a shortened row spans: the first of them, their number and their
// weights.
struct Span {
  int first = 0, count = 0;
  float weight[4] = {};
};

std::vector<Span> box_spans(int size, int n) {
  std::vector<Span> spans(n);
  const double step = static_cast<double>(size) / n;  // between 1 and 3
  for (int i = 0; i < n; ++i) {
    const double a = i * step, b = std::min<double>((i + 1) * step, size);
    Span& s = spans[i];
    s.first = static_cast<int>(a);
    for (int k = s.first; k < b && s.count < 4; ++k)
      s.weight[s.count++] =
          static_cast<float>((std::min<double>(k + 1, b) - std::max<double>(k, a)) / (b - a));
  }
  return spans;
}

Image8 halve(const TextureLevels::Level& in) {
  const int w = std::max(1, in.width / 2), h = std::max(1, in.height / 2),
            c = in.channels >= 3 ? 3 : 1;
  const std::vector<Span> columns = box_spans(in.width, w), rows = box_spans(in.height, h);
  Image8 out(w, h, c);
  for (int y = 0; y < h; ++y)
    for (int x = 0; x < w; ++x)
      for (int k = 0; k < c; ++k) {
        float sum = 0;
        for (int j = 0; j < rows[y].count; ++j)
          for (int i = 0; i < columns[x].count; ++i) {
            const std::size_t at = std::size_t(rows[y].first + j) * in.width + columns[x].first + i;
            sum += rows[y].weight[j] * columns[x].weight[i] *
                   srgb_decode8(in.texels[at * in.channels + k]);
          }
        out.at(x, y)[k] = srgb_encode8(sum);
      }
  return out;
}

// Returns the number of whole repeats that is subtracted from the coordinates of a triangle, so
// that coordinates far from zero lose no precision.
float whole_repeats(float least, TextureWrap wrap) {
  if (wrap == TextureWrap::clamp) return 0;
  return wrap == TextureWrap::mirror ? 2 * std::floor(least / 2) : std::floor(least);
}

// Compares in registers. memcmp would be a function call.
bool same_bits(const float (&a)[4], const float (&b)[4]) {
  std::uint64_t x[2], y[2];
  std::memcpy(x, a, sizeof x);
  std::memcpy(y, b, sizeof y);
  return ((x[0] ^ y[0]) | (x[1] ^ y[1])) == 0;
}

// Returns the texture of triangle t if it has one that can be looked up, or -1.
std::int32_t texture_of(const Scene& scene, std::uint32_t t) {
  const std::int32_t id = scene.materials[scene.triangle_material[t]].texture;
  if (id < 0 || scene.texcoord_indices.empty()) return -1;
  const Image8& image = scene.textures[id].image;
  if (image.width <= 0 || image.height <= 0 || image.channels <= 0) return -1;
  for (int k = 0; k < 3; ++k)
    if (scene.texcoord_indices[3 * std::size_t(t) + k] == Scene::kNoTexcoord) return -1;
  return id;
}

}  // namespace

TextureLevels::TextureLevels(const Texture& texture) {
  const Image8& image = texture.image;
  if (image.width <= 0 || image.height <= 0 || image.channels <= 0) return;
  Level level{image.width, image.height, image.channels, image.texels.data()};
  levels.push_back(level);
  while (level.width > 1 || level.height > 1) {
    storage.push_back(halve(level));
    const Image8& small = storage.back();  // its texels do not move when storage grows
    level = {small.width, small.height, small.channels, small.texels.data()};
    levels.push_back(level);
  }
}

std::size_t TextureLevels::texels() const {
  std::size_t sum = 0;
  for (const Level& l : levels) sum += std::size_t(l.width) * l.height;
  return sum;
}

void TextureLevels::decode() {
  decoded_storage.reserve(levels.size());
  for (Level& l : levels) {
    const EncodedTexels texel{l.texels, static_cast<std::size_t>(l.channels)};
    std::vector<Lanes>& to = decoded_storage.emplace_back(std::size_t(l.width) * l.height);
    for (std::size_t i = 0; i < to.size(); ++i) to[i] = texel(i);
    l.decoded = to.data();
  }
}

struct LuminanceSampler::State {
  const Scene& scene;
  Quantity quantity;
  std::vector<TextureLevels> textures;

  State(const Scene& s, Quantity q) : scene(s), quantity(q) {
    if (quantity == Quantity::illuminance) {
      textures.reserve(scene.textures.size());
      std::size_t room = kDecodedTexels;
      for (const Texture& t : scene.textures) {
        textures.emplace_back(t);
        if (textures.back().texels() > room) continue;
        textures.back().decode();
        room -= textures.back().texels();
      }
    }
  }

  const Material& material(std::uint32_t t) const {
    return scene.materials[scene.triangle_material[t]];
  }

  // Returns the illumination at a corner of triangle t, times Kd if it is illuminance.
  Vec3f untextured(std::uint32_t t, int corner) const {
    const std::size_t at = 3 * std::size_t(t) + static_cast<std::size_t>(corner);
    const Vec3f e = scene.lit() ? scene.illumination[scene.indices[at]] : Vec3f{1, 1, 1};
    if (quantity != Quantity::illuminance) return e;
    const Vec3f kd = material(t).diffuse;
    return {e.x * kd.x, e.y * kd.y, e.z * kd.z};
  }

  const TextureLevels* texture(std::uint32_t t) const {
    const std::int32_t id = texture_of(scene, t);
    return quantity == Quantity::illuminance && id >= 0 ? &textures[id] : nullptr;
  }
};

LuminanceSampler::LuminanceSampler(const Scene& scene, Quantity quantity)
    : state_(std::make_unique<const State>(scene, quantity)) {}
LuminanceSampler::~LuminanceSampler() = default;
LuminanceSampler::LuminanceSampler(LuminanceSampler&&) noexcept = default;
LuminanceSampler& LuminanceSampler::operator=(LuminanceSampler&&) noexcept = default;

const Scene& LuminanceSampler::scene() const {
  return state_->scene;
}

double LuminanceSampler::texture_density(std::uint32_t t) const {
  return state_->quantity == Quantity::illuminance ? atlas::texture_density(scene(), t) : 0;
}

int LuminanceSampler::bad_corner(std::uint32_t t) const {
  const auto good = [](float v) { return std::fabs(v) <= kMostLight; };
  int corner = 0;
  for (; corner < 3; ++corner) {
    const Vec3f e = state_->untextured(t, corner);
    if (!good(e.x) || !good(e.y) || !good(e.z)) break;
  }
  return corner;
}

LuminanceSampler::Triangle LuminanceSampler::prepare(std::uint32_t t, double sample_spacing) const {
  const Scene& s = state_->scene;
  assert(t < s.triangle_count());
  Triangle out{};
  for (int k = 0; k < 3; ++k) {
    const Vec3f e = state_->untextured(t, k);
    out.illumination[k][0] = e.x;
    out.illumination[k][1] = e.y;
    out.illumination[k][2] = e.z;
  }
  const bool equal = same_bits(out.illumination[0], out.illumination[1]) &&
                     same_bits(out.illumination[0], out.illumination[2]);
  out.texture = state_->texture(t);
  const bool black = equal && out.illumination[0][0] == 0 && out.illumination[0][1] == 0 &&
                     out.illumination[0][2] == 0;
  if (!out.texture || black) {
    out.texture = nullptr;
    out.constant = equal;
    return out;
  }
  const auto& levels = out.texture->levels;
  // If a sample spans slightly more than one texel of the texture, level 0 is still read. A texture
  // that is half a level too sharp is less visible than one that is half a level too blurred.
  const double ratio = sample_spacing * texture_density(t);
  if (ratio > 1)
    out.level =
        static_cast<int>(std::clamp(std::floor(std::log2(ratio) + 0.25), 0.0, levels.size() - 1.0));
  const TextureLevels::Level& level = levels[out.level];
  Vec2f c[3];
  for (int k = 0; k < 3; ++k) c[k] = s.texcoords[s.texcoord_indices[3 * std::size_t(t) + k]];
  out.wrap_u = s.materials[s.triangle_material[t]].wrap_u;
  out.wrap_v = s.materials[s.triangle_material[t]].wrap_v;
  const float u0 = whole_repeats(std::min({c[0].x, c[1].x, c[2].x}), out.wrap_u);
  const float v0 = whole_repeats(std::min({c[0].y, c[1].y, c[2].y}), out.wrap_v);
  for (int k = 0; k < 3; ++k) {
    out.texcoord[k][0] = (c[k].x - u0) * level.width;
    out.texcoord[k][1] = (c[k].y - v0) * level.height;
    // A float cannot represent positions across millions of texels. The texture's mean, which is
    // the last level, is used instead.
    if (!(std::fabs(out.texcoord[k][0]) < kMostTexels) ||
        !(std::fabs(out.texcoord[k][1]) < kMostTexels)) {
      out.level = static_cast<int>(levels.size()) - 1;
      std::fill_n(&out.texcoord[0][0], 6, 0.0f);
      break;
    }
  }
  return out;
}

Vec3f LuminanceSampler::sample(const Triangle& tri, float b0, float b1, float b2) {
  Lanes rgb = splat_lanes(1);
  if (tri.texture) {
    const float x = b0 * tri.texcoord[0][0] + b1 * tri.texcoord[1][0] + b2 * tri.texcoord[2][0];
    const float y = b0 * tri.texcoord[0][1] + b1 * tri.texcoord[1][1] + b2 * tri.texcoord[2][1];
    rgb = look_up(tri.texture->levels[tri.level], {x, y}, {tri.wrap_u, tri.wrap_v});
  }
  const auto lane = [&](int k) {
    return rgb[k] * (b0 * tri.illumination[0][k] + b1 * tri.illumination[1][k] +
                     b2 * tri.illumination[2][k]);
  };
  return {lane(0), lane(1), lane(2)};
}

double texture_density(const Scene& s, std::uint32_t t) {
  const std::int32_t id = texture_of(s, t);
  if (id < 0) return 0;
  glm::dvec3 p[3];
  glm::dvec2 c[3];
  for (int k = 0; k < 3; ++k) {
    p[k] = to_dvec(s.positions[s.indices[3 * std::size_t(t) + k]]);
    c[k] = to_dvec(s.texcoords[s.texcoord_indices[3 * std::size_t(t) + k]]);
  }
  const double surface = glm::length(glm::cross(p[1] - p[0], p[2] - p[0]));
  const glm::dvec2 a = c[1] - c[0], b = c[2] - c[0];
  const Image8& image = s.textures[id].image;
  const double texels = std::fabs(a.x * b.y - a.y * b.x) * image.width * image.height;
  return surface > 0 && texels > 0 ? std::sqrt(texels / surface) : 0;
}

}  // namespace atlas
