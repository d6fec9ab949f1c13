// Checks the measures against closed forms, and against the shared measuring program if it can be
// compiled.
#include "tests/support/atlas_measure.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <string>

#include "tests/support/program_output.h"
#include "tests/support/shapes.h"
#include "tests/support/shared_data.h"
#include "tests/support/temp_folder.h"

namespace atlas::test {
namespace {

namespace fs = std::filesystem;

// (x, y) to (a x + b, c y + d).
struct UvMap {
  double a, b, c, d;
};

// Returns a mesh whose uvs are its x and y, mapped.
UvMesh flat_mesh(const Shape& shape, const UvMap& map) {
  UvMesh mesh;
  for (const Vec3f& p : shape.positions) {
    mesh.positions.push_back({p.x, p.y, p.z});
    mesh.uvs.push_back({map.a * p.x + map.b, map.c * p.y + map.d});
  }
  for (std::size_t t = 0; t < shape.indices.size(); t += 3) {
    const std::array<std::uint32_t, 3> v{shape.indices[t], shape.indices[t + 1],
                                         shape.indices[t + 2]};
    mesh.faces.push_back({v, v, 0});
  }
  return mesh;
}

void append(UvMesh& mesh, const UvMesh& other) {
  const auto p = std::uint32_t(mesh.positions.size()), t = std::uint32_t(mesh.uvs.size());
  mesh.positions.insert(mesh.positions.end(), other.positions.begin(), other.positions.end());
  mesh.uvs.insert(mesh.uvs.end(), other.uvs.begin(), other.uvs.end());
  for (UvMesh::Face face : other.faces) {
    for (int k = 0; k < 3; ++k) {
      face.position[k] += p;
      face.uv[k] += t;
    }
    mesh.faces.push_back(face);
  }
}

TEST(AtlasMeasure, AnIsometryIsPerfect) {
  const AtlasMeasures m = measure_atlas(flat_mesh(grid(8, 8), {0.5, 0.25, 0.5, 0.25}), 64, 64);
  EXPECT_EQ(m.triangles, 128u);
  EXPECT_EQ(m.charts, 1u);
  EXPECT_NEAR(m.scale, 32, 1e-9);
  EXPECT_NEAR(m.stretch_l2, 1, 1e-12);
  EXPECT_NEAR(m.stretch_999, 1, 1e-12);
  EXPECT_NEAR(m.conformal_mean, 1, 1e-12);
  EXPECT_NEAR(m.dirichlet_mean, 1, 1e-12);
  EXPECT_NEAR(m.utilization, 0.25, 1e-12);
  EXPECT_NEAR(m.covered, 0.25, 1e-12);
  EXPECT_EQ(m.flipped + m.mirrored + m.degenerate + m.outside + m.overlap + m.bleed, 0u);
  EXPECT_EQ(m.seam, 0);
}

TEST(AtlasMeasure, AnAnisotropicMapHasItsClosedForm) {
  // With uv = (x k, y / k), the singular values from uv to the surface are k and 1/k at the
  // area-preserving scale.
  const double k = 1.25;
  const AtlasMeasures m =
      measure_atlas(flat_mesh(grid(5, 7), {0.5 * k, 0.1, 0.5 / k, 0.1}), 128, 128);
  EXPECT_NEAR(m.stretch_l2, std::sqrt((k * k + 1 / (k * k)) / 2), 1e-9);
  EXPECT_NEAR(m.stretch_linf, k, 1e-9);
  EXPECT_NEAR(m.conformal_mean, k * k, 1e-9);
  EXPECT_NEAR(m.conformal_max, k * k, 1e-9);
  EXPECT_NEAR(m.dirichlet_mean, (k * k + 1 / (k * k)) / 2, 1e-9);
}

TEST(AtlasMeasure, AMirroredChartAndAFlippedTriangleAreSeen) {
  EXPECT_EQ(measure_atlas(flat_mesh(grid(3, 3), {-0.5, 0.9, 0.5, 0.1}), 32, 32).mirrored, 1u);
  UvMesh mesh = flat_mesh(grid(3, 3), {0.5, 0.1, 0.5, 0.1});
  mesh.uvs[0] = {0.9, 0.9};  // the triangles of that corner flip and cover others
  const AtlasMeasures m = measure_atlas(mesh, 64, 64);
  EXPECT_GE(m.flipped, 1u);
  EXPECT_GT(m.overlap, 0u);
}

TEST(AtlasMeasure, OverlapCountsEveryTexelOnce) {
  UvMesh mesh = flat_mesh(grid(1, 1), {0.5, 0, 0.5, 0});
  append(mesh, flat_mesh(moved(grid(1, 1), 1, {3, 0, 0}), {0.5, -1.25, 0.5, 0.25}));
  // [0, 1/2]² and [1/4, 3/4] x [1/4, 3/4] share a quarter of 1/4.
  const AtlasMeasures m = measure_atlas(mesh, 64, 64);
  EXPECT_EQ(m.charts, 2u);
  EXPECT_EQ(m.overlap, 16u * 16u);
  EXPECT_EQ(m.bleed, 18u * 18u);
}

TEST(AtlasMeasure, BleedBeginsWithinOneTexel) {
  for (const int gap : {0, 1, 2, 3}) {
    // Two squares of 8 texels are `gap` texels apart, with their edges on texel borders.
    UvMesh mesh = flat_mesh(grid(1, 1), {8 / 64.0, 8 / 64.0, 8 / 64.0, 8 / 64.0});
    append(mesh, flat_mesh(moved(grid(1, 1), 1, {4, 0, 0}),
                           {8 / 64.0, (16 + gap - 32) / 64.0, 8 / 64.0, 8 / 64.0}));
    const AtlasMeasures m = measure_atlas(mesh, 64, 64);
    EXPECT_EQ(m.overlap, 0u);
    // Lookups read one texel beyond each square. The columns that both read are 10 texels high.
    EXPECT_EQ(m.bleed, std::uint64_t(std::max(0, 2 - gap)) * 10) << "gap " << gap;
  }
}

TEST(AtlasMeasure, SeamIsTheLengthOfCutEdges) {
  UvMesh mesh = flat_mesh(grid(1, 1), {0.25, 0, 0.25, 0});
  append(mesh, flat_mesh(moved(grid(1, 1), 1, {1, 0, 0}), {0.25, 0.25, 0.25, 0}));
  // One edge of length 1 lies between them. Its positions are shared, its texture coordinates are
  // not.
  const AtlasMeasures m = measure_atlas(mesh, 64, 64);
  EXPECT_EQ(m.charts, 2u);
  EXPECT_NEAR(m.seam, 1 / std::sqrt(2.0), 1e-12);
}

TEST(AtlasMeasure, DegenerateAndOutsideAreCounted) {
  UvMesh mesh = flat_mesh(grid(1, 1), {0.5, 0, 0.5, 0});
  append(mesh, flat_mesh(moved(grid(1, 1), 1, {5, 0, 0}), {0, 0.75, 0.1, 0.5}));
  append(mesh, flat_mesh(moved(grid(1, 1), 1, {9, 0, 0}), {0.5, -3.5, 0.1, 0.75}));
  const AtlasMeasures m = measure_atlas(mesh, 64, 64);
  EXPECT_EQ(m.degenerate, 2u);
  EXPECT_EQ(m.outside, 2u);
}

// Writes an OBJ of a torus on two pages, with charts that are mirrored, overlap or are too close.
void write_hard_atlas(const fs::path& path) {
  const Shape shape = torus(24, 12);
  std::ofstream out(path);
  for (const Vec3f& p : shape.positions) out << "v " << p.x << " " << p.y << " " << p.z << "\n";
  for (std::size_t t = 0; t < shape.indices.size(); ++t) {
    const Vec3f p = shape.positions[shape.indices[t]];
    const bool top = t / 6 % 12 < 6, mirrored = t / 6 % 24 < 3;
    const double u = 0.26 + 0.16 * (mirrored ? -p.x : p.x), v = 0.26 + 0.16 * p.y;
    out << "vt " << (top ? u : u + 0.4671) << " " << v * 0.999 << "\n";
  }
  for (std::size_t t = 0; t < shape.indices.size(); t += 3) {
    out << (t / 3 % 5 == 0 ? "usemtl a\n" : "usemtl b\n") << "f";
    for (int k = 0; k < 3; ++k) out << " " << shape.indices[t + k] + 1 << "/" << t + k + 1;
    out << "\n";
  }
}

TEST(AtlasMeasure, AgreesWithTheSharedMeasuringProgram) {
  const auto shared = shared_data("../tools/atlaseval.cpp");
  if (!shared) GTEST_SKIP() << lacks("a shared program beside it to compare with");
  const fs::path source = *shared;
  const TempFolder folder;
  const std::string program = (folder / "atlaseval").string(), obj = (folder / "hard.obj").string();
  write_hard_atlas(obj);
  output_of("c++ -O1 -std=c++17 -w -o " + program + " " + source.string());
  const std::string json = output_of(program + " " + obj + " --res 160 96 --bleed");
  ASSERT_FALSE(json.empty());
  const auto mesh = read_uv_obj(obj);
  ASSERT_TRUE(mesh.ok()) << mesh.status().message();
  const AtlasMeasures m = measure_atlas(*mesh, 160, 96);
  const auto same = [&](const char* name, double ours, double tolerance) {
    EXPECT_NEAR(ours, json_field(json, name), tolerance * (1 + std::abs(ours))) << name;
  };
  same("tris", double(m.triangles), 0);
  same("charts", double(m.charts), 0);
  same("pages", double(m.pages), 0);
  same("util", m.utilization, 1e-4);
  same("covered", m.covered, 1e-4);
  same("scale", m.scale, 1e-5);
  same("L2", m.stretch_l2, 1e-4);
  same("Linf", m.stretch_linf, 1e-2);
  same("Linf999", m.stretch_999, 1e-3);
  same("qc_mean", m.conformal_mean, 1e-4);
  same("sd_mean", m.dirichlet_mean, 1e-4);
  same("flipped", double(m.flipped), 0);
  same("mirrored", double(m.mirrored), 0);
  same("degenerate", double(m.degenerate), 0);
  same("outside", double(m.outside), 0);
  same("overlap", double(m.overlap), 0);
  same("bleed", double(m.bleed), 0);
  same("seam", m.seam, 1e-3);
}

}  // namespace
}  // namespace atlas::test
