#include "libatlas/view/gl_objects.h"

#include <fmt/format.h>

#include <algorithm>

namespace atlas {
namespace {

std::string log_of_shader(GLuint shader) {
  GLint length = 0;
  glGetShaderiv(shader, GL_INFO_LOG_LENGTH, &length);
  std::string log(std::size_t(std::max(length, 1)), '\0');
  glGetShaderInfoLog(shader, GLsizei(log.size()), nullptr, log.data());
  return log.c_str();
}

// Returns the first line of a driver's log that holds text, since a message to the user is one
// line.
std::string first_line(const std::string& log) {
  const std::size_t start = log.find_first_not_of("\r\n \t");
  if (start == std::string::npos) return "the driver gives no reason";
  return log.substr(start, log.find_first_of("\r\n", start) - start);
}

Status compile(const std::string& name, GLuint shader, const std::string& source) {
  const char* text = source.c_str();
  glShaderSource(shader, 1, &text, nullptr);
  glCompileShader(shader);
  GLint ok = 0;
  glGetShaderiv(shader, GL_COMPILE_STATUS, &ok);
  if (ok) return {};
  return {ErrorCode::bad_input,
          fmt::format("shader {} does not compile: {}", name, first_line(log_of_shader(shader)))};
}

const char* error_name(GLenum error) {
  switch (error) {
    case GL_INVALID_ENUM:
      return "GL_INVALID_ENUM";
    case GL_INVALID_VALUE:
      return "GL_INVALID_VALUE";
    case GL_INVALID_OPERATION:
      return "GL_INVALID_OPERATION";
    case GL_INVALID_FRAMEBUFFER_OPERATION:
      return "GL_INVALID_FRAMEBUFFER_OPERATION";
    case GL_OUT_OF_MEMORY:
      return "GL_OUT_OF_MEMORY";
    default:
      return "an unknown error";
  }
}

}  // namespace

GlBuffer make_buffer(const void* data, std::size_t bytes, GLbitfield flags) {
  GlBuffer buffer = create<GlBuffer>(glCreateBuffers);
  glNamedBufferStorage(buffer.get(), GLsizeiptr(std::max<std::size_t>(bytes, 1)),
                       bytes ? data : nullptr, flags);
  return buffer;
}

GlTexture make_texture(GLenum format, int width, int height, int levels) {
  GlTexture texture = create<GlTexture>(glCreateTextures, GL_TEXTURE_2D);
  glTextureStorage2D(texture.get(), levels, format, width, height);
  return texture;
}

Result<GlProgram> link_program(const std::string& name, const std::string& vertex,
                               const std::string& fragment) {
  GlProgram program(glCreateProgram());
  const GLuint shaders[] = {glCreateShader(GL_VERTEX_SHADER), glCreateShader(GL_FRAGMENT_SHADER)};
  Status status = compile(name + " (vertex)", shaders[0], vertex);
  if (status.ok()) status = compile(name + " (fragment)", shaders[1], fragment);
  if (status.ok()) {
    for (GLuint shader : shaders) glAttachShader(program.get(), shader);
    glLinkProgram(program.get());
    GLint ok = 0;
    glGetProgramiv(program.get(), GL_LINK_STATUS, &ok);
    if (!ok) {
      char log[2048] = "";
      glGetProgramInfoLog(program.get(), sizeof log, nullptr, log);
      status = {ErrorCode::bad_input,
                fmt::format("shader {} does not link: {}", name, first_line(log))};
    }
    for (GLuint shader : shaders) glDetachShader(program.get(), shader);
  }
  for (GLuint shader : shaders) glDeleteShader(shader);
  if (!status.ok()) return status;
  return program;
}

Status check_gl(const char* where) {
  const GLenum first = glGetError();
  if (first == GL_NO_ERROR) return {};
  // A lost context reports its error for ever, so the loop is limited.
  for (int i = 0; i < 64 && glGetError() != GL_NO_ERROR; ++i) {
  }
  if (first == GL_CONTEXT_LOST)
    return {ErrorCode::unsupported,
            fmt::format("the graphics context was lost in {} (start the program again)", where)};
  return {first == GL_OUT_OF_MEMORY ? ErrorCode::unsupported : ErrorCode::bad_input,
          fmt::format("OpenGL: {} in {}", error_name(first), where)};
}

}  // namespace atlas
