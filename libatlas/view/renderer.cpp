#include "libatlas/view/renderer.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "libatlas/core/degrees.h"
#include "libatlas/core/is_enumerator.h"
#include "libatlas/view/context.h"
#include "libatlas/view/renderer_impl.h"

namespace atlas {

const char* name_of(ShadowMethod method) {
  constexpr const char* kNames[] = {"none",  "classic",          "hold", "linear",
                                    "slerp", "slerp-normalised", "march"};
  return kNames[int(method)];
}

int maps_of(ShadowMethod method) {
  if (method == ShadowMethod::none) return 0;
  return method == ShadowMethod::classic || method == ShadowMethod::hold ? 1 : KeySchedule::kSlots;
}

ShaderFeatures needed_features(const GpuScene& scene, const RenderOptions& options) {
  ShaderFeatures f;
  f.shading = options.shading;
  f.visibility = options.show_visibility;
  f.pcf = options.pcf;
  f.textured = scene.textured && !f.visibility;
  f.some_unlit = scene.unlit == Unlit::some && !f.visibility;
  f.all_unlit = scene.unlit == Unlit::all && !f.visibility;
  f.baked_vertices = scene.baked_vertices && !f.visibility;
  f.lightmap = scene.lightmap && !f.visibility;
  f.emission = scene.emits && !f.visibility;
  if (options.shading != Shading::unlit) switch (options.shadows) {
      case ShadowMethod::none:
        break;
      case ShadowMethod::classic:
      case ShadowMethod::hold:
        f.shadow = ShadowSampling::one;
        break;
      case ShadowMethod::march:
        f.shadow = ShadowSampling::march;
        break;
      default:
        f.shadow = ShadowSampling::two;
    }
  return f;
}

ScheduleOptions schedule_for(const RenderOptions& options) {
  ScheduleOptions s = options.schedule;
  s.blend = maps_of(options.shadows) > 1;
  if (options.shadows == ShadowMethod::classic) {
    s.interval_frames = 1;
    s.interval_degrees = 0;
  }
  return s;
}

int march_samples(int least, double key_degrees) {
  return std::clamp(int(std::lround(key_degrees)), least, std::max(least, kMostMarchSamples));
}

namespace {

// Makes a texture that is drawn into and then fetched from. Integers are never filtered.
GlTexture target_texture(GLenum format, int width, int height) {
  GlTexture t = make_texture(format, width, height);
  glTextureParameteri(t.get(), GL_TEXTURE_MIN_FILTER, GL_NEAREST);
  glTextureParameteri(t.get(), GL_TEXTURE_MAG_FILTER, GL_NEAREST);
  return t;
}

// Checks the strengths, which are numbers up to the largest float since shaders read them as such.
Status check_strengths(const RenderOptions& o) {
  struct Field {
    const char* name;
    double value;
    bool may_be_zero;
  };
  for (const Field& f : {Field{"ambient", o.ambient, true},
                         {"intensity", o.intensity, true},
                         {"baked_strength", o.baked_strength, true},
                         {"exposure", o.exposure, false},
                         {"specular", o.specular, true},
                         {"shininess", o.shininess, false},
                         {"roughness", o.roughness, false},
                         {"slope_bias", o.slope_bias, true},
                         {"normal_offset", o.normal_offset, true},
                         {"view_distance", o.view_distance, true}})
    if (!(f.value >= 0) || f.value > std::numeric_limits<float>::max() ||
        (f.value == 0 && !f.may_be_zero))
      return {ErrorCode::bad_option, fmt::format("{} is {}: it is a number {}", f.name, f.value,
                                                 f.may_be_zero ? "from 0 on" : "above 0")};
  const double up = std::hypot(o.up.x, o.up.y, o.up.z);
  if (!(up > 0) || !std::isfinite(up))
    return {ErrorCode::bad_option, "up is a direction of finite length above 0"};
  return {};
}

Status check_options(const RenderOptions& o) {
  if (o.width < 1 || o.height < 1 || o.width > 16384 || o.height > 16384)
    return {ErrorCode::bad_option,
            fmt::format("image size {} x {}: 1 to 16384 are possible", o.width, o.height)};
  if (o.pcf != 0 && o.pcf != 1 && o.pcf != 3 && o.pcf != 5)
    return {ErrorCode::bad_option, fmt::format("pcf {}: it is 0, 1, 3 or 5", o.pcf)};
  if (o.march_steps < 1 || o.march_steps > 64)
    return {ErrorCode::bad_option,
            fmt::format("{} march steps: 1 to 64 are possible", o.march_steps)};
  if (o.map_bits != 16 && o.map_bits != 24 && o.map_bits != 32)
    return {ErrorCode::bad_option,
            fmt::format("depths of {} bits: 16, 24 or 32 are possible", o.map_bits)};
  if (o.schedule.interval_frames < 1)
    return {ErrorCode::bad_option, "keys are at least one frame apart"};
  if (!is_enumerator(o.shading, Shading::ward) || !is_enumerator(o.shadows, ShadowMethod::march))
    return {ErrorCode::bad_option,
            fmt::format("shading {}, shadows {}: a Shading and a ShadowMethod are possible",
                        int(o.shading), int(o.shadows))};
  return check_strengths(o);
}

bool same_schedule(const RenderOptions& a, const RenderOptions& b) {
  const ScheduleOptions x = schedule_for(a), y = schedule_for(b);
  return x.interval_frames == y.interval_frames && x.interval_degrees == y.interval_degrees &&
         x.blend == y.blend && x.sliced == y.sliced && x.max_frames == y.max_frames &&
         x.max_key_degrees == y.max_key_degrees && x.jump_degrees == y.jump_degrees &&
         a.fit_view == b.fit_view && a.snap == b.snap && a.view_distance == b.view_distance &&
         a.up == b.up;
}

}  // namespace

Status Renderer::Impl::allocate_target(int width, int height, bool lit) {
  if (width == target_width && height == target_height && lit == bool(surfaces)) return {};
  colour = create<GlRenderbuffer>(glCreateRenderbuffers);
  glNamedRenderbufferStorage(colour.get(), GL_RGBA8, width, height);
  depth = target_texture(GL_DEPTH_COMPONENT32F, width, height);
  target = create<GlFramebuffer>(glCreateFramebuffers);
  glNamedFramebufferRenderbuffer(target.get(), GL_COLOR_ATTACHMENT0, GL_RENDERBUFFER, colour.get());
  surfaces = GlTexture();
  surface_target = GlFramebuffer();
  depth_copy = GlRenderbuffer();
  if (lit) {
    surfaces = target_texture(GL_RGBA32UI, width, height);
    surface_target = create<GlFramebuffer>(glCreateFramebuffers);
    glNamedFramebufferTexture(surface_target.get(), GL_COLOR_ATTACHMENT0, surfaces.get(), 0);
    no_vertices = create<GlVertexArray>(glCreateVertexArrays);
  }
  if (lit && software) {
    depth_copy = create<GlRenderbuffer>(glCreateRenderbuffers);
    glNamedRenderbufferStorage(depth_copy.get(), GL_DEPTH_COMPONENT32F, width, height);
    glNamedFramebufferRenderbuffer(target.get(), GL_DEPTH_ATTACHMENT, GL_RENDERBUFFER,
                                   depth_copy.get());
  }
  // The second pass reads the depth, so it is never attached then: what is read of an attached
  // texture is undefined unless drivers order it (OpenGL 4.5, 9.3.1: feedback loops).
  const GLuint first = lit ? surface_target.get() : target.get();
  glNamedFramebufferTexture(first, GL_DEPTH_ATTACHMENT, depth.get(), 0);
  target_width = width;
  target_height = height;
  const Status made = check_gl("making the image");  // no error stays pending, whatever is returned
  for (const GlFramebuffer* f : {&target, &surface_target})
    if (*f && glCheckNamedFramebufferStatus(f->get(), GL_FRAMEBUFFER) != GL_FRAMEBUFFER_COMPLETE)
      return {ErrorCode::unsupported,
              fmt::format("the driver does not draw into an image of {} x {} (make it smaller)",
                          width, height)};
  return made;
}

Status Renderer::Impl::compile(const ShaderFeatures& wanted) {
  if (program && wanted == features) return {};
  const ShaderText text = shader_text(wanted);
  Result<GlProgram> made = link_program("of the scene", text.vertex, text.fragment);
  if (!made.ok()) return made.status();
  GlProgram second, with_holes;
  if (!scene->with_holes.empty()) {
    ShaderFeatures f = wanted;
    f.holes = true;
    const ShaderText holes = shader_text(f);
    Result<GlProgram> other = link_program("of the scene's holes", holes.vertex, holes.fragment);
    if (!other.ok()) return other.status();
    with_holes = std::move(other.value());
  }
  if (!text.lighting_fragment.empty()) {
    Result<GlProgram> light =
        link_program("of the light", text.lighting_vertex, text.lighting_fragment);
    if (!light.ok()) return light.status();
    second = std::move(light.value());
  }
  program = std::move(made.value());
  holed = std::move(with_holes);
  lighting = std::move(second);
  features = wanted;
  return {};
}

Status Renderer::Impl::apply(const RenderOptions& wanted) {
  if (Status s = check_options(wanted); !s.ok()) return s;
  const ShaderFeatures f = needed_features(*scene, wanted);
  if (Status s = compile(f); !s.ok()) return s;
  if (Status s = allocate_target(wanted.width, wanted.height, bool(lighting)); !s.ok()) return s;
  const int maps = f.shadow == ShadowSampling::none ? 0 : maps_of(wanted.shadows);
  const bool fresh_maps =
      maps != shadow_maps || (maps && (shadow->resolution() != wanted.map_resolution ||
                                       shadow->bits() != wanted.map_bits));
  if (fresh_maps) {
    shadow.reset();
    shadow_maps = 0;
    if (maps) {
      Result<ShadowPass> made = ShadowPass::make(wanted.map_resolution, maps, wanted.map_bits,
                                                 !scene->with_holes.empty());
      if (!made.ok()) return made.status();
      shadow = std::move(made.value());
      shadow_maps = maps;
    }
  }
  if (fresh_maps || !schedule || !same_schedule(options, wanted)) {
    if (schedule) earlier_passes += schedule->passes();
    schedule.emplace(schedule_for(wanted));
    view_fit_valid = false;
    sampled[0] = sampled[1] = 0;
  }
  options = wanted;
  return {};
}

Status Renderer::Impl::draw_shadow_maps(const Camera& camera, const FramePlan& plan,
                                        FrameStats& stats) {
  shadow_timer->begin();
  for (const MapWork& work : plan.work) {
    Result<LightFit> made = fit(camera, work.direction);
    if (!made.ok()) {
      shadow_timer->end();
      return made.status();
    }
    if (work.begin <= 0) {
      view_fit = *made;
      view_fit_valid = true;
    }
    stats.triangles_shadow += shadow->draw(*scene, work, *made);
  }
  shadow_timer->end();
  return {};
}

Result<FrameStats> Renderer::Impl::draw(const Camera& camera, const FrameLight& light) {
  FrameStats stats;
  FramePlan plan;
  if (shadow) {
    if (view_left_the_keys(camera)) schedule->invalidate();
    plan = schedule->next(light.direction, light.ahead);
    stats.refreshed = plan.refreshed;
    stats.t = plan.t;
    stats.key_degrees = degrees(angle_between(plan.from_direction, plan.to_direction));
    if (Status s = draw_shadow_maps(camera, plan, stats); !s.ok()) {
      schedule->invalidate();  // the schedule assumes that the maps were drawn
      return s;
    }
    sampled[0] = plan.from;
    sampled[1] = plan.to;
  }
  lit_timer->begin();
  draw_lit(camera, light, plan, stats);
  lit_timer->end();
  if (Status s = check_gl("drawing a frame"); !s.ok()) return s;
  return stats;
}

Renderer::Renderer(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
Renderer::Renderer(Renderer&&) noexcept = default;
Renderer& Renderer::operator=(Renderer&&) noexcept = default;
Renderer::~Renderer() = default;

Result<Renderer> Renderer::make(const ViewScene& scene, const RenderOptions& options) {
  Result<GpuScene> gpu = upload(scene);
  if (!gpu.ok()) return gpu.status();
  auto impl = std::make_unique<Impl>();
  impl->scene = std::make_shared<const GpuScene>(std::move(gpu.value()));
  Renderer first(std::move(impl));
  return first.share(options);
}

Result<Renderer> Renderer::share(const RenderOptions& options) const {
  auto impl = std::make_unique<Impl>();
  impl->scene = impl_->scene;
  GLint bits = 0;
  glGetIntegerv(GL_SUBPIXEL_BITS, &bits);
  impl->subpixel = std::exp2(-bits);
  impl->software = draws_in_software();
  impl->shadow_timer.emplace();
  impl->lit_timer.emplace();
  if (Status s = impl->apply(options); !s.ok()) return s;
  return Renderer(std::move(impl));
}

Status Renderer::set_options(const RenderOptions& options) {
  const Status s = impl_->apply(options);
  // Makes again what was replaced before the failure.
  if (!s.ok())
    if (Status back = impl_->apply(impl_->options); !back.ok()) return back;
  return s;
}
const RenderOptions& Renderer::options() const {
  return impl_->options;
}

Result<FrameStats> Renderer::draw(const Camera& camera, const FrameLight& light) {
  return impl_->draw(camera, light);
}

void Renderer::finish() {
  glFinish();
  impl_->shadow_timer->poll();
  impl_->lit_timer->poll();
}

double Renderer::shadow_seconds() const {
  return impl_->shadow ? impl_->shadow_timer->seconds() : 0.0;
}
double Renderer::lit_seconds() const {
  return impl_->lit_timer->seconds();
}

Image8 Renderer::read_image() const {
  Image8 image(impl_->target_width, impl_->target_height, 3);
  glBindFramebuffer(GL_READ_FRAMEBUFFER, impl_->target.get());
  glPixelStorei(GL_PACK_ALIGNMENT, 1);
  glReadPixels(0, 0, image.width, image.height, GL_RGB, GL_UNSIGNED_BYTE, image.texels.data());
  return image;
}

void Renderer::show(int window_width, int window_height) const {
  glBlitNamedFramebuffer(impl_->target.get(), 0, 0, 0, impl_->target_width, impl_->target_height, 0,
                         0, window_width, window_height, GL_COLOR_BUFFER_BIT, GL_LINEAR);
  glBindFramebuffer(GL_FRAMEBUFFER, 0);
}

std::int64_t Renderer::shadow_passes() const {
  return impl_->earlier_passes + (impl_->schedule ? impl_->schedule->passes() : 0);
}

const Box3& Renderer::bounds() const {
  return impl_->scene->bounds;
}

std::vector<std::string> Renderer::plan() const {
  const Impl& i = *impl_;
  std::vector<std::string> lines;
  lines.push_back(fmt::format("compiled: {}", fmt::join(feature_names(i.features), ", ")));
  lines.push_back(i.lighting ? "two passes: surfaces, then the moving light once a pixel"
                             : "one pass: nothing is lit by the moving light");
  if (!i.shadow)
    lines.push_back(i.options.shading == Shading::unlit
                        ? "no shadow maps: nothing is lit by the moving light"
                        : "no shadow maps: shadows are off");
  else
    lines.push_back(fmt::format("shadow maps: {} of {}x{}, {} bits ({})", i.shadow_maps,
                                i.shadow->resolution(), i.shadow->resolution(), i.shadow->bits(),
                                name_of(i.options.shadows)));
  if (!i.scene->textured) lines.push_back("no texture code: the scene has no textures");
  if (!i.scene->baked_vertices && !i.scene->lightmap && i.scene->unlit != Unlit::all)
    lines.push_back("no baked light: the scene brings none");
  return lines;
}

}  // namespace atlas
