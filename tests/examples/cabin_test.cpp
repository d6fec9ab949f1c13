// Tests the sample scene: its size, its light (against closed forms and brute force), and its
// files.
#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <glm/geometric.hpp>
#include <map>
#include <numbers>
#include <random>
#include <set>
#include <sstream>

#include "examples/cabin/refine.h"
#include "examples/cabin/write.h"
#include "libatlas/scene/reader.h"
#include "tests/support/world_mesh.h"

namespace cabin {
namespace {

namespace fs = std::filesystem;

Mesh lit_cabin(std::size_t triangles, int threads, std::uint32_t seed = 1) {
  atlas::Context context;
  context.threads = threads;
  Mesh mesh = build_cabin(triangles * 35 / 100, triangles * 8 / 10);
  const Shell shell = shell_of(mesh);
  const Tracer tracer(shell.positions, shell.triangles);
  LightingOptions options;
  options.seed = seed;
  options.direct_samples = 16;
  options.indirect_samples = 32;
  const Lighting lighting(tracer, cabin_lights(), options);
  lighting.light_directly(mesh, 0, context);
  lighting.light_indirectly(mesh, context);
  refine(mesh, {triangles, 12}, lighting, context);
  show_emitters(mesh);
  return mesh;
}

const Mesh& shared_cabin() {
  static const Mesh mesh = lit_cabin(60000, 0);
  return mesh;
}

struct TempFolder {
  fs::path path =
      fs::temp_directory_path() / ("cabin_test_" + std::to_string(std::random_device{}()));
  TempFolder() { fs::create_directories(path); }
  ~TempFolder() { fs::remove_all(path); }
};

std::string bytes_of(const fs::path& path) {
  std::ifstream file(path, std::ios::binary);
  std::stringstream text;
  text << file.rdbuf();
  return text.str();
}

TEST(Cabin, HasTheSizeThatWasAskedFor) {
  for (std::size_t wished : {10000, 23000, 60000}) {
    const Mesh mesh = lit_cabin(wished, 0);
    EXPECT_NEAR(double(mesh.triangles.size()), double(wished), 0.03 * double(wished));
    EXPECT_EQ(mesh.vertices.size(), mesh.direct.size());
    EXPECT_EQ(mesh.vertices.size(), mesh.indirect.size());
  }
}

TEST(Cabin, LightIsFiniteNeverNegativeAndDarkInsideClosedThings) {
  const Mesh& mesh = shared_cabin();
  std::size_t black = 0;
  float brightest = 0;
  for (std::size_t v = 0; v < mesh.vertices.size(); ++v) {
    const glm::vec3 e = mesh.direct[v] + mesh.indirect[v];
    for (int k = 0; k < 3; ++k) {
      ASSERT_TRUE(std::isfinite(e[k])) << v;
      ASSERT_GE(e[k], 0) << v;
    }
    black += e == glm::vec3(0);
    brightest = std::max({brightest, e.x, e.y, e.z});
  }
  EXPECT_GT(brightest, 1500);
  EXPECT_LT(brightest, 6000);
  EXPECT_GT(double(black), 0.01 * double(mesh.vertices.size()));
  for (const Triangle& t : mesh.triangles) {
    if (mesh.objects[t.object].find("_inside") == std::string::npos) continue;
    for (Id v : t.vertex) EXPECT_EQ(mesh.direct[v], glm::vec3(0)) << mesh.objects[t.object];
  }
}

TEST(Cabin, NamesTheDoorAndItsFrame) {
  const std::vector<std::string>& names = shared_cabin().objects;
  for (const char* name : {"door", "door_frame", "lining", "floor", "ceiling", "galley_counter"})
    EXPECT_EQ(std::count(names.begin(), names.end(), name), 1) << name;
}

// The triangles of each object are consecutive, so that files name it once.
TEST(Cabin, ObjectsAreWhole) {
  std::set<int> seen;
  int current = -1;
  for (const Triangle& t : shared_cabin().triangles) {
    if (t.object == current) continue;
    current = t.object;
    EXPECT_TRUE(seen.insert(current).second) << shared_cabin().objects[t.object];
  }
  EXPECT_EQ(seen.size(), shared_cabin().objects.size());
}

// Refinement leaves no vertex inside an edge: closed objects stay closed, with each edge used
// twice.
TEST(Cabin, RefinementConforms) {
  const Mesh& mesh = shared_cabin();
  std::map<std::string, std::map<std::pair<Id, Id>, int>> edges;
  const std::set<std::string> closed{"door",          "door_frame",         "bin_s1",
                                     "bin_s1_inside", "seat_3p_aisle_back", "seat_3p_aisle_cushion",
                                     "galley_counter"};
  for (const Triangle& t : mesh.triangles) {
    const std::string& name = mesh.objects[t.object];
    if (!closed.count(name)) continue;
    for (int k = 0; k < 3; ++k)
      ++edges[name][std::minmax(mesh.vertices[t.vertex[k]].point,
                                mesh.vertices[t.vertex[(k + 1) % 3]].point)];
  }
  EXPECT_EQ(edges.size(), closed.size());
  for (const auto& [name, uses] : edges)
    for (const auto& [edge, count] : uses) ASSERT_EQ(count, 2) << name;
}

// Where a bulkhead ends, at the wall and under the crown, another part begins with the same edges:
// the sky does not show through. Only the floor, along one straight line, has corners of its own.
TEST(Cabin, NoGapOpensBesideTheBulkheads) {
  const Mesh& mesh = shared_cabin();
  using Edge = std::pair<Id, Id>;
  std::map<std::string, std::map<Edge, int>> bulkheads;
  std::set<Edge> others;
  std::map<Id, glm::vec3> place;
  for (const Vertex& v : mesh.vertices) place[v.point] = v.position;
  for (const Triangle& t : mesh.triangles) {
    const std::string& name = mesh.objects[t.object];
    const bool bulkhead = name.starts_with("bulkhead");
    for (int k = 0; k < 3; ++k) {
      const Edge edge =
          std::minmax(mesh.vertices[t.vertex[k]].point, mesh.vertices[t.vertex[(k + 1) % 3]].point);
      if (bulkhead)
        ++bulkheads[name][edge];
      else
        others.insert(edge);
    }
  }
  ASSERT_EQ(bulkheads.size(), 2u);
  for (const auto& [name, edges] : bulkheads) {
    std::size_t shared = 0;
    for (const auto& [edge, uses] : edges) {
      if (uses == 2 || (place[edge.first].z < 1e-5f && place[edge.second].z < 1e-5f)) continue;
      ASSERT_TRUE(others.count(edge)) << name << " at z = " << place[edge.first].z;
      ++shared;
    }
    EXPECT_GT(shared, 30u) << name;
  }
}

TEST(Cabin, PointsHaveOnePlace) {
  const Mesh& mesh = shared_cabin();
  std::map<Id, glm::vec3> place;
  std::size_t creases = 0;
  for (const Vertex& v : mesh.vertices) {
    const auto [it, fresh] = place.emplace(v.point, v.position);
    creases += !fresh;
    ASSERT_EQ(it->second, v.position);
    ASSERT_NEAR(glm::length(v.normal), 1, 1e-4);
  }
  EXPECT_GT(creases, 100u);
}

// Triangles are smaller where light changes, for example along the shadow of the door frame on the
// wall. Most of the smaller cabin's triangles are those of its coarse mesh.
TEST(Cabin, RefinesWhereLightChanges) {
  const Mesh mesh = lit_cabin(100000, 0);
  double change_of_small = 0, change_of_large = 0;
  std::vector<std::pair<double, double>> by_length;
  for (const Triangle& t : mesh.triangles) {
    if (mesh.objects[t.object] != "lining") continue;
    const Id a = t.vertex[0], b = t.vertex[1];
    const double length = glm::distance(mesh.vertices[a].position, mesh.vertices[b].position);
    by_length.emplace_back(length, glm::length(mesh.direct[a] - mesh.direct[b]) / length);
  }
  std::sort(by_length.begin(), by_length.end());
  ASSERT_GT(by_length.size(), 1000u);
  const std::size_t tenth = by_length.size() / 10;
  for (std::size_t i = 0; i < tenth; ++i) {
    change_of_small += by_length[i].second;
    change_of_large += by_length[by_length.size() - 1 - i].second;
  }
  EXPECT_GT(change_of_small, 4 * change_of_large);
}

TEST(Cabin, IsTheSameForEveryThreadCount) {
  const TempFolder folder;
  ASSERT_TRUE(write_scene(folder.path / "one.ply", lit_cabin(12000, 1), false).ok());
  ASSERT_TRUE(write_scene(folder.path / "three.ply", lit_cabin(12000, 3), false).ok());
  ASSERT_TRUE(write_scene(folder.path / "seed.ply", lit_cabin(12000, 1, 2), false).ok());
  EXPECT_EQ(bytes_of(folder.path / "one.ply"), bytes_of(folder.path / "three.ply"));
  EXPECT_NE(bytes_of(folder.path / "one.ply"), bytes_of(folder.path / "seed.ply"));
}

// For a point under the middle of a square of side 2 at height h, the form factor has a closed
// form: four times that of a quarter with a corner above the point.
TEST(CabinLight, FormFactorHasItsClosedForm) {
  for (double h : {0.1, 0.5, 1.0, 3.0}) {
    const std::vector<glm::vec3> square{{-1, -1, h}, {-1, 1, h}, {1, 1, h}, {1, -1, h}};
    std::vector<glm::vec3> clockwise(square.rbegin(), square.rend());
    const double x = 1 / h, s = std::sqrt(1 + x * x);
    const double corner = 1 / (2 * std::numbers::pi) * 2 * (x / s * std::atan(x / s));
    const double up = polygon_form_factor(square, {0, 0, 0}, {0, 0, 1});
    const double down = polygon_form_factor(clockwise, {0, 0, 0}, {0, 0, 1});
    EXPECT_NEAR(std::max(up, down), 4 * corner, 1e-5) << h;
    EXPECT_EQ(std::min(up, down), 0) << "only one side shines";
    EXPECT_EQ(polygon_form_factor(square, {0, 0, 0}, {0, 0, -1}), 0) << "below the horizon";
  }
}

// Half of the wall is below the horizon. Only the upper half counts.
TEST(CabinLight, FormFactorIsClippedAtTheHorizon) {
  const std::vector<glm::vec3> wall{{1, -1, -1}, {1, -1, 1}, {1, 1, 1}, {1, 1, -1}};
  const std::vector<glm::vec3> upper{{1, -1, 0}, {1, -1, 1}, {1, 1, 1}, {1, 1, 0}};
  for (bool turned : {false, true}) {
    auto a = wall, b = upper;
    if (turned) {
      std::reverse(a.begin(), a.end());
      std::reverse(b.begin(), b.end());
    }
    EXPECT_NEAR(polygon_form_factor(a, {}, {0, 0, 1}), polygon_form_factor(b, {}, {0, 0, 1}), 1e-6);
  }
}

// Compares direct light at points of the cabin with plain Monte Carlo integration over the area of
// each light.
TEST(CabinLight, AgreesWithBruteForce) {
  const Mesh mesh = build_cabin(20000, 60000);
  const Shell shell = shell_of(mesh);
  const Tracer tracer(shell.positions, shell.triangles);
  LightingOptions options;
  options.direct_samples = 4096;
  const Lighting lighting(tracer, cabin_lights(), options);
  std::mt19937 random(5);
  std::uniform_real_distribution<float> uniform(0, 1);
  for (const glm::vec3& place : {glm::vec3(3.1f, 0.05f, 1e-3f), glm::vec3(5.3f, -0.1f, 1e-3f),
                                 glm::vec3(0.9f, 0.1f, 1e-3f)}) {
    const Vertex vertex{place, place, {0, 0, 1}, 0};
    glm::dvec3 sum(0);
    constexpr int kSamples = 20000;
    for (const AreaLight& light : cabin_lights().areas) {
      // Samples each triangle of the light's fan in proportion to its area.
      for (std::size_t i = 1; i + 1 < light.corners.size(); ++i) {
        const glm::vec3 a = light.corners[0], u = light.corners[i] - a,
                        v = light.corners[i + 1] - a;
        const double area = 0.5 * glm::length(glm::cross(u, v));
        const int n = kSamples / int(light.corners.size());
        for (int k = 0; k < n; ++k) {
          float r = uniform(random), s = uniform(random);
          if (r + s > 1) r = 1 - r, s = 1 - s;
          const glm::vec3 to = a + r * u + s * v - place;
          const float d = glm::length(to);
          const float cosines =
              std::max(0.0f, to.z / d) * std::max(0.0f, -glm::dot(to, light.normal) / d);
          if (cosines <= 0 || tracer.blocked(place, to / d, d * 0.9995f)) continue;
          sum += glm::dvec3(light.exitance) * (area * cosines / (std::numbers::pi * d * d * n));
        }
      }
    }
    const glm::vec3 direct = lighting.direct_at(vertex);
    ASSERT_FALSE(tracer.blocked(place, cabin_lights().sun.towards, 100) == false)
        << "choose a place in the shade";
    for (int k = 0; k < 3; ++k) EXPECT_NEAR(direct[k], sum[k], 0.04 * sum[k] + 0.5) << place.x;
  }
}

TEST(CabinFiles, AllFormatsReadBackWithTheirLight) {
  const TempFolder folder;
  const Mesh mesh = lit_cabin(12000, 0);
  for (const char* name : {"cabin.obj", "cabin.ply", "cabin.glb"}) {
    const fs::path path = folder.path / name;
    const atlas::Status written = write_scene(path, mesh, false);
    ASSERT_TRUE(written.ok()) << written.message();
    const auto loaded = atlas::read_scene(path, {}, {});
    ASSERT_TRUE(loaded.ok()) << loaded.status().message();
    const atlas::Scene& scene = loaded->scene;
    EXPECT_EQ(scene.triangle_count(), mesh.triangles.size()) << name;
    ASSERT_TRUE(scene.lit()) << name;
    for (std::size_t t = 0; t < mesh.triangles.size(); t += 97)
      for (int k = 0; k < 3; ++k) {
        const Id v = mesh.triangles[t].vertex[k];
        const atlas::Vec3f e = scene.illumination[scene.indices[3 * t + k]];
        EXPECT_NEAR(e.x, mesh.direct[v].x + mesh.indirect[v].x, 1e-2) << name;
        const atlas::Vec3f p = scene.positions[scene.indices[3 * t + k]];
        EXPECT_NEAR(p.x + scene.origin.x, mesh.vertices[v].position.x, 1e-5) << name;
      }
  }
  const auto obj = atlas::test::read_world(folder.path / "cabin.obj");
  ASSERT_TRUE(obj.ok()) << obj.status().message();
  EXPECT_EQ(obj->triangles.size(), mesh.triangles.size());
  float largest = 0;
  for (const glm::vec2& uv : obj->texcoords) largest = std::max({largest, uv.x, uv.y});
  EXPECT_GT(largest, 2) << "textures repeat";
}

TEST(CabinFiles, StagesEndWhenCancelled) {
  const std::atomic<bool> yes{true};
  atlas::Context context;
  context.cancel = &yes;
  EXPECT_TRUE(build_cabin(20000, 60000, context).triangles.empty());
  const TempFolder folder;
  for (const char* name : {"cabin.obj", "cabin.ply", "cabin.glb"})
    EXPECT_EQ(write_scene(folder.path / name, shared_cabin(), false, context).code(),
              atlas::ErrorCode::cancelled);
  EXPECT_TRUE(fs::is_empty(folder.path));
}

TEST(CabinFiles, AnUnknownEndingOrFolderIsNamed) {
  const Mesh mesh = build_cabin(1000, 0);
  EXPECT_EQ(write_scene("cabin.xyz", mesh, false).code(), atlas::ErrorCode::bad_option);
}

}  // namespace
}  // namespace cabin
