#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <span>
#include <unordered_map>
#include <utility>

#include "apps/atlas-pack/commands.h"
#include "apps/atlas-pack/far_texcoord.h"
#include "apps/atlas-pack/mesh_obj.h"
#include "apps/atlas-pack/preview.h"
#include "apps/atlas-pack/uv_charts.h"
#include "apps/common/depfile.h"
#include "apps/common/files.h"
#include "libatlas/core/counted.h"
#include "libatlas/files/atomic_file.h"
#include "libatlas/files/file_extension.h"
#include "libatlas/files/safe_file_name.h"
#include "libatlas/pack/fit.h"
#include "libatlas/scene/reader.h"

namespace atlas::app {
namespace {

RepackedMesh repack(const Scene& scene, const UvCharts& charts, const FitResult& fit) {
  RepackedMesh mesh{scene, charts, fit, std::vector<Vec2d>(scene.indices.size())};
  for (std::size_t c = 0; c < charts.members.size(); ++c) {
    const FitPlacement& at = fit.placements[c];
    const double cs = std::cos(at.angle) * at.scale, sn = std::sin(at.angle) * at.scale;
    for (std::size_t i = 0; i < charts.corners[c].size(); ++i) {
      const Vec2d p = charts.corners[c][i];
      mesh.uvs[3 * std::size_t(charts.members[c][i / 3]) + i % 3] = {
          cs * p.x - sn * p.y + at.offset.x, sn * p.x + cs * p.y + at.offset.y};
    }
  }
  return mesh;
}

std::filesystem::path material_file(const std::filesystem::path& mesh) {
  return safely_beside(mesh, ".mtl");
}

Status write_mesh(const std::filesystem::path& target, const RepackedMesh& mesh,
                  AtomicFiles& files) {
  const std::filesystem::path materials = material_file(target);
  const std::string obj = to_obj(mesh, materials.filename().string());
  for (const auto& [path, text] :
       {std::pair(materials, to_mtl(mesh.charts, mesh.fit)), {target, obj}}) {
    if (Status status = files.write(path, text); !status.ok()) return status;
  }
  return {};
}

std::int32_t round_up(std::int32_t side) {
  return static_cast<std::int32_t>(std::bit_ceil(static_cast<std::uint32_t>(side)));
}

// Returns a picture in which each chart is a path of its triangles, y down.
std::string to_svg(const RepackedMesh& mesh, std::span<const Rgb> colors) {
  const auto& [scene, charts, fit, uvs] = mesh;
  const PageRow row(fit.pages);
  std::string paths;
  for (std::size_t c = 0; c < charts.members.size(); ++c) {
    const std::uint32_t page = fit.placements[c].page;
    const Rgb& rgb = colors[c];
    const auto color = fmt::format("#{:02x}{:02x}{:02x}", rgb[0], rgb[1], rgb[2]);
    // The hairline covers the gaps that antialiasing leaves between triangles.
    paths += fmt::format("<path fill=\"{0}\" stroke=\"{0}\" stroke-width=\".3\" d=\"", color);
    for (std::uint32_t t : charts.members[c])
      for (std::size_t k = 0; k < 3; ++k) {
        const Vec2d q = uvs[3 * std::size_t(t) + k];
        paths += fmt::format("{}{:.2f} {:.2f}{}", k ? "L" : "M", q.x + double(row.left[page]),
                             fit.pages[page].height - q.y, k == 2 ? "Z" : "");
      }
    paths += fmt::format("\"><title>chart{}</title></path>\n", c);
  }
  return to_svg(row, fit.pages, paths);
}

Status draw(const std::filesystem::path& path, const RepackedMesh& mesh,
            std::span<const Rgb> colors, AtomicFiles& files) {
  if (lower_extension(path) == ".svg") return files.write(path, to_svg(mesh, colors));
  const auto& [scene, charts, fit, uvs] = mesh;
  PreviewSheet sheet(fit.pages);
  for (std::size_t c = 0; c < charts.members.size(); ++c) {
    for (const std::uint32_t t : charts.members[c]) {
      const Vec2d* p = &uvs[3 * std::size_t(t)];
      const double det =
          (p[1].x - p[0].x) * (p[2].y - p[0].y) - (p[1].y - p[0].y) * (p[2].x - p[0].x);
      if (det == 0) continue;
      const auto range = [](double a, double b, double d) {
        return std::pair(std::max(0, int(std::floor(std::min({a, b, d})))),
                         int(std::ceil(std::max({a, b, d}))));
      };
      const auto [x0, x1] = range(p[0].x, p[1].x, p[2].x);
      const auto [y0, y1] = range(p[0].y, p[1].y, p[2].y);
      const auto covered = [&](std::int32_t x, std::int32_t y) {
        const double qx = x + 0.5 - p[0].x, qy = y + 0.5 - p[0].y;
        const double u = (qx * (p[2].y - p[0].y) - qy * (p[2].x - p[0].x)) / det;
        const double v = ((p[1].x - p[0].x) * qy - (p[1].y - p[0].y) * qx) / det;
        return u >= 0 && v >= 0 && u + v <= 1;
      };
      sheet.fill(fit.placements[c].page, {x0, y0, x1 - x0 + 1, y1 - y0 + 1}, colors[c], covered);
    }
  }
  return sheet.write(path, files);
}

PackedAtlas describe(const FitResult& fit) {
  PackedAtlas atlas;
  atlas.pages = fit.pages;
  atlas.utilization = fit.utilization;
  for (std::size_t c = 0; c < fit.placements.size(); ++c) {
    const FitPlacement& p = fit.placements[c];
    PackedItem item;
    item.name = fmt::format("chart{}", c);
    item.size = item.source = {p.box.width, p.box.height};
    item.at = {p.page, p.box.x, fit.pages[p.page].height - p.box.top(), false};
    atlas.items.push_back(std::move(item));
  }
  return atlas;
}

// Returns the largest scale that can fit charts that cover this area. At scale 1 the triangles have
// the area of the pages; if they overlap each other, a larger scale fits.
double largest_scale(double covered, double page_area, const Context& context) {
  constexpr double kRounding = 1e-6;
  if (!(covered > 0) || covered > (1 - kRounding) * page_area) return 1;
  context.say(
      fmt::format("charts lie on themselves, as those of tiled textures do: all together "
                  "cover {:.3g} % of what their triangles would side by side",
                  100 * covered / page_area));
  return std::sqrt(page_area / covered);
}

// Returns whether charts may be turned by other than right angles.
bool any_angle(const PackCommand& c) {
  return c.rotations > 4;
}

// Refuses options that leave no room on a page, or that contradict each other.
Status check_page(const PackCommand& c, std::int64_t border, std::int64_t padding) {
  const PackOptions& o = c.options;
  if (c.page_side - 2 * border < o.alignment + 2 * padding)
    return {ErrorCode::bad_option,
            fmt::format("--border {}, --padding {} and --align {} leave no room on a page of {} "
                        "texels (give smaller ones or a larger --page)",
                        o.border, o.padding, o.alignment, c.page_side)};
  if (o.power_of_two && !std::has_single_bit(static_cast<std::uint32_t>(c.page_side)))
    return {ErrorCode::bad_option,
            fmt::format("--page {}: with --pot it must be a power of two (give {})", c.page_side,
                        std::bit_floor(static_cast<std::uint32_t>(c.page_side)))};
  return {};
}

// Packs the charts on pages whose border is kept free: they are packed without it, then moved.
Result<FitResult> fit_charts(const PackCommand& c, std::span<const FitItem> items,
                             std::span<const ChartShape> shapes, const Context& context) {
  const PackOptions& o = c.options;
  const std::int64_t border64 =
      (std::int64_t{o.border} + o.alignment - 1) / o.alignment * o.alignment;
  const std::int64_t padding = (std::max(o.padding, 0) + 1) / 2;
  if (Status s = check_page(c, border64, padding); !s.ok()) return s;
  const auto border = std::int32_t(border64);
  FitOptions fit;
  fit.pages = c.pages;
  fit.page_size = c.page_side - 2 * border;
  fit.power_of_two = false;  // a fit would not crop such pages; their sides are rounded up below
  fit.square = o.square;
  fit.free_aspect = o.crop && c.pages == 1 && !o.power_of_two && !o.square;
  fit.padding = std::int32_t(padding);
  fit.alignment = o.alignment;
  fit.minimum_side = 0;
  fit.preset = o.preset;
  fit.time_budget = o.time_budget;
  fit.effort = o.effort;
  fit.seed = o.seed;
  fit.shapes = shapes;
  const Result<double> measured = covered_area(shapes, context);
  fit.shapes_area = measured.ok() ? *measured : 0;  // the packer refuses the same shapes
  fit.max_scale =
      largest_scale(fit.shapes_area, double(c.page_side) * c.page_side * c.pages, context);
  fit.rotations = c.rotations;
  fit.any_angle = any_angle(c);
  Result<FitResult> fitted = fit_boxes_or_outlines(items, fit, context);
  if (!fitted.ok() && fitted.status().code() == ErrorCode::no_solution)
    return Status(
        ErrorCode::no_solution,
        fmt::format("{}: its {} charts do not fit {} of {} x {} texels even as small as can be "
                    "(give a larger --page{})",
                    c.input.string(), items.size(), counted(c.pages, "page"), c.page_side,
                    c.page_side,
                    padding > 0 ? ", more --pages or a smaller --padding" : " or more --pages"));
  if (!fitted.ok()) return fitted.status();
  for (FitPlacement& p : fitted->placements) {
    p.offset = {p.offset.x + border, p.offset.y + border};
    p.box.x += border;
    p.box.y += border;
  }
  double used = 0, whole = 0;
  for (Extent& page : fitted->pages) {
    used += static_cast<double>(page.area());
    page = {page.width + 2 * border, page.height + 2 * border};
    if (!o.crop) page = {c.page_side, c.page_side};
    if (o.power_of_two) page = {round_up(page.width), round_up(page.height)};
    whole += static_cast<double>(page.area());
  }
  if (whole > 0) fitted->utilization = fitted->filled * used / whole;
  return fitted;
}

// Scales the uvs so that shapes on their pages are not squeezed.
void widen_uvs(LoadedScene& loaded) {
  Scene& scene = loaded.scene;
  const std::vector<double>& aspects = loaded.material_uv_aspects;
  const auto widened = [](double aspect, Vec2f uv) {
    return Vec2f{static_cast<float>(aspect * uv.x), uv.y};
  };
  if (aspects.empty()) {
    if (loaded.uv_aspect > 0)
      for (Vec2f& uv : scene.texcoords) uv = widened(loaded.uv_aspect, uv);
    return;
  }
  // A texcoord that several materials share has a copy for each.
  std::vector<Vec2f> uvs;
  std::vector<std::unordered_map<std::uint32_t, std::uint32_t>> copies(aspects.size());
  for (std::size_t k = 0; k < scene.texcoord_indices.size(); ++k) {
    std::uint32_t& index = scene.texcoord_indices[k];
    if (index == Scene::kNoTexcoord) continue;
    const std::uint32_t material = scene.triangle_material[k / 3];
    const auto [at, is_new] =
        copies[material].try_emplace(index, static_cast<std::uint32_t>(uvs.size()));
    if (is_new) uvs.push_back(widened(aspects[material], scene.texcoords[index]));
    index = at->second;
  }
  scene.texcoords = std::move(uvs);
}

Status check_outputs(const PackCommand& c) {
  const std::filesystem::path materials = material_file(c.output);
  if (lower_extension(c.output) != ".obj")
    return {ErrorCode::bad_option,
            fmt::format("{}: the target must end in .obj", c.output.string())};
  if (Status s = check_output(c.output, {c.input, c.preview}); !s.ok()) return s;
  if (Status s = check_output(materials, {c.input, c.preview}); !s.ok()) return s;
  if (Status s = check_output(c.depfile, {c.input, c.preview, c.output, materials}); !s.ok())
    return s;
  return check_preview(c);
}

// Refuses outputs that would overwrite what the mesh consists of: which files these are is known
// only when it has been read. Textures are among them, though they are not read.
Status check_files_stay(const PackCommand& c, const LoadedScene& loaded) {
  for (const auto* files : {&loaded.files, &loaded.unread_files})
    for (const auto& file : *files)
      for (const auto& output : {c.output, material_file(c.output), c.preview, c.depfile})
        if (Status s = check_output(output, {file}); !s.ok()) return s;
  return {};
}

// Returns the rule that tells which files the mesh was made from; empty if none is asked for.
Result<std::string> rule_of(const PackCommand& c, const LoadedScene& loaded) {
  if (c.depfile.empty()) return std::string();
  std::vector<std::filesystem::path> inputs{c.input};
  inputs.insert(inputs.end(), loaded.files.begin(), loaded.files.end());
  return dependency_rule(c.output, inputs);
}

}  // namespace

Result<PackedAtlas> run_mesh(const PackCommand& c, const Context& context) {
  if (Status s = check_outputs(c); !s.ok()) return s;
  ReadOptions read = c.read;
  read.load_textures = false;
  read.normals = true;
  Result<LoadedScene> loaded = read_scene(c.input, read, context);
  if (!loaded.ok()) return loaded.status();
  const Result<std::string> rule = rule_of(c, *loaded);
  if (!rule.ok()) return rule.status();
  Scene& scene = loaded->scene;
  if (c.uv_aspect) loaded->uv_aspect = *c.uv_aspect, loaded->material_uv_aspects.clear();
  widen_uvs(*loaded);
  if (Status s = check_files_stay(c, *loaded); !s.ok()) return s;
  for (const std::string& line : loaded->defects.lines()) context.say("defect: " + line);
  for (const std::string& line : lost_in_obj(scene)) context.say("not kept: " + line);
  if (scene.texcoord_indices.empty())
    return Status(
        ErrorCode::bad_input,
        fmt::format("{}: has no uvs (atlas-export --charts-only makes some)", c.input.string()));
  UvCharts charts = find_charts(scene);
  scale_charts(scene, c.keep_density ? ChartSizes::given_uvs : ChartSizes::surface,
               double(c.page_side) * c.page_side * c.pages, charts);
  if (Status s = check_corners(c, charts, context); !s.ok()) return s;
  if (any_angle(c)) turn_upright(scene, charts, context);
  if (charts.without_uv > 0)
    context.say(fmt::format("triangles without uvs, which get none: {}", charts.without_uv));
  if (charts.without_area > 0)
    context.say(fmt::format("charts without an area in uv or in space, which shrink to a point: {}",
                            charts.without_area));
  std::vector<FitItem> items;
  std::vector<ChartShape> shapes;
  for (const auto& corners : charts.corners) {
    Vec2d low = corners.front(), high = low;
    for (const Vec2d& p : corners) {
      low = {std::min(low.x, p.x), std::min(low.y, p.y)};
      high = {std::max(high.x, p.x), std::max(high.y, p.y)};
    }
    items.push_back({high.x - low.x, high.y - low.y});
    shapes.push_back({corners, {}});
  }
  Result<FitResult> fitted = fit_charts(c, items, shapes, context);
  if (!fitted.ok()) return fitted.status();
  const RepackedMesh mesh = repack(scene, charts, *fitted);
  PackedAtlas atlas = describe(*fitted);
  AtomicFiles files;  // so that mesh, materials and preview appear together
  if (Status s = write_mesh(c.output, mesh, files); !s.ok()) return s;
  if (!c.preview.empty())
    if (Status s = draw(c.preview, mesh, item_colors(atlas), files); !s.ok()) return s;
  if (!rule->empty())
    if (Status s = files.write(c.depfile, *rule); !s.ok()) return s;
  if (Status s = files.commit(); !s.ok()) return s;
  atlas.files = {c.output, material_file(c.output)};
  return atlas;
}

}  // namespace atlas::app
