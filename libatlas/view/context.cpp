#include "libatlas/view/context.h"

#include <epoxy/gl.h>
#include <fmt/format.h>

namespace atlas {
namespace {

std::string text_of(GLenum name) {
  const GLubyte* text = glGetString(name);
  return text ? reinterpret_cast<const char*>(text) : "";
}

void GLAPIENTRY on_debug(GLenum, GLenum type, GLuint, GLenum, GLsizei, const GLchar* message,
                         const void* user) {
  if (type == GL_DEBUG_TYPE_ERROR || type == GL_DEBUG_TYPE_UNDEFINED_BEHAVIOR)
    static_cast<GlContext*>(const_cast<void*>(user))->note_debug_error(message);
}

}  // namespace

void GlContext::note_debug_error(const char* message) {
  if (debug_errors_++ == 0) first_debug_error_ = message;
}

Status GlContext::check_alive() const {
  const auto lost = [](const char* why) {
    return Status{ErrorCode::unsupported,
                  fmt::format("the graphics context is lost: {} (start the program again)", why)};
  };
  switch (reset_source_ ? reset_source_() : glGetGraphicsResetStatus()) {
    case GL_NO_ERROR:
      return {};
    case GL_GUILTY_CONTEXT_RESET:
      return lost(
          "the driver was reset by what this program drew; a smaller scene, map or image "
          "may help");
    case GL_INNOCENT_CONTEXT_RESET:
      return lost("the driver was reset by another program");
    default:
      return lost("the driver was reset for a reason that it does not tell");
  }
}

bool draws_in_software() {
  const std::string renderer = text_of(GL_RENDERER);
  for (const char* name : {"llvmpipe", "softpipe", "swrast", "Software"})
    if (renderer.find(name) != std::string::npos) return true;
  return false;
}

Status GlContext::initialise(bool debug) {
  info_.renderer = text_of(GL_RENDERER);
  info_.version = text_of(GL_VERSION);
  if (epoxy_gl_version() < 45)
    return {ErrorCode::unsupported,
            fmt::format("OpenGL 4.5 is needed, {} offers {} (update the driver, or set "
                        "LIBGL_ALWAYS_SOFTWARE=1 to use Mesa's software renderer)",
                        info_.renderer, info_.version)};
  info_.software = draws_in_software();
  if (debug) {
    glEnable(GL_DEBUG_OUTPUT);
    glEnable(GL_DEBUG_OUTPUT_SYNCHRONOUS);
    glDebugMessageCallback(on_debug, this);
  }
  return {};
}

}  // namespace atlas
