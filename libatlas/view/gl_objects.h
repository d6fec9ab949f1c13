// Internal: OpenGL names that delete themselves. Include it from .cpp files of view/ only; every
// function needs a current context of version 4.5 (direct state access).
#pragma once

#include <epoxy/gl.h>

#include <cstddef>
#include <string>
#include <type_traits>
#include <utility>

#include "libatlas/core/status.h"

namespace atlas {

// Owns a GL name and deletes it with `Delete`, the address of one of epoxy's function pointers,
// such as &glDeleteBuffers. Move-only; 0 means none.
template <auto* Delete>
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
    if (name_ == 0) return;
    if constexpr (std::is_invocable_v<decltype(*Delete), GLuint>)
      (*Delete)(name_);
    else
      (*Delete)(1, &name_);
    name_ = 0;
  }
  GLuint name_ = 0;
};

using GlBuffer = GlName<&glDeleteBuffers>;
using GlTexture = GlName<&glDeleteTextures>;
using GlSampler = GlName<&glDeleteSamplers>;
using GlVertexArray = GlName<&glDeleteVertexArrays>;
using GlFramebuffer = GlName<&glDeleteFramebuffers>;
using GlRenderbuffer = GlName<&glDeleteRenderbuffers>;
using GlQuery = GlName<&glDeleteQueries>;
using GlProgram = GlName<&glDeleteProgram>;

// Returns a name made by one of the glCreate* functions, including those that take a target first:
// create<GlTexture>(glCreateTextures, GL_TEXTURE_2D).
template <class Name, class Create, class... Target>
Name create(Create function, Target... target) {
  GLuint name = 0;
  function(GLenum(target)..., 1, &name);
  return Name(name);
}

// Makes an immutable buffer of `bytes` bytes (at least one, since GL refuses empty buffers).
GlBuffer make_buffer(const void* data, std::size_t bytes, GLbitfield flags = 0);
GlTexture make_texture(GLenum format, int width, int height, int levels = 1);

// Compiles and links a program. Error: bad_input with `name` and the driver's log.
Result<GlProgram> link_program(const std::string& name, const std::string& vertex,
                               const std::string& fragment);

// Returns the first pending GL error as a Status that names `where`, and clears all of them.
Status check_gl(const char* where);

}  // namespace atlas
