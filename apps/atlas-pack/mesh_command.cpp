#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <charconv>
#include <cmath>
#include <numeric>

#include "apps/atlas-pack/commands.h"
#include "apps/atlas-pack/preview.h"
#include "apps/common/files.h"
#include "libatlas/core/atomic_file.h"
#include "libatlas/pack/fit.h"
#include "libatlas/scene/reader.h"

namespace atlas::app {
namespace {

// The uv charts of a mesh: triangles joined by common texcoord indices.
struct UvCharts {
  std::vector<std::uint32_t> chart;                 // 1 a triangle, or kNone
  std::vector<std::vector<std::uint32_t>> members;  // triangles a chart
  std::vector<std::vector<Vec2d>> corners;          // 3 a triangle, texels at scale 1
  std::size_t without_uv = 0, without_area = 0;
  static constexpr std::uint32_t kNone = 0xffffffffu;
};

class Sets {
 public:
  explicit Sets(std::size_t n) : parent_(n) { std::iota(parent_.begin(), parent_.end(), 0u); }
  std::uint32_t find(std::uint32_t i) {
    while (parent_[i] != i) i = parent_[i] = parent_[parent_[i]];
    return i;
  }
  void join(std::uint32_t a, std::uint32_t b) {
    a = find(a);
    b = find(b);
    parent_[std::max(a, b)] = std::min(a, b);
  }

 private:
  std::vector<std::uint32_t> parent_;
};

double area_in_space(const Scene& s, std::size_t t) {
  const Vec3f &a = s.positions[s.indices[3 * t]], &b = s.positions[s.indices[3 * t + 1]],
              &c = s.positions[s.indices[3 * t + 2]];
  const double ux = double(b.x) - a.x, uy = double(b.y) - a.y, uz = double(b.z) - a.z;
  const double vx = double(c.x) - a.x, vy = double(c.y) - a.y, vz = double(c.z) - a.z;
  const double x = uy * vz - uz * vy, y = uz * vx - ux * vz, z = ux * vy - uy * vx;
  return std::sqrt(x * x + y * y + z * z) / 2;
}

double area_of(const Vec2d* p) {
  return std::abs((p[1].x - p[0].x) * (p[2].y - p[0].y) - (p[1].y - p[0].y) * (p[2].x - p[0].x)) /
         2;
}

UvCharts find_charts(const Scene& s) {
  UvCharts charts;
  charts.chart.assign(s.triangle_count(), UvCharts::kNone);
  Sets sets(s.texcoords.size());
  const auto has_uv = [&](std::size_t t) {
    for (std::size_t k = 3 * t; k < 3 * t + 3; ++k)
      if (s.texcoord_indices[k] == Scene::kNoTexcoord) return false;
    return true;
  };
  for (std::size_t t = 0; t < s.triangle_count(); ++t) {
    if (!has_uv(t)) continue;
    sets.join(s.texcoord_indices[3 * t], s.texcoord_indices[3 * t + 1]);
    sets.join(s.texcoord_indices[3 * t], s.texcoord_indices[3 * t + 2]);
  }
  std::vector<std::uint32_t> number(s.texcoords.size(), UvCharts::kNone);
  for (std::size_t t = 0; t < s.triangle_count(); ++t) {
    if (!has_uv(t)) {
      ++charts.without_uv;
      continue;
    }
    std::uint32_t& id = number[sets.find(s.texcoord_indices[3 * t])];
    if (id == UvCharts::kNone) {
      id = static_cast<std::uint32_t>(charts.members.size());
      charts.members.emplace_back();
    }
    charts.chart[t] = id;
    charts.members[id].push_back(static_cast<std::uint32_t>(t));
  }
  return charts;
}

// Scales every chart so that its area is that of its surface, and all together fill the pages.
void make_uniform(const Scene& s, double page_area, UvCharts& charts) {
  double total = 0;
  for (const auto& members : charts.members)
    for (std::uint32_t t : members) total += area_in_space(s, t);
  const double texels = total > 0 ? std::sqrt(page_area / total) : 0;
  for (const auto& members : charts.members) {
    std::vector<Vec2d> corners;
    double flat = 0, real = 0;
    for (std::uint32_t t : members) {
      real += area_in_space(s, t);
      for (std::size_t k = 3 * std::size_t(t); k < 3 * std::size_t(t) + 3; ++k) {
        const Vec2f uv = s.texcoords[s.texcoord_indices[k]];
        corners.push_back({uv.x, uv.y});
      }
      flat += area_of(&corners[corners.size() - 3]);
    }
    const double factor = flat > 0 ? texels * std::sqrt(real / flat) : 0;
    charts.without_area += factor == 0;
    const Vec2d base = corners.front();
    for (Vec2d& p : corners) p = {(p.x - base.x) * factor, (p.y - base.y) * factor};
    charts.corners.push_back(std::move(corners));
  }
}

std::string number(double v) {
  char text[32];
  const auto end = std::to_chars(text, text + sizeof text, v).ptr;
  return {text, end};
}

// The mesh with its new uvs: one vt a corner, one material a page.
std::string to_obj(const Scene& s, const UvCharts& charts, const FitResult& fit,
                   std::vector<Vec2d>& uvs) {
  std::string text = "# repacked by atlas-pack\n";
  for (const Vec3f& p : s.positions)
    text += fmt::format("v {} {} {}\n", number(s.origin.x + p.x), number(s.origin.y + p.y),
                        number(s.origin.z + p.z));
  uvs.assign(s.indices.size(), {});
  std::string faces;
  std::size_t vt = 0;
  for (std::uint32_t page = 0; page < fit.pages.size(); ++page) {
    bool named = false;
    for (std::size_t c = 0; c < charts.members.size(); ++c) {
      const FitPlacement& at = fit.placements[c];
      if (at.page != page) continue;
      const double cs = std::cos(at.angle) * at.scale, sn = std::sin(at.angle) * at.scale;
      for (std::size_t m = 0; m < charts.members[c].size(); ++m) {
        if (!named) faces += fmt::format("usemtl page_{}\n", page);
        named = true;
        const std::size_t t = charts.members[c][m];
        faces += "f";
        for (std::size_t k = 0; k < 3; ++k) {
          const Vec2d p = charts.corners[c][3 * m + k];
          const Vec2d q{cs * p.x - sn * p.y + at.offset.x, sn * p.x + cs * p.y + at.offset.y};
          uvs[3 * t + k] = q;
          text += fmt::format("vt {} {}\n", number(q.x / fit.pages[page].width),
                              number(q.y / fit.pages[page].height));
          faces += fmt::format(" {}/{}", s.indices[3 * t + k] + 1, ++vt);
        }
        faces += "\n";
      }
    }
  }
  if (charts.without_uv > 0) faces += "usemtl no_uv\n";
  for (std::size_t t = 0; t < s.triangle_count(); ++t)
    if (charts.chart[t] == UvCharts::kNone)
      faces += fmt::format("f {} {} {}\n", s.indices[3 * t] + 1, s.indices[3 * t + 1] + 1,
                           s.indices[3 * t + 2] + 1);
  return text + faces;
}

std::int32_t round_up(std::int32_t side) {
  return static_cast<std::int32_t>(std::bit_ceil(static_cast<std::uint32_t>(side)));
}

// Every chart a path of its triangles, y down.
std::string to_svg(const UvCharts& charts, const FitResult& fit, const std::vector<Vec2d>& uvs) {
  std::int64_t width = 0, height = 1;
  std::vector<std::int64_t> left;
  std::string pages, paths;
  for (Extent p : fit.pages) {
    left.push_back(width);
    pages += fmt::format("<rect x=\"{}\" width=\"{}\" height=\"{}\" fill=\"#333\"/>\n", width,
                         p.width, p.height);
    width += p.width + 16;
    height = std::max<std::int64_t>(height, p.height);
  }
  for (std::size_t c = 0; c < charts.members.size(); ++c) {
    const std::uint32_t page = fit.placements[c].page;
    std::uint8_t rgb[3];
    item_color(c, rgb);
    const auto color = fmt::format("#{:02x}{:02x}{:02x}", rgb[0], rgb[1], rgb[2]);
    // The hairline covers the gaps that antialiasing leaves between triangles.
    paths += fmt::format("<path fill=\"{0}\" stroke=\"{0}\" stroke-width=\".3\" d=\"", color);
    for (std::uint32_t t : charts.members[c])
      for (std::size_t k = 0; k < 3; ++k) {
        const Vec2d q = uvs[3 * std::size_t(t) + k];
        paths += fmt::format("{}{:.2f} {:.2f}{}", k ? "L" : "M", q.x + double(left[page]),
                             fit.pages[page].height - q.y, k == 2 ? "Z" : "");
      }
    paths += fmt::format("\"><title>chart{}</title></path>\n", c);
  }
  return fmt::format(
      "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {} {}\">\n{}{}</svg>\n",
      std::max<std::int64_t>(1, width - 16), height, pages, paths);
}

Status draw(const std::filesystem::path& path, const UvCharts& charts, const FitResult& fit,
            const std::vector<Vec2d>& uvs) {
  if (path.extension() == ".svg") return write_file(path, to_svg(charts, fit, uvs));
  std::vector<Image8> pages;
  for (Extent p : fit.pages) pages.emplace_back(p.width, p.height, 3, std::uint8_t{51});
  for (std::size_t c = 0; c < charts.members.size(); ++c) {
    std::uint8_t rgb[3];
    item_color(c, rgb);
    Image8& page = pages[fit.placements[c].page];
    for (std::uint32_t t : charts.members[c]) {
      const Vec2d* p = &uvs[3 * std::size_t(t)];
      const double det =
          (p[1].x - p[0].x) * (p[2].y - p[0].y) - (p[1].y - p[0].y) * (p[2].x - p[0].x);
      if (det == 0) continue;
      const auto range = [](double a, double b, double d, int limit) {
        return std::pair(std::max(0, int(std::floor(std::min({a, b, d})))),
                         std::min(limit - 1, int(std::ceil(std::max({a, b, d})))));
      };
      const auto [x0, x1] = range(p[0].x, p[1].x, p[2].x, page.width);
      const auto [y0, y1] = range(p[0].y, p[1].y, p[2].y, page.height);
      for (int y = y0; y <= y1; ++y)
        for (int x = x0; x <= x1; ++x) {
          const double qx = x + 0.5 - p[0].x, qy = y + 0.5 - p[0].y;
          const double u = (qx * (p[2].y - p[0].y) - qy * (p[2].x - p[0].x)) / det;
          const double v = ((p[1].x - p[0].x) * qy - (p[1].y - p[0].y) * qx) / det;
          if (u >= 0 && v >= 0 && u + v <= 1) std::copy_n(rgb, 3, page.at(x, y));
        }
    }
  }
  return write_preview_png(path, pages);
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

// Charts on pages whose border is kept free: packed without it, then moved.
Result<FitResult> fit_charts(const PackCommand& c, std::span<const FitItem> items,
                             std::span<const ChartShape> shapes, const Context& context) {
  const PackOptions& o = c.options;
  if (o.alignment < 1 || o.border < 0 || o.border > c.page_side / 2)
    return Status(ErrorCode::bad_option,
                  "mesh: --align must be 1 or more, --border 0 to half the page's side");
  const std::int32_t border = (o.border + o.alignment - 1) / o.alignment * o.alignment;
  FitOptions fit;
  fit.pages = c.pages;
  fit.page_size = c.page_side - 2 * border;
  fit.power_of_two = o.power_of_two && border == 0;
  fit.square = o.square;
  fit.free_aspect = o.crop && c.pages == 1 && !o.power_of_two && !o.square;
  fit.padding = (std::max(o.padding, 0) + 1) / 2;
  fit.alignment = o.alignment;
  fit.minimum_side = 0;
  fit.preset = o.preset;
  fit.time_budget = o.time_budget;
  fit.effort = o.effort;
  fit.seed = o.seed;
  fit.shapes = shapes;
  fit.rotations = c.rotations;
  fit.any_angle = c.rotations > 4;
  Result<FitResult> fitted = fit_pages(items, fit, context);
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
    if (!o.crop && !fit.power_of_two) page = {c.page_side, c.page_side};
    if (o.power_of_two && !fit.power_of_two) page = {round_up(page.width), round_up(page.height)};
    if (o.square) page.width = page.height = std::max(page.width, page.height);
    whole += static_cast<double>(page.area());
  }
  if (whole > 0) fitted->utilization *= used / whole;
  return fitted;
}

}  // namespace

Result<PackedAtlas> run_mesh(const PackCommand& c, const Context& context) {
  if (c.output.extension() != ".obj")
    return Status(ErrorCode::bad_option,
                  fmt::format("{}: the target must end in .obj", c.output.string()));
  if (Status s = check_output(c.output, {c.input, c.preview}); !s.ok()) return s;
  if (Status s = check_preview(c); !s.ok()) return s;
  ReadOptions read;
  read.load_textures = false;
  Result<LoadedScene> loaded = read_scene(c.input, read, context);
  if (!loaded.ok()) return loaded.status();
  const Scene& scene = loaded->scene;
  for (const std::string& line : loaded->defects.lines()) context.say("defect: " + line);
  if (scene.texcoord_indices.empty())
    return Status(ErrorCode::bad_input,
                  fmt::format("{}: has no uvs (unwrap it first)", c.input.string()));
  UvCharts charts = find_charts(scene);
  make_uniform(scene, double(c.page_side) * c.page_side * c.pages, charts);
  if (charts.without_uv > 0)
    context.say(fmt::format("{} triangles have no uvs and keep none", charts.without_uv));
  if (charts.without_area > 0)
    context.say(fmt::format("{} charts have no area in uv or in space and shrink to a point",
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
  if (context.cancelled()) return Status::cancelled();  // a search gives what it has so far
  std::vector<Vec2d> uvs;
  if (Status s = write_file(c.output, to_obj(scene, charts, *fitted, uvs)); !s.ok()) return s;
  if (!c.preview.empty())
    if (Status s = draw(c.preview, charts, *fitted, uvs); !s.ok()) return s;
  return describe(*fitted);
}

}  // namespace atlas::app
