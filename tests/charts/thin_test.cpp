// Triangles without area, such as close T-junctions: the surface goes on through them.
#include "libatlas/charts/mesh/thin.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <map>
#include <set>
#include <utility>

#include "libatlas/core/glm_bridge.h"
#include "tests/charts/chart_checks.h"

namespace atlas::test {
namespace {

std::uint32_t add_vertex(Mesh& mesh, const Vec3f& p) {
  mesh.positions.push_back(p);
  return static_cast<std::uint32_t>(mesh.positions.size() - 1);
}

void add_triangle(Mesh& mesh, std::uint32_t a, std::uint32_t b, std::uint32_t c) {
  for (const std::uint32_t v : {a, b, c}) mesh.indices.push_back(v);
}

// Divides one of the two triangles at every `every`-th edge inside the mesh in its middle, and
// closes the T-junction by a triangle of the edge's three vertices. No triangle is changed twice.
// Returns the number of closing triangles.
std::size_t add_caps(Mesh& mesh, std::size_t every) {
  std::map<std::pair<std::uint32_t, std::uint32_t>, std::uint32_t> edges;
  for (std::uint32_t h = 0; h < mesh.indices.size(); ++h)
    edges[{mesh.indices[h], mesh.indices[next_half_edge(h)]}] = h;
  std::set<std::uint32_t> changed;
  std::size_t caps = 0, seen = 0;
  for (const auto& [ends, h] : edges) {
    const auto across = edges.find({ends.second, ends.first});
    if (across == edges.end() || changed.contains(h / 3) || changed.contains(across->second / 3))
      continue;
    if (seen++ % every != 0) continue;
    const auto [a, b] = ends;
    const std::uint32_t o = across->second, e = mesh.indices[previous_half_edge(o)];
    const Vec3f &p = mesh.positions[a], &q = mesh.positions[b];
    const std::uint32_t m =
        add_vertex(mesh, {0.5f * (p.x + q.x), 0.5f * (p.y + q.y), 0.5f * (p.z + q.z)});
    const std::uint32_t first = o - o % 3;
    mesh.indices[first] = b, mesh.indices[first + 1] = m, mesh.indices[first + 2] = e;
    add_triangle(mesh, m, a, e);
    add_triangle(mesh, b, a, m);
    changed.insert({h / 3, o / 3});
    ++caps;
  }
  return caps;
}

// Rows of a sheet whose edges have different numbers of vertices. Where rows meet, hanging vertices
// are closed by triangles without area.
Mesh rows_with_caps(const std::vector<int>& parts, const std::function<Vec3f(double, double)>& at) {
  Mesh mesh;
  for (std::size_t row = 0; row < parts.size(); ++row) {
    // This row's lower edge, and between its vertices those of the row below.
    const int n = parts[row];
    std::vector<std::uint32_t> low, high;
    for (int i = 0; i <= n; ++i) {
      low.push_back(add_vertex(mesh, at(double(i) / n, double(row))));
      high.push_back(add_vertex(mesh, at(double(i) / n, double(row) + 1)));
    }
    for (int i = 0; i < n; ++i) {
      add_triangle(mesh, low[i], low[i + 1], high[i + 1]);
      add_triangle(mesh, low[i], high[i + 1], high[i]);
    }
    if (row == 0) continue;
    // The row below has `k` times as many parts, or an nth of them.
    const int below = parts[row - 1], k = std::max(n, below) / std::min(n, below);
    const int fine = std::max(n, below);
    const auto vertex = [&](int i) { return add_vertex(mesh, at(double(i) / fine, double(row))); };
    for (int i = 0; i < std::min(n, below); ++i) {
      for (int j = 1; j < k; ++j) {
        // A fan of triangles along the long edge.
        const std::uint32_t a = vertex(i * k), b = vertex(i * k + j), c = vertex(i * k + j + 1);
        n > below ? add_triangle(mesh, a, c, b) : add_triangle(mesh, a, b, c);
      }
    }
  }
  return mesh;
}

// The largest difference between a length in uv and on the sheet, over all pairs of corners that
// `flat` lays into the plane.
double misfit(const ChartSet& set, const std::function<Vec2d(const Vec3f&)>& flat,
              const Mesh& mesh) {
  double most = 0;
  for (std::size_t i = 0; i < set.uvs.size(); i += 7) {
    for (std::size_t j = 0; j < i; j += 5) {
      const Vec2d p = flat(mesh.positions[set.uv_vertex[i]]);
      const Vec2d q = flat(mesh.positions[set.uv_vertex[j]]);
      most = std::max(most, std::abs(std::hypot(p.x - q.x, p.y - q.y) -
                                     glm::distance(to_glm(set.uvs[i]), to_glm(set.uvs[j]))));
    }
  }
  return most;
}

TEST(Thin, AFlatSheetWithTJunctionsIsOneChart) {
  const Mesh mesh = rows_with_caps({4, 8, 4, 16, 2, 20, 10, 1, 9}, [](double u, double v) {
    return Vec3f{float(8 * u), float(v), 0};
  });
  const ChartSet set = checked_charts(mesh);
  ASSERT_EQ(set.charts.size(), 1u);
  EXPECT_EQ(set.repairs.degenerate_triangles, 4u + 4 + 12 + 14 + 18 + 10 + 9 + 8);
  EXPECT_EQ(set.seam_length, 0);
  EXPECT_NEAR(set.distortion.stretch_linf, 1, 1e-4);
  const auto flat = [](const Vec3f& p) { return Vec2d{p.x, p.y}; };
  EXPECT_LT(misfit(set, flat, mesh), 1e-5);
}

TEST(Thin, AHalfCylinderWithTJunctionsUnrolls) {
  const Mesh mesh =
      rows_with_caps({6, 3, 12, 4, 4, 2, 8, 1, 5, 10, 10, 2, 6, 6, 3, 3}, [](double u, double v) {
        const double a = M_PI * v / 16;
        return Vec3f{float(4 * std::cos(a)), float(4 * std::sin(a)), float(10 * u)};
      });
  const ChartSet set = checked_charts(mesh);
  ASSERT_EQ(set.charts.size(), 1u);
  EXPECT_LT(set.distortion.stretch_999, 1.001);
  const double facet = 8 * std::sin(M_PI / 32);
  const auto flat = [&](const Vec3f& p) {
    return Vec2d{facet * 16 / M_PI * std::atan2(p.y, p.x), p.z};
  };
  EXPECT_LT(misfit(set, flat, mesh), 1e-3);
}

// The sheet in many directions: rounding moves the hanging vertices off their edges, to either
// side, so that the closing triangles have some area and any normal.
TEST(Thin, RoundingOfHangingVerticesCostsNoCharts) {
  for (const double turn : {0.1, 0.7, 1.9, 2.6}) {
    const glm::dvec3 u = glm::normalize(glm::dvec3(std::cos(turn), std::sin(turn), 0.3));
    const glm::dvec3 w = glm::normalize(glm::cross(u, glm::dvec3(0.2, turn, 1)));
    const Mesh mesh = rows_with_caps({4, 8, 4, 16, 2, 20, 10, 1, 9}, [&](double a, double b) {
      return from_glm(glm::vec3(8 * a * u + b * w));
    });
    const ChartSet set = checked_charts(mesh);
    EXPECT_EQ(set.charts.size(), 1u) << turn;
    EXPECT_LT(set.distortion.stretch_999, 1.001) << turn;
  }
}

// Curved surfaces come out as they do without T-junctions, or in little more.
TEST(Thin, CurvedSurfacesKeepTheirCharts) {
  for (const Shape& shape : {sphere(24, 48), torus(48, 32), box(6)}) {
    Mesh mesh(shape);
    const ChartSet before = checked_charts(mesh);
    ASSERT_GT(add_caps(mesh, 3), 50u);
    const ChartSet after = checked_charts(mesh);
    EXPECT_LE(after.charts.size(), before.charts.size() + 3);
    EXPECT_LE(check_charts(mesh.view(), after).stretch_999, 1.25001);
    EXPECT_LE(after.seam_length, 1.4 * before.seam_length + 1e-9);
  }
}

// Each of the closing triangles is linked, and has the normal of the plane.
TEST(Thin, NormalsAreThoseOfNeighbours) {
  Mesh mesh(grid(8, 8));
  const std::size_t caps = add_caps(mesh, 2);
  const Topology topology = topology_of(mesh);
  std::size_t thin = 0;
  for (std::uint32_t t = 0; t < topology.triangle_count(); ++t) {
    EXPECT_FALSE(topology.degenerate(t));
    EXPECT_NEAR(std::abs(topology.normals[t].z), 1, 1e-6);
    thin += topology.thin(t);
    if (!topology.thin(t)) continue;
    EXPECT_EQ(topology.areas[t], 0);
    for (std::uint32_t h = 3 * t; h < 3 * t + 3; ++h) EXPECT_NE(topology.opposite[h], kNoIndex);
  }
  EXPECT_EQ(thin, caps);
  EXPECT_EQ(topology.component_count, 1u);
}

// Triangles of one line that lead to no other triangle are no part of a surface.
TEST(Thin, RowsWithoutASurfaceAreLeftOut) {
  Mesh mesh(grid(3, 3));
  for (int i = 0; i < 4; ++i) add_vertex(mesh, {5, float(i), 0});
  const auto first = static_cast<std::uint32_t>(mesh.positions.size() - 4);
  add_triangle(mesh, first, first + 1, first + 2);
  add_triangle(mesh, first + 2, first + 1, first + 3);
  const Topology topology = topology_of(mesh);
  EXPECT_TRUE(topology.degenerate(18) && topology.degenerate(19));
  EXPECT_EQ(topology.component_count, 1u);
  EXPECT_EQ(checked_charts(mesh).charts.size(), 1u);
}

// Where more than two triangles share an edge, those with area decide.
TEST(Thin, EdgesOfManyTrianglesAreLinkedWithoutThem) {
  Mesh mesh;
  mesh.positions = {{0, 0, 0}, {1, 0, 0}, {0.5f, 1, 0}, {0.5f, -1, 0}, {0.5f, 0, 0}};
  mesh.indices = {0, 1, 2, 1, 0, 3, 1, 0, 4};
  const Topology topology = topology_of(mesh);
  EXPECT_EQ(topology.opposite[0], 3u);
  EXPECT_EQ(topology.defects.nonmanifold_edges, 0u);
  EXPECT_TRUE(topology.degenerate(2));
}

// Files that have charts with T-junctions keep them, if the closing triangles are open in the
// texcoords.
TEST(Thin, GivenChartsGoOnThroughOpenOnes) {
  for (const float out : {1e-6f, -1e-6f}) {
    Mesh mesh(grid(8, 8));
    const std::size_t vertices = mesh.positions.size();
    const std::size_t caps = add_caps(mesh, 4);
    for (const Vec3f& p : mesh.positions) mesh.texcoords.push_back({p.x, p.y});
    // Each hanging vertex moves away from the triangle whose edge it hangs on, or into it.
    const std::size_t closing = mesh.indices.size() / 3;
    for (std::size_t t = 0; t < closing; ++t) {
      const std::uint32_t *v = &mesh.indices[3 * t], m = v[2];
      if (m < vertices || v[0] >= vertices || v[1] >= vertices) continue;
      const Vec3f &a = mesh.positions[v[0]], &b = mesh.positions[v[1]];
      mesh.texcoords[m].x -= out * (b.y - a.y) * 8;
      mesh.texcoords[m].y += out * (b.x - a.x) * 8;
    }
    mesh.texcoord_indices = mesh.indices;
    ChartOptions options;
    options.keep_uv_charts = true;
    const auto set = make_charts(mesh.view(), options, {});
    ASSERT_TRUE(set.ok()) << set.status().message();
    EXPECT_GT(caps, 10u);
    EXPECT_EQ(set->repairs.kept_charts, 1u);
    EXPECT_EQ(set->repairs.reflattened_charts, out > 0 ? 0u : 1u);
    EXPECT_EQ(check_charts(mesh.view(), *set).fault, "");
  }
}

// A mesh that is a millionth as thick as long has normals: coordinates across are rounded less.
TEST(Thin, ThinMeshesKeepTheirNormals) {
  Mesh mesh(sphere(12, 24));
  for (Vec3f& p : mesh.positions) p = {p.x, 1e-6f * p.y, 1e-6f * p.z};
  const Topology topology = topology_of(mesh);
  const RoundingLimit limit(topology);
  for (std::uint32_t t = 0; t < topology.triangle_count(); ++t) {
    std::array<glm::dvec3, 3> p;
    for (std::uint32_t c = 0; c < 3; ++c)
      p[c] = to_dvec(topology.points[topology.corner_vertex[3 * t + c]]);
    double longest = 0;
    for (int c = 0; c < 3; ++c) {
      const glm::dvec3 edge = p[(c + 1) % 3] - p[c];
      longest = std::max(longest, glm::dot(edge, edge));
    }
    EXPECT_FALSE(limit.blurs(p, glm::cross(p[1] - p[0], p[2] - p[0]), longest)) << t;
  }
}

}  // namespace
}  // namespace atlas::test
