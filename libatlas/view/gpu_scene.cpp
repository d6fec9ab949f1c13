#include "libatlas/view/gpu_scene.h"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cmath>

#include "libatlas/core/glm_bridge.h"
#include "libatlas/view/mask_colours.h"

namespace atlas {
namespace {

template <class T>
GlBuffer buffer_of(const std::vector<T>& data) {
  return make_buffer(data.data(), data.size() * sizeof(T));
}

std::vector<Vec3f> moved(std::vector<Vec3f> positions, const glm::dvec3& origin) {
  for (Vec3f& p : positions) p = from_glm(glm::vec3(to_dvec(p) - origin));
  return positions;
}

// One value per vertex, `stride` bytes apart.
struct Attribute {
  const GlBuffer& buffer;
  int components;
  GLenum type;
  int stride;
};

void attach(const GlVertexArray& array, GLuint index, const Attribute& attribute) {
  const GLuint a = array.get();
  const bool normalised = attribute.type == GL_UNSIGNED_SHORT;
  glEnableVertexArrayAttrib(a, index);
  glVertexArrayAttribFormat(a, index, attribute.components, attribute.type, normalised, 0);
  glVertexArrayAttribBinding(a, index, index);
  glVertexArrayVertexBuffer(a, index, attribute.buffer.get(), 0, attribute.stride);
}

// Stores reflectances as 16-bit fractions: half the bytes of floats, and finer than any display.
// The fourth is 0 where a material is unlit.
GlBuffer colour_buffer(const ViewScene& scene) {
  std::vector<std::uint16_t> packed;
  packed.reserve(scene.colours.size() * 4);
  for (std::size_t i = 0; i < scene.colours.size(); ++i) {
    const Vec3f& c = scene.colours[i];
    const bool unlit = !scene.unlit_vertices.empty() && scene.unlit_vertices[i] != 0;
    for (float v : {c.x, c.y, c.z, unlit ? 0.0f : 1.0f})
      packed.push_back(std::uint16_t(std::lround(std::clamp(v, 0.0f, 1.0f) * 65535)));
  }
  return buffer_of(packed);
}

// Returns the least alpha that is shown of a texture, as a byte; 0 if all of it is.
int least_alpha(const ViewScene& scene, std::size_t texture) {
  float least = 2;  // more than any alpha
  bool used = false;
  for (const ViewScene::Cluster& c : scene.clusters) {
    if (c.look.texture != std::int32_t(texture)) continue;
    least = std::min(least, c.look.cutoff);
    used = true;
  }
  return used ? int(std::ceil(std::max(least, 0.0f) * 255)) : 0;
}

Status check_size(const std::string& what, int width, int height) {
  GLint largest = 0;
  glGetIntegerv(GL_MAX_TEXTURE_SIZE, &largest);
  if (width >= 1 && height >= 1 && width <= largest && height <= largest) return {};
  return {ErrorCode::unsupported,
          fmt::format("{} has {} x {} texels; the driver takes 1 to {} a side (resize the image)",
                      what, width, height, largest)};
}

Result<GlTexture> texture_of(const Texture& texture, int least) {
  const Image8& image = texture.image;
  if (Status s = check_size(texture.path.string() + ": the texture", image.width, image.height);
      !s.ok())
    return s;
  const int n = image.channels;
  // Grey is expanded to three channels, since sRGB formats exist for three and four only. The last
  // one of an even number is alpha.
  std::vector<std::uint8_t> rgba(std::size_t(image.width) * image.height * 4);
  for (std::size_t i = 0; i < rgba.size() / 4; ++i)
    for (int c = 0; c < 4; ++c)
      rgba[i * 4 + c] = c == 3 && n % 2 == 1 ? 255
                                             : image.texels[i * n + (c == 3   ? n - 1
                                                                     : n >= 3 ? c
                                                                              : 0)];
  if (least > 0) spread_mask_colours(rgba, image.width, image.height, least);
  const int levels = std::bit_width(unsigned(std::max(image.width, image.height)));
  GlTexture t = make_texture(GL_SRGB8_ALPHA8, image.width, image.height, levels);
  glTextureSubImage2D(t.get(), 0, 0, 0, image.width, image.height, GL_RGBA, GL_UNSIGNED_BYTE,
                      rgba.data());
  glGenerateTextureMipmap(t.get());
  return t;
}

GLint wrap_of(TextureWrap wrap) {
  if (wrap == TextureWrap::clamp) return GL_CLAMP_TO_EDGE;
  return wrap == TextureWrap::mirror ? GL_MIRRORED_REPEAT : GL_REPEAT;
}

// The smallest mip level of an atlas page or a lightmap that is shown. Smaller levels mix charts
// that lie side by side, and give dark floors at a grazing angle bright specks along their borders.
// Measured on pictures of the sample cabin, 100 to 400 pixels wide: with this limit they differ 13
// to 21 % less from pictures with finer sampling than without a limit.
constexpr GLint kPageLevels = 3;

GlSampler make_sampler(TextureWrap u, TextureWrap v) {
  GlSampler s = create<GlSampler>(glCreateSamplers);
  glSamplerParameteri(s.get(), GL_TEXTURE_MIN_FILTER, GL_LINEAR_MIPMAP_LINEAR);
  glSamplerParameteri(s.get(), GL_TEXTURE_WRAP_S, wrap_of(u));
  glSamplerParameteri(s.get(), GL_TEXTURE_WRAP_T, wrap_of(v));
  return s;
}

void make_samplers(GpuScene& gpu) {
  for (int u = 0; u < 3; ++u)
    for (int v = 0; v < 3; ++v)
      gpu.samplers[std::size_t(u)][std::size_t(v)] = make_sampler(TextureWrap(u), TextureWrap(v));
}

void make_page_sampler(GpuScene& gpu) {
  gpu.page_sampler = make_sampler(TextureWrap::clamp, TextureWrap::clamp);
  glSamplerParameteri(gpu.page_sampler.get(), GL_TEXTURE_MAX_LOD, kPageLevels);
}

GlTexture one_texel(std::uint8_t value) {
  const std::uint8_t texel[4] = {value, value, value, 255};
  GlTexture t = make_texture(GL_RGBA8, 1, 1);
  glTextureSubImage2D(t.get(), 0, 0, 0, 1, 1, GL_RGBA, GL_UNSIGNED_BYTE, texel);
  return t;
}

Status upload_textures(const ViewScene& scene, GpuScene& gpu) {
  for (std::size_t i = 0; i < scene.textures.size(); ++i) {
    Result<GlTexture> made = texture_of(scene.textures[i], least_alpha(scene, i));
    if (!made.ok()) return made.status();
    gpu.textures.push_back(std::move(made.value()));
  }
  make_samplers(gpu);
  gpu.blank = one_texel(255);
  return {};
}

// The light is stored as half floats, whose largest value is 65504: once scaled, most of it is
// below 1. It has no more mip levels than are shown.
GlTexture light_texture(const ImageF& page, double scale) {
  const int levels =
      std::min(int(std::bit_width(unsigned(std::max(page.width, page.height)))), kPageLevels + 1);
  GlTexture t = make_texture(GL_RGB16F, page.width, page.height, levels);
  constexpr int kRows = 64;  // so that little is held twice
  std::vector<float> scaled;
  for (int y = 0; y < page.height; y += kRows) {
    const int rows = std::min(kRows, page.height - y);
    const float* from = page.at(0, y);
    scaled.assign(from, from + std::size_t(rows) * std::size_t(page.width) * 3);
    for (float& v : scaled) v = float(std::clamp(double(v) * scale, -65504.0, 65504.0));
    glTextureSubImage2D(t.get(), 0, 0, y, page.width, rows, GL_RGB, GL_FLOAT, scaled.data());
  }
  glGenerateTextureMipmap(t.get());
  return t;
}

Status upload_lightmap(const ViewScene& scene, GpuScene& gpu) {
  gpu.light_pages.resize(scene.lightmap->pages.size());
  for (const ViewScene::Cluster& c : scene.clusters) {
    if (c.look.light_page < 0) continue;
    GlTexture& page = gpu.light_pages[std::size_t(c.look.light_page)];
    if (page) continue;
    const ImageF& image = scene.lightmap->pages[std::size_t(c.look.light_page)];
    if (Status s = check_size(fmt::format("page {} of the lightmap", c.look.light_page),
                              image.width, image.height);
        !s.ok())
      return s;
    page = light_texture(image, scene.light_scale);
  }
  gpu.dark = one_texel(0);
  return {};
}

}  // namespace

void GpuScene::bind_texture(const ViewScene::Look& look) const {
  const GlTexture& texture = look.texture < 0 ? blank : textures[std::size_t(look.texture)];
  const GlSampler& sampler =
      look.page ? page_sampler : samplers[std::size_t(look.wrap_u)][std::size_t(look.wrap_v)];
  glBindTextureUnit(0, texture.get());
  glBindSampler(0, sampler.get());
}

void GpuScene::bind_light(const ViewScene::Look& look) const {
  const GlTexture& page = look.light_page < 0 ? dark : light_pages[std::size_t(look.light_page)];
  glBindTextureUnit(4, page.get());
  glBindSampler(4, page_sampler.get());
}

Result<GpuScene> upload(const ViewScene& scene) {
  GpuScene gpu;
  gpu.bounds = scene.bounds;
  gpu.middle = scene.middle;
  const glm::dvec3 origin = (to_glm(scene.bounds.low) + to_glm(scene.bounds.high)) * 0.5;
  gpu.origin = from_glm(origin);
  gpu.positions = buffer_of(moved(scene.positions, origin));
  gpu.normals = buffer_of(scene.normals);
  gpu.colours = colour_buffer(scene);
  gpu.indices = buffer_of(scene.indices);
  gpu.lit = create<GlVertexArray>(glCreateVertexArrays);
  attach(gpu.lit, 0, {gpu.positions, 3, GL_FLOAT, sizeof(Vec3f)});
  attach(gpu.lit, 1, {gpu.normals, 3, GL_FLOAT, sizeof(Vec3f)});
  attach(gpu.lit, 2, {gpu.colours, 4, GL_UNSIGNED_SHORT, 8});
  if (scene.textured() || scene.lightmap) make_page_sampler(gpu);
  if ((gpu.textured = scene.textured())) {
    gpu.texcoords = buffer_of(scene.texcoords);
    attach(gpu.lit, 3, {gpu.texcoords, 2, GL_FLOAT, sizeof(Vec2f)});
    if (Status s = upload_textures(scene, gpu); !s.ok()) return s;
  }
  if ((gpu.baked_vertices = !scene.illumination.empty())) {
    gpu.illumination = buffer_of(scene.illumination);
    attach(gpu.lit, 4, {gpu.illumination, 3, GL_FLOAT, sizeof(Vec3f)});
  }
  if ((gpu.emits = !scene.emission.empty())) {
    gpu.emission = buffer_of(scene.emission);
    attach(gpu.lit, 5, {gpu.emission, 3, GL_FLOAT, sizeof(Vec3f)});
  }
  if ((gpu.lightmap = scene.lightmap != nullptr)) {
    gpu.light_texcoords = buffer_of(scene.light_texcoords);
    attach(gpu.lit, 6, {gpu.light_texcoords, 2, GL_FLOAT, sizeof(Vec2f)});
    if (Status s = upload_lightmap(scene, gpu); !s.ok()) return s;
  }
  glVertexArrayElementBuffer(gpu.lit.get(), gpu.indices.get());

  gpu.caster_positions = buffer_of(moved(scene.caster_positions, origin));
  gpu.caster_indices = buffer_of(scene.caster_indices);
  gpu.casters = create<GlVertexArray>(glCreateVertexArrays);
  attach(gpu.casters, 0, {gpu.caster_positions, 3, GL_FLOAT, sizeof(Vec3f)});
  glVertexArrayElementBuffer(gpu.casters.get(), gpu.caster_indices.get());

  gpu.clusters = scene.clusters;
  gpu.casters_alone = std::uint32_t(scene.caster_indices.size() / 3);
  for (const ViewScene::Cluster& c : scene.clusters) {
    if (c.look.cutoff <= 0) continue;
    gpu.with_holes.push_back(c);
    gpu.holed_triangles += c.count / 3;
  }
  gpu.unlit = scene.unlit;
  gpu.light_scale = scene.light_scale;
  if (Status s = check_gl("uploading the scene"); !s.ok()) return s;
  return gpu;
}

}  // namespace atlas
