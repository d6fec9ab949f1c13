#include <epoxy/egl.h>
#include <fmt/format.h>

#include <cstring>
#include <memory>

#include "libatlas/view/context.h"

namespace atlas {
namespace {

bool has_extension(const char* list, const char* name) {
  if (!list) return false;
  const std::size_t length = std::strlen(name);
  for (const char* at = std::strstr(list, name); at; at = std::strstr(at + 1, name))
    if ((at == list || at[-1] == ' ') && (at[length] == ' ' || at[length] == 0)) return true;
  return false;
}

class EglContext : public GlContext {
 public:
  EglContext(EGLDisplay display, EGLContext context) : display_(display), context_(context) {}
  ~EglContext() override {
    eglMakeCurrent(display_, EGL_NO_SURFACE, EGL_NO_SURFACE, EGL_NO_CONTEXT);
    eglDestroyContext(display_, context_);
    eglTerminate(display_);
  }
  Status start(bool debug) {
    if (!eglMakeCurrent(display_, EGL_NO_SURFACE, EGL_NO_SURFACE, context_))
      return {
          ErrorCode::unsupported,
          "EGL: a context without a surface cannot be made current (EGL_KHR_surfaceless_context "
          "is missing)"};
    return initialise(debug);
  }

 private:
  EGLDisplay display_;
  EGLContext context_;
};

Result<std::unique_ptr<GlContext>> open_display(EGLDisplay display, const ContextOptions& options) {
  if (display == EGL_NO_DISPLAY || !eglInitialize(display, nullptr, nullptr))
    return Status{ErrorCode::unsupported, "EGL: the display cannot be initialised"};
  // Asks for desktop GL, and for no surface type, since no surface will be made.
  const EGLint config_attributes[] = {EGL_RENDERABLE_TYPE, EGL_OPENGL_BIT, EGL_SURFACE_TYPE, 0,
                                      EGL_NONE};
  EGLint context_attributes[] = {EGL_CONTEXT_MAJOR_VERSION,
                                 4,
                                 EGL_CONTEXT_MINOR_VERSION,
                                 5,
                                 EGL_CONTEXT_OPENGL_PROFILE_MASK,
                                 EGL_CONTEXT_OPENGL_CORE_PROFILE_BIT,
                                 EGL_CONTEXT_OPENGL_DEBUG,
                                 options.debug ? EGL_TRUE : EGL_FALSE,
                                 EGL_CONTEXT_OPENGL_RESET_NOTIFICATION_STRATEGY,
                                 EGL_LOSE_CONTEXT_ON_RESET,
                                 EGL_NONE};
  EGLint& strategy = context_attributes[8];
  EGLConfig config = nullptr;
  EGLint found = 0;
  EGLContext context = EGL_NO_CONTEXT;
  if (eglBindAPI(EGL_OPENGL_API) &&
      eglChooseConfig(display, config_attributes, &config, 1, &found)) {
    const auto create = [&] {
      return eglCreateContext(display, found ? config : nullptr, EGL_NO_CONTEXT,
                              context_attributes);
    };
    context = create();
    if (context == EGL_NO_CONTEXT) {  // drivers that cannot report resets refuse the request
      strategy = EGL_NONE;
      context = create();
    }
  }
  if (context == EGL_NO_CONTEXT) {
    const EGLint error = eglGetError();
    eglTerminate(display);
    return Status{ErrorCode::unsupported,
                  fmt::format("EGL: no OpenGL 4.5 core context (error {:#x})", error)};
  }
  auto made = std::make_unique<EglContext>(display, context);
  if (Status s = made->start(options.debug); !s.ok()) return s;
  return std::unique_ptr<GlContext>(std::move(made));
}

// Returns a context on the first EGL device that is a GPU and opens, or null.
std::unique_ptr<GlContext> open_gpu(const ContextOptions& options) {
  EGLDeviceEXT devices[16];
  EGLint count = 0;
  if (!eglQueryDevicesEXT(16, devices, &count)) return nullptr;
  for (EGLint i = 0; i < count; ++i) {
    const char* extensions = eglQueryDeviceStringEXT(devices[i], EGL_EXTENSIONS);
    if (has_extension(extensions, "EGL_MESA_device_software")) continue;
    Result<std::unique_ptr<GlContext>> made = open_display(
        eglGetPlatformDisplayEXT(EGL_PLATFORM_DEVICE_EXT, devices[i], nullptr), options);
    if (made.ok() && !made.value()->info().software) return std::move(made.value());
  }
  return nullptr;
}

}  // namespace

Result<std::unique_ptr<GlContext>> make_headless_context(const ContextOptions& options) {
  const char* client = eglQueryString(EGL_NO_DISPLAY, EGL_EXTENSIONS);
  if (!has_extension(client, "EGL_EXT_platform_base"))
    return Status{ErrorCode::unsupported,
                  "EGL: no platform extensions (install libegl1 and libegl-mesa0)"};
  const bool devices = has_extension(client, "EGL_EXT_device_enumeration") ||
                       has_extension(client, "EGL_EXT_device_base");
  if (!options.software && devices && has_extension(client, "EGL_EXT_platform_device"))
    if (std::unique_ptr<GlContext> gpu = open_gpu(options)) return gpu;
  if (!has_extension(client, "EGL_MESA_platform_surfaceless"))
    return Status{ErrorCode::unsupported,
                  "no GPU was found and EGL has no surfaceless platform (install libegl-mesa0 and "
                  "libgl1-mesa-dri for the software renderer)"};
  return open_display(
      eglGetPlatformDisplayEXT(EGL_PLATFORM_SURFACELESS_MESA, EGL_DEFAULT_DISPLAY, nullptr),
      options);
}

}  // namespace atlas
