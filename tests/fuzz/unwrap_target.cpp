#include <algorithm>
#include <cmath>
#include <limits>
#include <span>
#include <vector>

#include "libatlas/unwrap/atlas.h"
#include "tests/fuzz/effort.h"
#include "tests/fuzz/targets.h"
#include "tests/support/atlas_measure.h"

namespace atlas::test {
namespace {

class Bytes {
 public:
  explicit Bytes(FuzzBytes bytes) : bytes_(bytes) {}
  std::size_t left() const { return bytes_.size(); }
  std::uint8_t byte() {
    if (bytes_.empty()) return 0;
    const std::uint8_t first = bytes_.front();
    bytes_ = bytes_.subspan(1);
    return first;
  }
  // Of sixteen bits and an exponent: sizes differ by up to a billion.
  float wide_number() {
    const int high = byte(), low = byte();
    return std::ldexp(float(256 * high + low - 32768), -int(byte() % 16));
  }

 private:
  FuzzBytes bytes_;
};

struct Mesh {
  std::vector<Vec3f> positions;
  std::vector<std::uint32_t> indices, materials;
  std::vector<Vec2f> texcoords;
  std::vector<float> density;
};

// A height field: a regular surface that is folded and spiky at will, with uvs that are nearly so.
void add_height_field(Bytes& bytes, std::uint32_t side, bool with_uvs, Mesh& mesh) {
  for (std::uint32_t y = 0; y < side; ++y) {
    for (std::uint32_t x = 0; x < side; ++x) {
      mesh.positions.push_back({float(x), float(y), float(bytes.byte()) / 32});
      if (!with_uvs) continue;
      const int off = bytes.byte();
      mesh.texcoords.push_back(
          {float(x) / 12 + float(off % 16) / 64, float(y) / 12 + float(off) / 1024});
    }
  }
  for (std::uint32_t y = 0; y + 1 < side; ++y) {
    for (std::uint32_t x = 0; x + 1 < side; ++x) {
      const std::uint32_t a = y * side + x, b = a + 1, c = a + side, d = c + 1;
      mesh.indices.insert(mesh.indices.end(), {a, b, d, a, d, c});
    }
  }
}

// Any triangles between any vertices, with any uvs: what no modeller would make.
void add_soup(Bytes& bytes, std::uint32_t count, bool wide, Mesh& mesh) {
  const auto coordinate = [&] {
    return wide ? bytes.wide_number() : float(int(bytes.byte()) - 128);
  };
  for (std::uint32_t i = 0; i < count; ++i) {
    const float x = coordinate(), y = coordinate(), z = coordinate();
    mesh.positions.push_back({x, y, z});
    const int at = bytes.byte();
    mesh.texcoords.push_back({float(at % 16) / 8, float(at / 16) / 8});
  }
  while (bytes.left() > 0 && mesh.indices.size() < 3 * 400) {
    for (int k = 0; k < 3; ++k) mesh.indices.push_back(bytes.byte() % count);
  }
}

Mesh mesh_of(Bytes& bytes, unsigned more) {
  const unsigned kind = bytes.byte() % 3, count = bytes.byte(), period = 1 + bytes.byte() % 7;
  Mesh mesh;
  if (kind == 0) {
    add_height_field(bytes, 2 + count % 12, more & 1, mesh);
  } else {
    add_soup(bytes, 3 + count % 60, kind == 2, mesh);
  }
  for (std::size_t t = 0; t < mesh.indices.size() / 3; ++t) {
    if (more & 2) mesh.materials.push_back(std::uint32_t(t / period % 3));
    if (more & 4) mesh.density.push_back(t / period % 2 ? 1.f : 0.25f);
  }
  return mesh;
}

UnwrapOptions options_of(unsigned choice, unsigned more, const Mesh& mesh) {
  UnwrapOptions options;
  options.page_size = 256;
  // Pressing a hundred charts takes seconds.
  const bool press = more & 8 && mesh.indices.size() < 3 * 32;
  options.preset = press ? PackPreset::standard : PackPreset::fast;
  options.charts.preset = ChartPreset(choice % 3);
  options.charts.keep_uv_charts = more & 1;
  options.charts.split_at_materials = !(more & 16);
  if (options.charts.keep_uv_charts) options.charts.min_fill = 0;
  if (choice & 4) options.charts.cone_degrees = 40;
  if (choice & 8) options.charts.max_stretch = 1.02;
  options.part_gaps = choice & 16;
  if (choice & 32) options.mip_levels = 2;
  options.allow_rotation = !(choice & 64);
  options.square = choice & 128;
  return options;
}

UvMesh as_measured(const Mesh& mesh, const UnwrappedMesh& flat) {
  UvMesh out;
  for (const Vec3f& p : mesh.positions) out.positions.push_back({p.x, p.y, p.z});
  for (const Vec2f& uv : flat.uvs) out.uvs.push_back({uv.x, uv.y});
  for (std::size_t t = 0; t < flat.triangle_page.size(); ++t) {
    UvMesh::Face face;
    for (std::size_t k = 0; k < 3; ++k) {
      face.position[k] = mesh.indices[3 * t + k];
      face.uv[k] = flat.indices[3 * t + k];
    }
    face.page = flat.triangle_page[t];
    out.faces.push_back(face);
  }
  out.pages = std::uint32_t(flat.pages.size());
  return out;
}

std::string judge(const Mesh& mesh, const UnwrappedMesh& flat, const ChartOptions& options) {
  if (flat.indices.size() != mesh.indices.size()) return "triangles were lost";
  if (flat.pages.empty()) return "no page";
  for (const Vec2f& uv : flat.uvs)
    if (!(uv.x >= 0 && uv.x <= 1 && uv.y >= 0 && uv.y <= 1)) return "a uv outside its page";
  const AtlasMeasures measured =
      measure_atlas(as_measured(mesh, flat), flat.pages[0].width, flat.pages[0].height);
  if (measured.overlap > flat.texels_drawn_twice)
    return "overlap: " + std::to_string(measured.overlap) + " texels, reported " +
           std::to_string(flat.texels_drawn_twice);
  // Triangles without area are lines on the page, which the measure takes for charts of their own.
  if (measured.bleed > 0 && flat.charts.repairs.degenerate_triangles == 0)
    return "bleed: " + std::to_string(measured.bleed) + " texels";
  if (measured.mirrored > flat.charts.flipped_triangles.size())
    return "mirrored charts: " + std::to_string(measured.mirrored);
  const double cone = options.cone_degrees > 0 ? options.cone_degrees : 180;
  for (const Chart& chart : flat.charts.charts) {
    if (!chart.kept && chart.distortion.stretch_999 > options.max_stretch * (1 + 1e-6))
      return "stretch: " + std::to_string(chart.distortion.stretch_999);
    if (chart.cone_degrees > cone + 1e-3) return "cone: " + std::to_string(chart.cone_degrees);
  }
  return {};
}

// The indices as polygons of three to eight corners, with what is said of their triangles.
struct Polygons {
  std::vector<std::uint32_t> sizes, materials;
  std::vector<float> density;
};

Polygons polygons_of(const Mesh& mesh) {
  Polygons out;
  for (std::size_t at = 0; at < mesh.indices.size();) {
    const std::size_t left = mesh.indices.size() - at;
    std::size_t size = 3 + (mesh.indices[at] + out.sizes.size()) % 6;
    if (left < size + 3) size = left;
    if (!mesh.materials.empty()) out.materials.push_back(mesh.materials[at / 3]);
    if (!mesh.density.empty()) out.density.push_back(mesh.density[at / 3]);
    out.sizes.push_back(std::uint32_t(size));
    at += size;
  }
  return out;
}

// Each corner has its own vertex, and all triangles of a whole polygon have its corners.
std::string judge_polygons(const Mesh& mesh, const Polygons& polygons,
                           const UnwrappedAtlas::Mesh& flat) {
  if (flat.polygon_corners.size() != mesh.indices.size()) return "corners were lost";
  for (std::size_t i = 0; i < mesh.indices.size(); ++i)
    if (flat.vertices[flat.polygon_corners[i]] != mesh.indices[i]) return "a corner's other vertex";
  std::size_t triangle = 0, first = 0;
  for (std::uint32_t p = 0; p < polygons.sizes.size(); ++p) {
    const auto corners = flat.polygon_corners.subspan(first, polygons.sizes[p]);
    bool whole = true;
    for (std::size_t i = 3 * triangle; i < 3 * (triangle + corners.size() - 2); ++i)
      whole = whole && std::find(corners.begin(), corners.end(), flat.indices[i]) != corners.end();
    const bool named = std::ranges::binary_search(flat.cut_polygons, p);
    if (!whole && !named) return "a polygon that is cut but not named";
    first += corners.size();
    triangle += corners.size() - 2;
  }
  return triangle == flat.triangle_page.size() ? "" : "triangles were lost";
}

FuzzResult fuzz_polygons(const Mesh& mesh, const UnwrapOptions& options, const Context& context) {
  const Polygons polygons = polygons_of(mesh);
  StridedMesh view{.positions = {mesh.positions.data(), mesh.positions.size(), 0},
                   .indices = {mesh.indices.data(), mesh.indices.size(), 4},
                   .texcoords = {mesh.texcoords.data(), mesh.texcoords.size(), 0},
                   .materials = polygons.materials,
                   .density = polygons.density,
                   .polygon_sizes = polygons.sizes};
  Atlas atlas;
  if (const auto added = atlas.add(view); !added.ok())
    return {"polygons refused: " + added.status().message()};
  const Result<UnwrappedAtlas> flat = atlas.unwrap(options, context);
  if (!flat.ok()) {
    const bool too_small = flat.status().code() == ErrorCode::no_solution;
    return {too_small ? "" : "refused: " + flat.status().message()};
  }
  if (std::string fault = judge_polygons(mesh, polygons, flat->mesh(0)); !fault.empty())
    return {fault, true};
  Mesh triangles = mesh;
  triangles.indices.clear();
  for (const std::uint32_t v : flat->mesh(0).indices)
    triangles.indices.push_back(flat->mesh(0).vertices[v]);
  return {judge(triangles, flat->all(), options.charts), true};
}

// Instances lie on the page, apart from each other.
std::string judge_instances(std::span<const MeshInstance> instances, std::size_t count,
                            const std::vector<Extent>& pages) {
  if (instances.size() != count) return "instances were lost";
  for (std::size_t i = 0; i < count; ++i) {
    const MeshInstance& a = instances[i];
    const Vec2f end{a.offset.x + a.scale.x, a.offset.y + a.scale.y};
    if (a.page >= pages.size() || !(a.scale.x > 0 && a.scale.y > 0) ||
        !(a.offset.x >= 0 && a.offset.y >= 0 && end.x <= 1 + 1e-6f && end.y <= 1 + 1e-6f))
      return "an instance outside its page";
    for (std::size_t k = 0; k < i; ++k) {
      const MeshInstance& b = instances[k];
      const auto shared = [&](float from, float to, float first, float last) {
        return std::min(to, last) - std::max(from, first) > 1e-6f;
      };
      if (a.page == b.page && shared(a.offset.x, end.x, b.offset.x, b.offset.x + b.scale.x) &&
          shared(a.offset.y, end.y, b.offset.y, b.offset.y + b.scale.y))
        return "two instances overlap";
    }
  }
  return {};
}

// What `choice` says in place of bytes, which other input has used up: up to six instances with
// densities of which some are none.
FuzzResult fuzz_instances(const MeshView& view, unsigned choice, const UnwrapOptions& options,
                          const Context& context) {
  const float values[] = {1,
                          0.25f,
                          4,
                          1e-30f,
                          0,
                          -1,
                          std::numeric_limits<float>::quiet_NaN(),
                          std::numeric_limits<float>::infinity()};
  std::vector<float> densities(choice % 7);
  for (std::size_t i = 0; i < densities.size(); ++i)
    densities[i] = values[(choice >> i) % (choice & 8 ? 8 : 3)];
  const bool valid = !densities.empty() && std::ranges::all_of(densities, [](float d) {
    return std::isfinite(d) && d > 0;
  });
  Atlas atlas;
  const auto added = atlas.add_instances(view, densities.size(), densities);
  if (added.ok() != valid) return {"densities taken wrongly: " + added.status().message()};
  if (!valid) return {"", atlas.mesh_count() == 0};
  const Result<UnwrappedAtlas> flat = atlas.unwrap(options, context);
  if (!flat.ok()) {
    const bool too_small = flat.status().code() == ErrorCode::no_solution;
    return {too_small ? "" : "refused: " + flat.status().message()};
  }
  return {judge_instances(flat->mesh(0).instances, densities.size(), flat->all().pages), true};
}

}  // namespace

FuzzResult fuzz_unwrap(FuzzBytes data) {
  if (data.size() < 8) return {};
  Bytes bytes(data);
  const unsigned choice = bytes.byte(), more = bytes.byte();
  const Mesh mesh = mesh_of(bytes, more);
  if (mesh.indices.empty()) return {};
  const UnwrapOptions options = options_of(choice, more, mesh);
  MeshView view;
  view.positions = mesh.positions;
  view.indices = mesh.indices;
  view.texcoords = mesh.texcoords;
  if (!mesh.texcoords.empty()) view.texcoord_indices = mesh.indices;
  view.materials = mesh.materials;
  view.density = mesh.density;
  Context context;
  context.threads = 1;
  if (more & 32) return fuzz_polygons(mesh, options, context);
  if (more & 64) return fuzz_instances(view, choice, options, context);
  const Effort effort;  // of charts alone: packing has other bounds
  const Result<ChartSet> charts = make_charts(view, options.charts, context);
  if (std::string much = effort.fault(mesh.indices.size() / 3); !much.empty()) return {much};
  if (!charts.ok()) return {"no charts: " + charts.status().message()};
  const Result<UnwrappedMesh> flat = unwrap_mesh(view, options, context);
  if (flat.ok()) return {judge(mesh, *flat, options.charts), true};
  // The mesh and the options are valid; only the page may be too small.
  const bool too_small = flat.status().code() == ErrorCode::no_solution;
  return {too_small ? "" : "refused: " + flat.status().message()};
}

}  // namespace atlas::test
