#include "libatlas/pipeline/write_export.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <glm/geometric.hpp>
#include <iterator>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "libatlas/core/bounds.h"
#include "libatlas/core/glm_bridge.h"
#include "libatlas/core/luma.h"
#include "libatlas/core/parallel.h"
#include "libatlas/core/srgb.h"
#include "libatlas/exporters/viewpoint.h"
#include "libatlas/exporters/world.h"
#include "libatlas/image/image_io.h"
#include "libatlas/pipeline/assemble_world.h"
#include "libatlas/pipeline/export_world.h"
#include "libatlas/pipeline/false_colour.h"
#include "libatlas/pipeline/lightmap.h"
#include "libatlas/pipeline/plan.h"
#include "libatlas/pipeline/report_pictures.h"
#include "libatlas/scene/uv_page.h"
#include "libatlas/sheets/one_sided.h"

namespace atlas {
namespace {

// The share of the coarser mesh's slip by which packed positions may slip, too.
constexpr double kSlipOfPacking = 0.25;

// Returns what each triangle shows on average, as display values. Three samples are enough for the
// choice of a viewpoint.
std::vector<std::uint8_t> shown_light(const Scene& scene, const SceneLight& light,
                                      const Context& context) {
  std::vector<std::uint8_t> shown(scene.triangle_count());
  parallel_for(context, shown.size(), 4096, [&](std::size_t begin, std::size_t end) {
    for (std::size_t t = begin; t < end; ++t) {
      const auto corner = [&](int k) { return to_dvec(scene.positions[scene.indices[3 * t + k]]); };
      const double spacing =
          std::sqrt(glm::length(glm::cross(corner(1) - corner(0), corner(2) - corner(0))) / 2);
      const auto triangle = light.sampler.prepare(std::uint32_t(t), spacing);
      float sum = 0;
      for (const int k : {0, 1, 2}) {
        const float b[2] = {k == 0 ? 2 / 3.0f : 1 / 6.0f, k == 1 ? 2 / 3.0f : 1 / 6.0f};
        const Vec3f shows =
            light.tone.display(LuminanceSampler::sample(triangle, b[0], b[1], 1 - b[0] - b[1]));
        sum += luma(shows.x, shows.y, shows.z);
      }
      shown[t] = quantize8(sum / 3);
    }
  });
  return shown;
}

// Returns a view of the scene's file. Nothing if it looks straight up or down: such a view has no
// heading, so viewers could not keep upright.
std::optional<Viewpoint> own_viewpoint(const ExportJob& job, const FileView& own) {
  constexpr double kUpright = 0.9999;
  const glm::dvec3 ahead = glm::normalize(to_glm(own.direction));
  if (std::abs(job.options.up == Up::z ? ahead.z : ahead.y) > kUpright) return std::nullopt;
  const Scene& scene = job.scene;
  const glm::dvec3 eye = to_glm(own.position) - to_glm(scene.origin);
  Bounds<glm::dvec3> box, point;
  for (const std::uint32_t i : scene.indices) box.add(to_dvec(scene.positions[i]));
  point.add(eye);
  Viewpoint view;
  view.position = from_glm(eye);
  view.direction = from_glm(ahead);
  view.inside = box.meets(point);
  return view;
}

Viewpoint viewpoint_of(const ExportJob& job, const SceneLight* light, const Context& context) {
  if (job.view)
    if (const std::optional<Viewpoint> own = own_viewpoint(job, *job.view)) return *own;
  const std::vector<std::uint8_t> shown =
      light ? shown_light(job.scene, *light, context) : std::vector<std::uint8_t>();
  ViewpointOptions eye;
  eye.up = job.options.up;
  eye.metres_per_unit = job.scene.metres_per_unit;
  eye.light = shown;
  return choose_viewpoint(job.scene.positions, job.scene.indices, eye, context);
}

// Returns the reflectance that multiplies a triangle's light, or 0 if that is not one colour.
Vec3f reflectance_of(const Scene& scene, std::size_t triangle) {
  const Material& material = scene.materials[scene.triangle_material[triangle]];
  return material.texture >= 0 && !scene.texcoord_indices.empty() ? Vec3f{} : material.diffuse;
}

PageLight light_of(const ExportJob& job, const ChartSet& charts) {
  PageLight light;
  const ExportReport& report = job.report;
  const Quantity quantity = job.options.quantity;
  light.quantity = quantity == Quantity::illuminance ? "illuminance"
                   : quantity == Quantity::luminance ? "luminance"
                                                     : "colour";
  ToneOptions options = tone_options(job.options);
  const auto add = [&](const ToneMapping& tone) {
    ShownCurve curve{std::string(tone_operator_name(tone.op)), tone.scale, tone.white, {}, {}};
    std::copy(std::begin(tone.parameter), std::end(tone.parameter), curve.parameter);
    std::copy(std::begin(tone.offset), std::end(tone.offset), curve.offset);
    light.curves.push_back(std::move(curve));
  };
  add(report.tone);
  for (const ToneOperator op : {ToneOperator::linear, ToneOperator::reinhard, ToneOperator::drago,
                                ToneOperator::reinhard_devlin}) {
    if (op == report.tone.op) continue;
    options.op = op;
    if (const auto tone = make_tone_mapping(options, report.luminance); tone.ok()) add(*tone);
  }
  if (quantity != Quantity::illuminance) return light;
  light.reflectance.resize(charts.charts.size());
  std::vector<bool> seen(light.reflectance.size(), false);
  for (std::size_t t = 0; t < charts.triangle_chart.size(); ++t) {
    const std::uint32_t chart = charts.triangle_chart[t];
    const Vec3f r = reflectance_of(job.scene, t);
    light.reflectance[chart] = !seen[chart] || light.reflectance[chart] == r ? r : Vec3f{};
    seen[chart] = true;
  }
  return light;
}

void add_pages(const ExportJob& job, const BakedPages& baked, World& world) {
  for (std::size_t p = 0; p < baked.image_sources.size(); ++p) {
    Page& page = world.pages[p];
    page.image = job.report.pages[p].image;
    page.image_source = baked.image_sources[p];
    if (p < baked.error.size()) {
      page.error = baked.error[p].rms;
      page.error_columns = baked.error[p].columns;
    }
  }
}

// Says in the world how large its pages are.
void add_page_texts(const ExportOptions& options, std::span<const Extent> pages, bool baked,
                    World& world) {
  if (!baked) world.info.push_back(plain_pages_text(pages, options.udim));
  if (baked && options.keep_scene) {
    world.info.push_back(uv_page_text(pages[0].width, pages[0].height));
  } else if (baked || pages.size() > 1) {
    for (std::size_t p = 0; p < pages.size(); ++p)
      world.info.push_back(uv_page_text(p, pages[p].width, pages[p].height));
  }
}

void add_lightmap(const ExportJob& job, const ExportToWrite& made, World& world) {
  world.lightmap = lightmap_of(job.report, job.options);
  const PageLayout& layout = made.packed.layout;
  if (layout.pages.size() > 1) {
    for (const std::uint32_t chart : made.mesh.triangle_chart)
      world.lightmap->triangle_page.push_back(std::uint32_t(layout.placements[chart].page));
  }
  world.info.push_back(lightmap_text(*world.lightmap));
}

World make_world(ExportJob& job, ExportToWrite& made, const Context& context) {
  const ExportOptions& options = job.options;
  const ChartSet& charts = made.packed.charts;
  const PageLayout& layout = made.packed.layout;
  const PlacedCharts placed = made.packed.placed();
  World world = assemble_world(job.scene, placed, made.mesh, std::move(made.uvs));
  add_page_texts(options, layout.pages, made.light, world);
  if (!made.light && options.polygons && job.scene.polygons.count() > 0)
    job.report.cut_polygons = take_polygons(job.scene, placed, world);
  if (!made.light && options.udim) make_tiles(placed, world);
  world.up = options.up;
  world.title = options.target.stem().string();
  world.metres_per_unit = job.scene.metres_per_unit;
  if (options.compress)
    world.compress_slip = kSlipOfPacking * options.simplify_slip * job.report.packed_texel;
  if (options.keep_scene) {
    keep_scene(job.scene, charts, world);
    world.uv_set = options.uv_set;
    if (made.light) add_lightmap(job, made, world);
    return world;
  }
  if (holds_viewpoint(options.target)) {
    world.viewpoint = viewpoint_of(job, made.light, context);
    for (const FileView& further : job.further_views)
      if (const std::optional<Viewpoint> view = own_viewpoint(job, further))
        world.further_viewpoints.push_back({further.name, *view});
  }
  add_pages(job, made.baked, world);
  if (made.light && options.linear) world.light = light_of(job, charts);
  return world;
}

// Draws the pictures that were asked for, while the pages' images are still at hand.
Status draw(ExportJob& job, const ExportToWrite& made) {
  const auto& [charts, densities, layout] = made.packed;
  if (job.options.report_pictures) {
    Result<ReportPictures> pictures = report_pictures(
        {charts, layout, made.baked.image_sources, job.report.fidelity.worst}, job.context);
    if (!pictures.ok()) return job.files.told_by_target(pictures.status());
    job.report.pictures = std::move(*pictures);
  }
  if (job.options.false_colour.empty()) return {};
  return job.files.told_by_target(
      write_png(job.files.path_for(job.options.false_colour),
                draw_false_colours(job.scene, job.options.up, charts, layout), {}));
}

// Gives all files their names, the extra ones too, and adds the sizes of the world's own to the
// report and up to `bytes`.
Status commit_files(ExportJob& job, std::uint64_t& bytes) {
  AtomicFiles& files = job.files;
  const std::vector<std::filesystem::path> written = files.targets();
  for (const ExtraFile& file : job.options.extra_files)
    if (Status s = files.write(file.path, file.bytes); !s.ok()) return s;
  if (Status s = files.commit(job.options.durable); !s.ok()) return s;
  for (const auto& path : written) {
    std::error_code error;
    const auto size = std::filesystem::file_size(path, error);
    job.report.files.emplace_back(path.filename().string(), error ? 0 : size);
    bytes += job.report.files.back().second;
  }
  return {};
}

// Returns advice on a glTF world that floats cannot hold where it is.
std::string on_far_origin(const World& world) {
  return fmt::format(
      "the world is placed at {} {} {} by its node '{}', which is too far for engines that hold "
      "single floats: they show it torn, or nothing (move that node to 0 0 0 after loading; "
      "Babylon.js has useLargeWorldRendering)",
      world.origin.x, world.origin.y, world.origin.z, kFarOriginNode);
}

// Returns advice on meshes of hidden nodes, of other scenes and of no node.
std::string on_meshes_without_uvs(std::size_t count) {
  return fmt::format(
      "{} {} as before, without new uvs, since the scene does not show {} (show {} there to have "
      "new uvs)",
      count, count == 1 ? "mesh stays" : "meshes stay", count == 1 ? "it" : "them",
      count == 1 ? "it" : "them");
}

std::string writing_note(const ExportJob& job, const WorldFile& written) {
  const Vec3d& left_out = written.origin_left_out;
  if (job.options.keep_scene)
    return fmt::format("its objects: {}, materials: {}; the new uvs: {}",
                       job.scene.object_names.size(), job.scene.materials.size(), written.uv_set);
  if (left_out == Vec3d{}) return "";
  return fmt::format("relative to {} {} {}", left_out.x, left_out.y, left_out.z);
}

World world_of_meshes(const ExportJob& job, const MeshUvsOfScene& made) {
  World world;
  world.origin = job.scene.origin;
  world.positions = job.scene.positions;
  world.uvs = made.uvs;
  world.instances = made.instances;
  world.pages.resize(1);
  world.pages[0].indices = job.scene.indices;
  world.pages[0].uv_indices = made.uv_indices;
  world.scene = &job.scene;
  world.uv_set = job.options.uv_set;
  world.up = job.options.up;
  world.title = job.options.target.stem().string();
  world.metres_per_unit = job.scene.metres_per_unit;
  if (job.options.compress) world.compress_slip = 0;
  return world;
}

// `images`: where the pages' images lie, which are not kept if the world holds them itself.
Status write_and_commit(ExportJob& job, const World& world,
                        std::span<const std::filesystem::path> images, const Context& context) {
  const ExportOptions& options = job.options;
  ExportReport& report = job.report;
  Result<WorldFile> written = write_world(world, options.target, job.files, context);
  if (!written.ok()) return written.status();
  report.not_kept = written->not_kept;
  if (written->meshes_without_uvs > 0)
    report.advice.push_back(on_meshes_without_uvs(written->meshes_without_uvs));
  if (written->far_origin) report.advice.push_back(on_far_origin(world));
  if (embeds_images(options.target) && !options.keep_scene) {
    for (const auto& image : images) job.files.discard(image);
    for (PageReport& page : report.pages) page.image.clear();
  }
  if (context.cancelled()) return Status::cancelled();
  std::uint64_t bytes = 0;
  if (Status s = commit_files(job, bytes); !s.ok()) return s;
  job.record.finish({report.triangles_out, bytes, "bytes", writing_note(job, *written)});
  return {};
}

}  // namespace

Status write_export(ExportJob& job, ExportToWrite made) {
  const Context& context = job.record.begin("writing");
  if (Status s = draw(job, made); !s.ok()) return s;
  if (made.light && !job.options.keep_scene)
    made.mesh.one_sided = one_sided_triangles(job.scene, made.packed.charts, made.mesh, context);
  if (context.cancelled()) return Status::cancelled();
  const World world = make_world(job, made, context);
  return write_and_commit(job, world, made.baked.image_sources, context);
}

Status write_export(ExportJob& job, const MeshUvsOfScene& made) {
  const Context& context = job.record.begin("writing");
  return write_and_commit(job, world_of_meshes(job, made), {}, context);
}

}  // namespace atlas
