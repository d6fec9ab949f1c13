#include "libatlas/pipeline/write_export.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <glm/geometric.hpp>
#include <iterator>
#include <optional>
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
#include "libatlas/pipeline/assemble_world.h"
#include "libatlas/pipeline/export_world.h"
#include "libatlas/pipeline/lightmap.h"
#include "libatlas/pipeline/plan.h"
#include "libatlas/scene/uv_page.h"
#include "libatlas/sheets/one_sided.h"

namespace atlas {
namespace {

// The share of the coarser mesh's slip by which packed positions may slip, too.
constexpr double kSlipOfPacking = 0.25;

// Returns what each triangle shows on average, as display values. Three samples are enough for the
// choice of a viewpoint.
std::vector<std::uint8_t> shown_light(const ExportToWrite& made, const ToneMapping& tone,
                                      const Context& context) {
  const Scene& scene = made.scene;
  std::vector<std::uint8_t> shown(scene.triangle_count());
  parallel_for(context, shown.size(), 4096, [&](std::size_t begin, std::size_t end) {
    for (std::size_t t = begin; t < end; ++t) {
      const auto corner = [&](int k) { return to_dvec(scene.positions[scene.indices[3 * t + k]]); };
      const double spacing =
          std::sqrt(glm::length(glm::cross(corner(1) - corner(0), corner(2) - corner(0))) / 2);
      const auto triangle = made.light->prepare(std::uint32_t(t), spacing);
      float sum = 0;
      for (const int k : {0, 1, 2}) {
        const float b[2] = {k == 0 ? 2 / 3.0f : 1 / 6.0f, k == 1 ? 2 / 3.0f : 1 / 6.0f};
        const Vec3f shows =
            tone.display(LuminanceSampler::sample(triangle, b[0], b[1], 1 - b[0] - b[1]));
        sum += luma(shows.x, shows.y, shows.z);
      }
      shown[t] = quantize8(sum / 3);
    }
  });
  return shown;
}

// Returns a view of the scene's file. Nothing if it looks straight up or down: such a view has no
// heading, so viewers could not keep upright.
std::optional<Viewpoint> own_viewpoint(const ExportToWrite& made, const FileView& own) {
  constexpr double kUpright = 0.9999;
  const glm::dvec3 ahead = glm::normalize(to_glm(own.direction));
  if (std::abs(made.options.up == Up::z ? ahead.z : ahead.y) > kUpright) return std::nullopt;
  const Scene& scene = made.scene;
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

Viewpoint viewpoint_of(const ExportToWrite& made, const ToneMapping& tone, const Context& context) {
  if (made.view)
    if (const std::optional<Viewpoint> own = own_viewpoint(made, *made.view)) return *own;
  const std::vector<std::uint8_t> light =
      made.baked ? shown_light(made, tone, context) : std::vector<std::uint8_t>();
  ViewpointOptions eye;
  eye.up = made.options.up;
  eye.metres_per_unit = made.scene.metres_per_unit;
  eye.light = light;
  return choose_viewpoint(made.scene.positions, made.scene.indices, eye, context);
}

// Returns the reflectance that multiplies a triangle's light, or 0 if that is not one colour.
Vec3f reflectance_of(const Scene& scene, std::size_t triangle) {
  const Material& material = scene.materials[scene.triangle_material[triangle]];
  return material.texture >= 0 && !scene.texcoord_indices.empty() ? Vec3f{} : material.diffuse;
}

PageLight light_of(const ExportToWrite& made, const ExportReport& report) {
  PageLight light;
  const Quantity quantity = made.options.quantity;
  light.quantity = quantity == Quantity::illuminance ? "illuminance"
                   : quantity == Quantity::luminance ? "luminance"
                                                     : "colour";
  ToneOptions options = tone_options(made.options);
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
  light.reflectance.resize(made.charts.charts.size());
  std::vector<bool> seen(light.reflectance.size(), false);
  for (std::size_t t = 0; t < made.charts.triangle_chart.size(); ++t) {
    const std::uint32_t chart = made.charts.triangle_chart[t];
    const Vec3f r = reflectance_of(made.scene, t);
    light.reflectance[chart] = !seen[chart] || light.reflectance[chart] == r ? r : Vec3f{};
    seen[chart] = true;
  }
  return light;
}

World make_world(ExportToWrite& made, ExportReport& report, const Context& context) {
  const ExportOptions& options = made.options;
  const PlacedCharts placed{made.charts, made.layout.placements, made.layout.pages};
  World world = assemble_world(made.scene, placed, made.mesh, std::move(made.uvs));
  if (!made.baked) {
    world.info.push_back(plain_pages_text(made.layout.pages, options.udim));
    if (options.udim) make_tiles(placed, world);
  } else {
    const std::vector<Extent>& pages = made.layout.pages;
    if (options.keep_scene) world.info.push_back(uv_page_text(pages[0].width, pages[0].height));
    for (std::size_t p = 0; p < pages.size() && !options.keep_scene; ++p)
      world.info.push_back(uv_page_text(p, pages[p].width, pages[p].height));
  }
  world.up = options.up;
  world.title = options.target.stem().string();
  world.metres_per_unit = made.scene.metres_per_unit;
  if (options.compress)
    world.compress_slip = kSlipOfPacking * options.simplify_slip * report.packed_texel;
  if (options.keep_scene) {
    keep_scene(made.scene, made.charts, world);
    world.uv_set = options.uv_set;
    if (!made.baked) return world;
    world.lightmap = lightmap_of(report, options);
    if (made.layout.pages.size() > 1) {
      for (const std::uint32_t chart : made.mesh.triangle_chart)
        world.lightmap->triangle_page.push_back(std::uint32_t(made.layout.placements[chart].page));
    }
    world.info.push_back(lightmap_text(*world.lightmap));
    return world;
  }
  if (holds_viewpoint(options.target)) {
    world.viewpoint = viewpoint_of(made, report.tone, context);
    for (const FileView& further : made.further_views)
      if (const std::optional<Viewpoint> view = own_viewpoint(made, further))
        world.further_viewpoints.push_back({further.name, *view});
  }
  for (std::size_t p = 0; p < made.image_sources.size(); ++p) {
    world.pages[p].image = report.pages[p].image;
    world.pages[p].image_source = made.image_sources[p];
    if (p < made.error.size()) {
      world.pages[p].error = made.error[p].rms;
      world.pages[p].error_columns = made.error[p].columns;
    }
  }
  if (made.baked && options.linear) world.light = light_of(made, report);
  return world;
}

// Gives all files their names, the extra ones too, and adds the sizes of the world's own to the
// report and up to `bytes`.
Status commit_files(const ExportOptions& options, AtomicFiles& files, ExportReport& report,
                    std::uint64_t& bytes) {
  const std::vector<std::filesystem::path> written = files.targets();
  for (const ExtraFile& file : options.extra_files)
    if (Status s = files.write(file.path, file.bytes); !s.ok()) return s;
  if (Status s = files.commit(options.durable); !s.ok()) return s;
  for (const auto& path : written) {
    std::error_code error;
    const auto size = std::filesystem::file_size(path, error);
    report.files.emplace_back(path.filename().string(), error ? 0 : size);
    bytes += report.files.back().second;
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

std::string writing_note(const ExportToWrite& made, const WorldFile& written) {
  const Vec3d& left_out = written.origin_left_out;
  if (made.options.keep_scene)
    return fmt::format("its objects: {}, materials: {}; the new uvs: {}",
                       made.scene.object_names.size(), made.scene.materials.size(), written.uv_set);
  if (left_out == Vec3d{}) return "";
  return fmt::format("relative to {} {} {}", left_out.x, left_out.y, left_out.z);
}

}  // namespace

Result<StageOutcome> write_export(ExportToWrite made, AtomicFiles& files, ExportReport& report,
                                  const Context& context) {
  if (made.baked && !made.options.keep_scene)
    made.mesh.one_sided = one_sided_triangles(made.scene, made.charts, made.mesh, context);
  if (context.cancelled()) return Status::cancelled();
  const World world = make_world(made, report, context);
  Result<WorldFile> world_file = write_world(world, made.options.target, files, context);
  if (!world_file.ok()) return world_file.status();
  report.not_kept = world_file->not_kept;
  if (world_file->meshes_without_uvs > 0)
    report.advice.push_back(on_meshes_without_uvs(world_file->meshes_without_uvs));
  if (world_file->far_origin) report.advice.push_back(on_far_origin(world));
  if (embeds_images(made.options.target) && !made.options.keep_scene) {
    for (const auto& image : made.image_sources) files.discard(image);
    for (PageReport& page : report.pages) page.image.clear();
  }
  if (context.cancelled()) return Status::cancelled();
  std::uint64_t bytes = 0;
  if (Status s = commit_files(made.options, files, report, bytes); !s.ok()) return s;
  return StageOutcome{report.triangles_out, bytes, "bytes", writing_note(made, *world_file)};
}

}  // namespace atlas
