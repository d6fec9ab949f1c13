#include "libatlas/view/shadow_pass.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace atlas {
namespace {

constexpr const char* kVertex = R"(#version 450 core
layout(location = 0) in vec3 position;
layout(location = 0) uniform mat4 to_clip;
void main() { gl_Position = to_clip * vec4(position, 1.0); }
)";
constexpr const char* kFragment = "#version 450 core\nvoid main() {}\n";
constexpr const char* kHoledVertex = R"(#version 450 core
layout(location = 0) in vec3 position;
layout(location = 3) in vec2 texcoord;
layout(location = 3) out vec2 v_texcoord;
layout(location = 0) uniform mat4 to_clip;
void main() {
  gl_Position = to_clip * vec4(position, 1.0);
  v_texcoord = texcoord;
}
)";
constexpr const char* kHoledFragment = R"(#version 450 core
layout(location = 3) in vec2 v_texcoord;
layout(location = 4) uniform float cutoff;
layout(binding = 0) uniform sampler2D diffuse;
void main() {
  if (textureLod(diffuse, v_texcoord, 0.0).a < cutoff) discard;
}
)";

GlSampler make_sampler(bool compare) {
  GlSampler sampler = create<GlSampler>(glCreateSamplers);
  const GLuint name = sampler.get();
  const GLint filter = compare ? GL_LINEAR : GL_NEAREST;
  glSamplerParameteri(name, GL_TEXTURE_MIN_FILTER, filter);
  glSamplerParameteri(name, GL_TEXTURE_MAG_FILTER, filter);
  glSamplerParameteri(name, GL_TEXTURE_WRAP_S, GL_CLAMP_TO_BORDER);
  glSamplerParameteri(name, GL_TEXTURE_WRAP_T, GL_CLAMP_TO_BORDER);
  const float lit[4] = {1, 1, 1, 1};
  glSamplerParameterfv(name, GL_TEXTURE_BORDER_COLOR, lit);
  if (compare) {
    glSamplerParameteri(name, GL_TEXTURE_COMPARE_MODE, GL_COMPARE_REF_TO_TEXTURE);
    glSamplerParameteri(name, GL_TEXTURE_COMPARE_FUNC, GL_LEQUAL);
  }
  return sampler;
}

// Consecutive triangles of all casters: those of GpuScene::casters, then those with holes.
struct Part {
  std::uint32_t begin, end;
};

void draw_triangles(std::uint32_t first, std::uint32_t count) {
  glDrawElements(GL_TRIANGLES, GLsizei(count * 3), GL_UNSIGNED_INT,
                 reinterpret_cast<const void*>(std::uintptr_t(first) * 12));
}

// Draws the triangles of a part that have holes.
void draw_with_holes(const GpuScene& scene, const Part& part) {
  std::uint32_t at = scene.casters_alone;  // where the next cluster begins
  for (const ViewScene::Cluster& c : scene.with_holes) {
    const std::uint32_t begin = std::max(part.begin, at),
                        end = std::min(part.end, at + c.count / 3);
    if (begin < end) {
      scene.bind_texture(c.look);
      glUniform1f(4, c.look.cutoff);
      draw_triangles(c.first / 3 + begin - at, end - begin);
    }
    at += c.count / 3;
  }
}

}  // namespace

Result<ShadowPass> ShadowPass::make(int resolution, int maps, int bits, bool holes) {
  GLint largest = 0;
  glGetIntegerv(GL_MAX_TEXTURE_SIZE, &largest);
  if (resolution < 16 || resolution > largest)
    return Status{
        ErrorCode::bad_option,
        fmt::format("shadow map of {} texels a side: 16 to {} are possible with this driver",
                    resolution, largest)};
  Result<GlProgram> program = link_program("shadow map", kVertex, kFragment);
  if (!program.ok()) return program.status();
  ShadowPass pass;
  pass.program_ = std::move(program.value());
  if (holes) {
    Result<GlProgram> holed = link_program("of maps with holes", kHoledVertex, kHoledFragment);
    if (!holed.ok()) return holed.status();
    pass.holed_ = std::move(holed.value());
  }
  pass.compare_ = make_sampler(true);
  pass.plain_ = make_sampler(false);
  pass.resolution_ = resolution;
  pass.bits_ = bits;
  const GLenum format = bits == 16   ? GL_DEPTH_COMPONENT16
                        : bits == 24 ? GL_DEPTH_COMPONENT24
                                     : GL_DEPTH_COMPONENT32F;
  pass.layers_ = create<GlTexture>(glCreateTextures, GL_TEXTURE_2D_ARRAY);
  const GLuint layers = pass.layers_.get();
  glTextureStorage3D(layers, 1, format, resolution, resolution, maps);
  if (Status s = check_gl("making shadow maps"); !s.ok())
    return Status{s.code(), fmt::format("{} shadow maps of {} x {} texels: {} (make them smaller)",
                                        maps, resolution, resolution, s.message())};
  for (int i = 0; i < maps; ++i) {
    Map map;
    map.frame = create<GlFramebuffer>(glCreateFramebuffers);
    const GLuint f = map.frame.get();
    glNamedFramebufferTextureLayer(f, GL_DEPTH_ATTACHMENT, layers, 0, i);
    glNamedFramebufferDrawBuffer(f, GL_NONE);
    glNamedFramebufferReadBuffer(f, GL_NONE);
    if (glCheckNamedFramebufferStatus(f, GL_FRAMEBUFFER) != GL_FRAMEBUFFER_COMPLETE)
      return Status{ErrorCode::unsupported,
                    fmt::format("the driver does not draw into {}-bit depth textures", bits)};
    pass.maps_.push_back(std::move(map));
  }
  if (Status s = check_gl("making shadow maps"); !s.ok()) return s;
  return pass;
}

std::uint32_t ShadowPass::draw(const GpuScene& scene, const MapWork& work, const LightFit& fit) {
  Map& map = maps_[std::size_t(work.slot)];
  glBindFramebuffer(GL_FRAMEBUFFER, map.frame.get());
  glViewport(0, 0, resolution_, resolution_);
  if (work.begin <= 0) {
    const float far = 1;
    map.fit = fit;
    glDepthMask(GL_TRUE);
    glClearNamedFramebufferfv(map.frame.get(), GL_DEPTH, 0, &far);
  }
  const std::uint32_t triangles = scene.casters_alone + scene.holed_triangles;
  const auto at = [&](double fraction) {
    return std::uint32_t(std::lround(std::min(fraction, 1.0) * triangles));
  };
  const Part part{at(work.begin), at(work.end)};
  if (part.begin == part.end) return 0;
  const Matrix4 to_clip = relative_to(map.fit.to_clip, scene.origin);
  float matrix[16];
  for (int i = 0; i < 16; ++i) matrix[i] = float(to_clip[i]);
  glEnable(GL_DEPTH_TEST);
  glDepthFunc(GL_LESS);
  glEnable(GL_DEPTH_CLAMP);  // casters in front of the range still cast shadows
  if (part.begin < scene.casters_alone) {
    glUseProgram(program_.get());
    glUniformMatrix4fv(0, 1, GL_FALSE, matrix);
    glBindVertexArray(scene.casters.get());
    draw_triangles(part.begin, std::min(part.end, scene.casters_alone) - part.begin);
  }
  if (part.end > scene.casters_alone) {
    glUseProgram(holed_.get());
    glUniformMatrix4fv(0, 1, GL_FALSE, matrix);
    glBindVertexArray(scene.lit.get());
    draw_with_holes(scene, part);
  }
  glDisable(GL_DEPTH_CLAMP);
  return part.end - part.begin;
}

void ShadowPass::bind_compare(int unit) const {
  glBindTextureUnit(GLuint(unit), layers_.get());
  glBindSampler(GLuint(unit), compare_.get());
}

void ShadowPass::bind_depths(int unit) const {
  glBindTextureUnit(GLuint(unit), layers_.get());
  glBindSampler(GLuint(unit), plain_.get());
}

}  // namespace atlas
