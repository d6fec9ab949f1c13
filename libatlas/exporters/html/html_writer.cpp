// A page of HTML that shows the world by itself. The viewer is in html/page.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <nlohmann/json.hpp>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "libatlas/core/bounds.h"
#include "libatlas/core/glm_bridge.h"
#include "libatlas/exporters/html/mesh_columns.h"
#include "libatlas/exporters/viewing/camera.h"
#include "libatlas/exporters/viewing/visitor.h"
#include "libatlas/exporters/world.h"
#include "libatlas/exporters/writing/page_sides.h"
#include "libatlas/exporters/writing/text_output.h"
#include "libatlas/exporters/writing/unify_vertices.h"
#include "libatlas/files/file_extension.h"
#include "libatlas/scene/files/file_bytes.h"
#include "viewer_page.h"  // cmake/AtlasEmbed.cmake

namespace atlas {
namespace fs = std::filesystem;
using nlohmann::json;
namespace {

constexpr int kFormat = 1;
constexpr std::string_view kLightType = "application/x-atlas-light";  // of write_light_page()
// Positions are whole steps: of a 65535th of the box, and where the visitor stands among the
// surfaces of a 64th of a millimetre. Steps of 0.1 mm move the outlines of lamps over so many
// pixels that these are four fifths of a picture's error (5 dB), and save 2 % of the bytes.
constexpr double kStepMetres = 1.0 / 65536, kStepsOfBox = 65535, kMostSteps = 1 << 24;
constexpr std::uint32_t kUvSteps = 65535;
// They need each other in this order.
constexpr std::string_view kScripts[] = {
    embedded::vectors_js,  embedded::data_js,  embedded::triangles_js, embedded::shaders_js,
    embedded::renderer_js, embedded::light_js, embedded::cameras_js,   embedded::input_js,
    embedded::panel_js,    embedded::views_js, embedded::measuring_js, embedded::main_js};

// Writes page.html piece by piece.
class Template {
 public:
  explicit Template(TextFile& file) : file_(file) {}
  // Writes what stands before the next mark, and leaves the mark out.
  void write_to(std::string_view mark) {
    const std::size_t at = rest_.find(mark);
    assert(at != std::string_view::npos);
    file_.write(rest_.substr(0, at));
    rest_.remove_prefix(at + mark.size());
  }
  void write_rest() { file_.write(rest_); }

 private:
  TextFile& file_;
  std::string_view rest_ = embedded::page_html;
};

// The page's coordinates are metres from the world's origin, and +Y is up.
glm::dvec3 in_page(const World& world, const glm::dvec3& p) {
  return world.metres_per_unit * (world.up == Up::z ? z_up_to_y_up(p) : p);
}

json list_of(const glm::dvec3& v) {
  return {v.x, v.y, v.z};
}

// Turns positions into whole steps within the box of all triangles.
class Steps {
 public:
  explicit Steps(const World& world) : world_(world) {
    for (const Page& page : world.pages)
      for (const std::uint32_t i : page.indices) box_.add(at(i));
    const glm::dvec3 size = box_.size();
    const double longest = std::max({size.x, size.y, size.z});
    step_ = longest / kStepsOfBox;
    if (world.viewpoint.inside)
      step_ = std::max(std::min(step_, kStepMetres), longest / kMostSteps);
    if (!(step_ > 0)) step_ = 1;
  }

  std::array<std::uint32_t, 3> steps(std::uint32_t position) const {
    const glm::dvec3 p = (at(position) - box_.low) / step_;
    return {std::uint32_t(std::lround(p.x)), std::uint32_t(std::lround(p.y)),
            std::uint32_t(std::lround(p.z))};
  }

  json low() const { return list_of(box_.low); }
  double step() const { return step_; }

 private:
  glm::dvec3 at(std::uint32_t i) const { return in_page(world_, to_dvec(world_.positions[i])); }

  const World& world_;
  Bounds<glm::dvec3> box_;
  double step_ = 1;
};

std::uint32_t uv_steps(float v) {
  return std::uint32_t(std::lround(std::clamp(double{v}, 0.0, 1.0) * kUvSteps));
}

// Returns the chart of each vertex of a part; vertices belong to one chart, because charts share no
// uv.
std::vector<std::uint32_t> charts_of(const Page& page, const UnifiedMesh<2>& mesh, bool one_sided) {
  std::vector<std::uint32_t> result(mesh.vertices.size());
  std::size_t k = 0;  // corner of the part
  for (std::size_t t = 0; t < page.charts.size(); ++t) {
    if (!page.one_sided.empty() && page.one_sided[t] != one_sided) continue;
    for (int c = 0; c < 3; ++c) result[mesh.indices[k++]] = page.charts[t];
  }
  return result;
}

// Collects the parts: the triangles of a page that are seen from the same sides.
class PartsWriter {
 public:
  explicit PartsWriter(const World& world) : world_(world), steps_(world) {}

  void add_page(std::size_t number, WorldFile& result) {
    const Page& page = world_.pages[number];
    const PageSides both(page);
    for (const PageSides::Side& side : both.sides()) {
      const auto mesh = unify_vertices<2>(side.indices.size(), [&](std::size_t k) {
        return std::array{side.indices[k], side.uv_indices[k]};
      });
      add_columns(mesh);
      append_differences(charts_of(page, mesh, side.one_sided), bytes_);
      append_indices(mesh.indices, bytes_);
      list_.push_back({{"page", number},
                       {"oneSided", side.one_sided},
                       {"vertices", mesh.vertices.size()},
                       {"triangles", mesh.indices.size() / 3}});
      result.triangles += mesh.indices.size() / 3;
      result.vertices += mesh.vertices.size();
      result.uvs += mesh.vertices.size();
    }
  }

  json list() { return std::move(list_); }
  json mesh() const {
    return {{"low", steps_.low()}, {"step", steps_.step()}, {"uvSteps", kUvSteps}};
  }
  const std::string& bytes() const { return bytes_; }

 private:
  void add_columns(const UnifiedMesh<2>& mesh) {
    std::array<std::vector<std::uint32_t>, 5> columns;
    for (auto& column : columns) column.reserve(mesh.vertices.size());
    for (const auto& [position, uv] : mesh.vertices) {
      const auto p = steps_.steps(position);
      for (std::size_t k = 0; k < 3; ++k) columns[k].push_back(p[k]);
      columns[3].push_back(uv_steps(world_.uvs[uv].x));
      columns[4].push_back(uv_steps(world_.uvs[uv].y));
    }
    for (const auto& column : columns) append_differences(column, bytes_);
  }

  const World& world_;
  const Steps steps_;
  json list_ = json::array();
  std::string bytes_;
};

json visitor_json(const World& world) {
  const Visitor visitor = visitor_of(world);
  const double unit = world.metres_per_unit;
  return {{"width", unit * visitor.width},
          {"height", unit * visitor.height},
          {"speed", unit * visitor.speed},
          {"outside", visitor.outside}};
}

json light_json(const PageLight& light) {
  json curves = json::array();
  for (const ShownCurve& curve : light.curves)
    curves.push_back({{"name", curve.name},
                      {"scale", curve.scale},
                      {"white", curve.white},
                      {"parameter", curve.parameter},
                      {"offset", curve.offset}});
  json reflectance = json::array();
  for (const Vec3f& r : light.reflectance) reflectance.push_back({r.x, r.y, r.z});
  return {{"quantity", light.quantity},
          {"curves", std::move(curves)},
          {"reflectance", std::move(reflectance)}};
}

json page_json(const World& world, const Page& page) {
  json entry = json::object();
  if (!page.image.empty()) {
    const bool webp = lower_extension(page.image) == ".webp";
    entry["type"] = world.light ? kLightType : webp ? "image/webp" : "image/png";
  }
  if (!page.error.empty()) {
    json cells = json::array();  // rounded: the page shows colours
    for (const float e : page.error) cells.push_back(e < 0 ? -1 : std::lround(10000 * e));
    entry["error"] = {{"columns", page.error_columns}, {"tenThousandths", std::move(cells)}};
  }
  return entry;
}

json world_json(const World& world) {
  const Viewpoint& view = world.viewpoint;
  json pages = json::array();
  for (const Page& page : world.pages) pages.push_back(page_json(world, page));
  json result = {{"format", kFormat},
                 {"title", world.title},
                 {"info", world.info},
                 {"origin", {world.origin.x, world.origin.y, world.origin.z}},
                 {"metresPerUnit", world.metres_per_unit},
                 {"up", world.up == Up::z ? "z" : "y"},
                 {"inside", view.inside},
                 {"visitor", visitor_json(world)},
                 {"pages", std::move(pages)}};
  const auto view_json = [&](const Viewpoint& v) {
    const glm::dvec3 ahead = glm::normalize(to_glm(v.direction));
    return json{{"position", list_of(in_page(world, to_glm(v.position)))},
                {"direction", list_of(world.up == Up::z ? z_up_to_y_up(ahead) : ahead)},
                {"fov", v.fov}};
  };
  result["start"] = view_json(view);
  json& further = result["viewpoints"] = json::array();
  for (const NamedViewpoint& v : world.further_viewpoints) {
    further.push_back(view_json(v.viewpoint));
    further.back()["name"] = v.name;
  }
  if (world.light) result["light"] = light_json(*world.light);
  return result;
}

// Returns text that may stand in an element of HTML.
std::string escaped(const std::string& text) {
  std::string result;
  for (const char c : text) {
    if (c == '&')
      result += "&amp;";
    else if (c == '<')
      result += "&lt;";
    else
      result += c;
  }
  return result;
}

// Writes bytes in base64 as a script that browsers do not run.
void write_data(TextFile& file, const std::string& id, std::string_view bytes) {
  file.write(fmt::format("<script type=\"text/plain\" id=\"{}\">", id));
  constexpr std::size_t kPiece = 3 << 20;  // a multiple of 3, so that the pieces join
  for (std::size_t i = 0; i < bytes.size(); i += kPiece)
    file.write(base64(bytes.substr(i, kPiece)));
  file.write("</script>\n");
}

Status write_images(TextFile& file, const World& world) {
  for (std::size_t i = 0; i < world.pages.size(); ++i) {
    const Page& page = world.pages[i];
    if (page.image.empty()) continue;
    const auto bytes = read_file_bytes(page.image_source);
    if (!bytes.ok() || bytes->size == 0)
      return {ErrorCode::io, fmt::format("the page's image {} cannot be read from '{}' to embed it "
                                         "(Page::image_source names where it lies)",
                                         page.image, page.image_source.string())};
    write_data(file, fmt::format("page{}", i), bytes->text());
  }
  return {};
}

}  // namespace

Result<WorldFile> write_html(const World& world, const fs::path& path, AtomicFiles& files,
                             const Context& context) {
  if (Status s = check_world(world); !s.ok()) return s;
  if (Status s = check_only_triangles(world); !s.ok()) return s;
  if (world.scene != nullptr)
    return Status(ErrorCode::bad_option, path.string() +
                                             ": a page of HTML shows pages of light, and cannot "
                                             "keep a scene (write .gltf, .glb or .obj)");
  WorldFile result;
  PartsWriter parts(world);
  for (std::size_t i = 0; i < world.pages.size(); ++i) {
    if (context.cancelled()) return Status::cancelled();
    parts.add_page(i, result);
    context.report("writing the world", double(i + 1) / double(world.pages.size()));
  }
  if (result.triangles == 0)
    return Status(ErrorCode::bad_input, path.string() + ": a page needs at least one triangle");
  json head = world_json(world);
  head["mesh"] = parts.mesh();
  head["parts"] = parts.list();
  const Result<std::string> mesh = deflated(parts.bytes());
  if (!mesh.ok()) return mesh.status();

  TextFile file(files.path_for(path), path, false);
  Template page(file);
  page.write_to("@title@");
  file.write(escaped(world.title));
  page.write_to("@style@");
  file.write(embedded::page_css);
  page.write_to("@data@");
  std::string text = head.dump(-1, ' ', true, json::error_handler_t::replace);
  // "</script" would end the element, and "<!--" begin a comment.
  for (std::size_t at = 0; (at = text.find('<', at)) != std::string::npos;)
    text.replace(at, 1, "\\u003c");
  file.write("<script type=\"application/json\" id=\"world\">" + text + "</script>\n");
  write_data(file, "mesh", *mesh);
  if (Status s = write_images(file, world); !s.ok()) return s;
  page.write_to("@script@");
  for (const std::string_view script : kScripts) file.write(script);
  page.write_rest();
  if (Status s = file.finish(); !s.ok()) return s;
  result.bytes = file.bytes();
  return result;
}

}  // namespace atlas
