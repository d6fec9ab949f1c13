// Unwraps a small mesh that the fuzzer makes up, and judges the atlas with the tests' own measures.
//
// Bytes 0 and 1 choose options, bytes 2 to 4 the kind of mesh, its size and how materials
// alternate. Vertices follow, then triangles as three bytes each.
#include <array>
#include <cmath>
#include <cstdint>
#include <string>
#include <vector>

#include "libatlas/pipeline/unwrap.h"
#include "tests/fuzz/fuzz_files.h"
#include "tests/support/atlas_measure.h"

namespace {

using atlas::Vec2f;
using atlas::Vec3f;
using atlas::test::require;

class Bytes {
 public:
  Bytes(const std::uint8_t* data, std::size_t size) : data_(data), left_(size) {}
  std::size_t left() const { return left_; }
  std::uint8_t byte() {
    if (left_ == 0) return 0;
    --left_;
    return *data_++;
  }
  // Of sixteen bits and an exponent: sizes differ by up to a billion.
  float wide_number() {
    const int number = int(byte() << 8 | byte()) - 32768;
    return std::ldexp(float(number), -int(byte() % 16));
  }

 private:
  const std::uint8_t* data_;
  std::size_t left_;
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

atlas::UnwrapOptions options_of(unsigned choice, unsigned more, const Mesh& mesh) {
  atlas::UnwrapOptions options;
  options.page_size = 256;
  // Pressing a hundred charts takes seconds.
  const bool press = more & 8 && mesh.indices.size() < 3 * 32;
  options.packing = press ? atlas::PackPreset::standard : atlas::PackPreset::fast;
  options.charts.preset = atlas::ChartPreset(choice % 3);
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

atlas::test::UvMesh as_measured(const Mesh& mesh, const atlas::UnwrappedMesh& flat) {
  atlas::test::UvMesh out;
  for (const Vec3f& p : mesh.positions) out.positions.push_back({p.x, p.y, p.z});
  for (const Vec2f& uv : flat.uvs) out.uvs.push_back({uv.x, uv.y});
  for (std::size_t t = 0; t < flat.triangle_page.size(); ++t) {
    atlas::test::UvMesh::Face face;
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

void judge(const Mesh& mesh, const atlas::UnwrappedMesh& flat, const atlas::ChartOptions& options) {
  require(flat.indices.size() == mesh.indices.size(), "triangles were lost");
  require(!flat.pages.empty(), "no page");
  for (const Vec2f& uv : flat.uvs)
    require(uv.x >= 0 && uv.x <= 1 && uv.y >= 0 && uv.y <= 1, "a uv outside its page");
  const auto measured = atlas::test::measure_atlas(as_measured(mesh, flat), flat.pages[0].width,
                                                   flat.pages[0].height);
  require(measured.overlap <= flat.texels_drawn_twice,
          "overlap: " + std::to_string(measured.overlap) + " texels, reported " +
              std::to_string(flat.texels_drawn_twice));
  // Triangles without area are lines on the page, which the measure takes for charts of their own.
  require(measured.bleed == 0 || flat.charts.repairs.degenerate_triangles > 0,
          "bleed: " + std::to_string(measured.bleed));
  require(measured.mirrored <= flat.charts.flipped_triangles.size(),
          "mirrored: " + std::to_string(measured.mirrored));
  const double cone = options.cone_degrees > 0 ? options.cone_degrees : 180;
  for (const atlas::Chart& chart : flat.charts.charts) {
    require(chart.kept || chart.distortion.stretch_999 <= options.max_stretch * (1 + 1e-6),
            "stretch: " + std::to_string(chart.distortion.stretch_999));
    require(chart.cone_degrees <= cone + 1e-3, "cone: " + std::to_string(chart.cone_degrees));
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size < 8) return -1;
  Bytes bytes(data, size);
  const unsigned choice = bytes.byte(), more = bytes.byte();
  const Mesh mesh = mesh_of(bytes, more);
  if (mesh.indices.empty()) return -1;
  const atlas::UnwrapOptions options = options_of(choice, more, mesh);
  atlas::Context context;
  context.threads = 1;  // one thread, so that a finding repeats
  atlas::MeshView view;
  view.positions = mesh.positions;
  view.indices = mesh.indices;
  view.texcoords = mesh.texcoords;
  view.materials = mesh.materials;
  view.density = mesh.density;
  const auto flat = atlas::unwrap_mesh(view, options, context);
  if (flat.ok()) {
    judge(mesh, *flat, options.charts);
  } else {
    require(flat.status().code() == atlas::ErrorCode::no_solution ||
                flat.status().code() == atlas::ErrorCode::bad_input,
            "refused: " + flat.status().message());
  }
  return 0;
}
