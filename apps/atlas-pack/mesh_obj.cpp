#include "apps/atlas-pack/mesh_obj.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "libatlas/core/counting_sort.h"
#include "libatlas/core/text_buffer.h"
#include "libatlas/scene/building/losses.h"
#include "libatlas/scene/obj/obj_names.h"
#include "libatlas/scene/uv_page.h"

namespace atlas::app {
namespace {

constexpr const char* kWithoutUv = "no_uv";

// Writes each uv once, where a face first uses it.
class UvLines {
 public:
  explicit UvLines(const RepackedMesh& mesh)
      : mesh_(mesh), numbers_(mesh.scene.texcoords.size(), 0) {}

  // Returns the number of a corner's uv on a page of this size; adds its line to `text` if it is
  // new.
  std::size_t number_of(std::size_t corner, Extent page, TextBuffer& text) {
    std::size_t& vt = numbers_[mesh_.charts.same[mesh_.scene.texcoord_indices[corner]]];
    if (vt != 0) return vt;
    const Vec2d uv = mesh_.uvs[corner];
    text.text("vt ");
    text.number(fraction(uv.x, page.width));
    text.character(' ');
    text.number(fraction(uv.y, page.height));
    text.character('\n');
    return vt = ++count_;
  }

 private:
  // Returns a fraction of eight digits. Charts are scaled to a billionth less than the page, so
  // that rounding cannot let them protrude, and a chart that fills its page would otherwise end at
  // 0.999999999. Uvs are read as floats, which have seven digits.
  static double fraction(double texels, std::int32_t side) {
    constexpr double kDigits = 1e8;
    return std::clamp(std::round(texels / side * kDigits) / kDigits, 0.0, 1.0);
  }

  const RepackedMesh& mesh_;
  std::vector<std::size_t> numbers_;  // 0: not written yet
  std::size_t count_ = 0;
};

// The triangles in the order of their charts' pages, and last those without uvs.
std::vector<std::uint32_t> triangles_by_page(const RepackedMesh& mesh) {
  const Buckets charts_of =
      sort_into_buckets(mesh.charts.members.size(), mesh.fit.pages.size(),
                        [&](std::size_t c) { return mesh.fit.placements[c].page; });
  std::vector<std::uint32_t> triangles;
  triangles.reserve(mesh.scene.triangle_count());
  for (const std::uint32_t c : charts_of.items)
    for (const std::uint32_t t : mesh.charts.members[c]) triangles.push_back(t);
  for (std::uint32_t t = 0; t < mesh.scene.triangle_count(); ++t)
    if (mesh.charts.chart[t] == UvCharts::kNone) triangles.push_back(t);
  return triangles;
}

// The faces, and the uvs that they use.
class FaceLines {
 public:
  explicit FaceLines(const RepackedMesh& mesh) : mesh_(mesh), uv_lines_(mesh) {}

  void begin_object(std::uint32_t object) {
    faces_.text(obj_object_line(mesh_.scene, object));
    page_ = kNothing;
  }

  void add(std::uint32_t triangle) {
    const Scene& s = mesh_.scene;
    const std::uint32_t chart = mesh_.charts.chart[triangle];
    const bool flat = chart != UvCharts::kNone;
    const std::uint32_t page = flat ? mesh_.fit.placements[chart].page : kNoPage;
    if (page != page_)
      faces_.text(fmt::format("usemtl {}\n", flat ? fmt::format("page_{}", page) : kWithoutUv));
    page_ = page;
    const std::size_t first = 3 * std::size_t(triangle);
    const auto has_normal = [&](std::size_t corner) {
      return !s.normal_indices.empty() && s.normal_indices[corner] != Scene::kNoNormal;
    };
    const bool normals = has_normal(first) && has_normal(first + 1) && has_normal(first + 2);
    faces_.character('f');
    for (std::size_t corner = first; corner < first + 3; ++corner) {
      faces_.character(' ');
      faces_.number(s.indices[corner] + 1);
      if (flat || normals) faces_.character('/');
      if (flat) faces_.number(uv_lines_.number_of(corner, mesh_.fit.pages[page], uvs_));
      if (!normals) continue;
      faces_.character('/');
      faces_.number(s.normal_indices[corner] + 1);
    }
    faces_.character('\n');
  }

  const std::string& uvs() const { return uvs_.bytes(); }
  const std::string& faces() const { return faces_.bytes(); }

 private:
  static constexpr std::uint32_t kNothing = kNoPage - 1;

  const RepackedMesh& mesh_;
  UvLines uv_lines_;
  TextBuffer uvs_, faces_;
  std::uint32_t page_ = kNothing;  // of the last face
};

}  // namespace

std::string to_obj(const RepackedMesh& mesh, const std::string& material_file) {
  const Scene& s = mesh.scene;
  TextBuffer text;
  text.text("# repacked by atlas-pack\n");
  // The shape of the textures, for readers and for libatlas itself.
  const std::vector<Extent>& pages = mesh.fit.pages;
  if (pages.size() == 1) text.text("# " + uv_page_text(pages[0].width, pages[0].height) + "\n");
  for (std::size_t page = 0; page < pages.size(); ++page) {
    const auto [width, height] = pages[page];
    text.text(fmt::format("# page_{}: {} x {} texels\n", page, width, height));
    if (pages.size() > 1) text.text("# " + uv_page_text(page, width, height) + "\n");
  }
  text.text(fmt::format("mtllib {}\n", material_file));
  for (const Vec3f& p : s.positions) {
    text.text("v ");
    text.position(s.origin, p);
    text.character('\n');
  }
  for (const Vec3f& normal : s.normals) {
    text.text("vn ");
    text.position({}, normal);
    text.character('\n');
  }
  const std::vector<std::uint32_t> triangles = triangles_by_page(mesh);
  const std::size_t objects = std::max<std::size_t>(1, s.object_names.size());
  const Buckets by_object = sort_into_buckets(triangles.size(), objects, [&](std::size_t i) {
    return s.triangle_object.empty() ? 0 : s.triangle_object[triangles[i]];
  });
  FaceLines lines(mesh);
  for (std::uint32_t object = 0; object < objects; ++object) {
    lines.begin_object(object);
    for (const std::uint32_t i : by_object[object]) lines.add(triangles[i]);
  }
  return text.bytes() + lines.uvs() + lines.faces();
}

std::string to_mtl(const UvCharts& charts, const FitResult& fit) {
  std::string text;
  for (std::size_t page = 0; page < fit.pages.size(); ++page)
    text += fmt::format("newmtl page_{}\nKd 1 1 1\n", page);
  if (charts.without_uv > 0) text += fmt::format("newmtl {}\nKd 1 1 1\n", kWithoutUv);
  return text;
}

std::vector<std::string> lost_in_obj(const Scene& scene) {
  Losses losses;
  losses.add(scene.not_read);
  const auto matters = [](const Material& m) {
    return !m.name.empty() || m.texture >= 0 || m.diffuse != Vec3f{1, 1, 1};
  };
  losses.add("materials (there is one a page instead)",
             std::size_t(std::count_if(scene.materials.begin(), scene.materials.end(), matters)));
  losses.add("colours of vertices", scene.illumination.size());
  return losses.lines();
}

}  // namespace atlas::app
