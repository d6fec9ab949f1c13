// Internal: OpenGL names that delete themselves. Include it from .cpp files of view/ only; every
// function needs a current context of version 4.5 (direct state access).
#pragma once

#include <epoxy/gl.h>

#include <cstddef>
#include <string>
#include <utility>

#include "libatlas/core/status.h"

namespace atlas {

// A GL name and the function that deletes it. Move-only; 0 is "none".
template <void (*Delete)(GLuint)>
class GlName {
 public:
  GlName() = default;
  explicit GlName(GLuint name) : name_(name) {}
  ~GlName() { reset(); }
  GlName(GlName&& other) noexcept : name_(std::exchange(other.name_, 0)) {}
  GlName& operator=(GlName&& other) noexcept {
    if (this != &other) {
      reset();
      name_ = std::exchange(other.name_, 0);
    }
    return *this;
  }
  GLuint get() const { return name_; }
  explicit operator bool() const { return name_ != 0; }

 private:
  void reset() {
    if (name_) Delete(name_);
    name_ = 0;
  }
  GLuint name_ = 0;
};

inline void delete_buffer(GLuint n) {
  glDeleteBuffers(1, &n);
}
inline void delete_texture(GLuint n) {
  glDeleteTextures(1, &n);
}
inline void delete_sampler(GLuint n) {
  glDeleteSamplers(1, &n);
}
inline void delete_vertex_array(GLuint n) {
  glDeleteVertexArrays(1, &n);
}
inline void delete_framebuffer(GLuint n) {
  glDeleteFramebuffers(1, &n);
}
inline void delete_renderbuffer(GLuint n) {
  glDeleteRenderbuffers(1, &n);
}
inline void delete_query(GLuint n) {
  glDeleteQueries(1, &n);
}
inline void delete_program(GLuint n) {
  glDeleteProgram(n);
}

using GlBuffer = GlName<delete_buffer>;
using GlTexture = GlName<delete_texture>;
using GlSampler = GlName<delete_sampler>;
using GlVertexArray = GlName<delete_vertex_array>;
using GlFramebuffer = GlName<delete_framebuffer>;
using GlRenderbuffer = GlName<delete_renderbuffer>;
using GlQuery = GlName<delete_query>;
using GlProgram = GlName<delete_program>;

// An immutable buffer of `bytes` bytes (at least one, since GL refuses none).
GlBuffer make_buffer(const void* data, std::size_t bytes, GLbitfield flags = 0);
GlTexture make_texture(GLenum format, int width, int height, int levels = 1);
GlVertexArray make_vertex_array();
GlFramebuffer make_framebuffer();

// Compiles and links; bad_input with `name` and the driver's log on failure.
Result<GlProgram> link_program(const std::string& name, const std::string& vertex,
                               const std::string& fragment);

// The first pending GL error as a Status naming `where`, and clears all of them.
Status check_gl(const char* where);

}  // namespace atlas
