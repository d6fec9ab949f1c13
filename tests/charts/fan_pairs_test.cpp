#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <random>
#include <set>
#include <vector>

#include "libatlas/charts/mesh/topology.h"
#include "libatlas/core/random.h"
#include "tests/charts/chart_checks.h"

namespace atlas::test {
namespace {

std::size_t open_half_edges(const Topology& topology) {
  return std::size_t(std::count(topology.opposite.begin(), topology.opposite.end(), kNoIndex));
}

bool linked(const Topology& topology, std::uint32_t s, std::uint32_t t) {
  const auto* across = &topology.opposite[3 * std::size_t{s}];
  return std::any_of(across, across + 3, [&](std::uint32_t o) { return o / 3 == t; });
}

struct Page {
  double degrees;
  bool forward = true;
};

// Triangles around the edge from vertex 0 to vertex 1.
Mesh pages(const std::vector<Page>& around) {
  Mesh mesh;
  mesh.positions = {{0, 0, 0}, {0, 0, 1}};
  for (const Page& page : around) {
    const double angle = page.degrees * M_PI / 180;
    const Vec3f p{float(std::cos(angle)), float(std::sin(angle)), 0.5f};
    const auto at = std::find(mesh.positions.begin(), mesh.positions.end(), p);
    const auto third = std::uint32_t(at - mesh.positions.begin());
    if (at == mesh.positions.end()) mesh.positions.push_back(p);
    const std::uint32_t a = page.forward ? 0 : 1;
    mesh.indices.insert(mesh.indices.end(), {a, 1 - a, third});
  }
  return mesh;
}

void add_box(Mesh& mesh, Vec3f low) {
  const auto first = std::uint32_t(mesh.positions.size());
  const Shape shape = box(1);
  Vec3f corner = shape.positions[0];
  for (const Vec3f& p : shape.positions) {
    corner = {std::min(corner.x, p.x), std::min(corner.y, p.y), std::min(corner.z, p.z)};
  }
  for (const Vec3f& p : shape.positions) {
    mesh.positions.push_back({p.x - corner.x + low.x, p.y - corner.y + low.y, p.z - corner.z});
  }
  for (const std::uint32_t v : shape.indices) mesh.indices.push_back(first + v);
}

// A ring of edges at which a lens and a ring around it touch. Their heights decide which of them is
// the more acute.
Mesh lens_in_ring(double lens, double ring) {
  constexpr std::uint32_t kSides = 12;
  Mesh mesh;
  for (std::uint32_t i = 0; i < kSides; ++i) {
    const double a = 2 * M_PI * i / kSides;
    for (const auto& [r, z] : {std::pair(1.0, 0.0), {2.0, ring}, {2.0, -ring}}) {
      mesh.positions.push_back({float(r * std::cos(a)), float(r * std::sin(a)), float(z)});
    }
  }
  mesh.positions.push_back({0, 0, float(lens)});
  mesh.positions.push_back({0, 0, float(-lens)});
  const std::uint32_t top = 3 * kSides, bottom = top + 1;
  for (std::uint32_t i = 0; i < kSides; ++i) {
    const std::uint32_t a = 3 * i, b = 3 * ((i + 1) % kSides);
    for (const std::uint32_t v : {a, b, top, b, a, bottom}) mesh.indices.push_back(v);
    for (const auto& [k, l] : {std::pair(0u, 1u), {1u, 2u}, {2u, 0u}}) {
      for (const std::uint32_t v : {a + k, a + l, b + k, b + k, a + l, b + l}) {
        mesh.indices.push_back(v);
      }
    }
  }
  return mesh;
}

// The pairs of linked triangles, each named by the least turn of its vertices.
std::multiset<std::array<std::uint32_t, 6>> linked_pairs(const Mesh& mesh) {
  const Topology topology = topology_of(mesh);
  const auto name = [&](std::uint32_t t) {
    std::array<std::uint32_t, 3> v{mesh.indices[3 * t], mesh.indices[3 * t + 1],
                                   mesh.indices[3 * t + 2]};
    std::rotate(v.begin(), std::min_element(v.begin(), v.end()), v.end());
    return v;
  };
  std::multiset<std::array<std::uint32_t, 6>> pairs;
  for (std::uint32_t h = 0; h < topology.opposite.size(); ++h) {
    if (topology.opposite[h] == kNoIndex) continue;
    const auto a = name(h / 3), b = name(topology.opposite[h] / 3);
    pairs.insert({a[0], a[1], a[2], b[0], b[1], b[2]});
  }
  return pairs;
}

Mesh shuffled(const Mesh& mesh, std::uint64_t seed) {
  std::mt19937_64 random(seed);
  std::vector<std::uint32_t> order(mesh.indices.size() / 3);
  for (std::uint32_t t = 0; t < order.size(); ++t) order[t] = t;
  std::shuffle(order.begin(), order.end(), random);
  Mesh out;
  out.positions = mesh.positions;
  for (const std::uint32_t t : order) {
    const auto turn = std::uint32_t(random() % 3);
    for (std::uint32_t c = 0; c < 3; ++c) {
      out.indices.push_back(mesh.indices[3 * t + (c + turn) % 3]);
    }
  }
  return out;
}

Mesh two_boxes() {
  Mesh mesh;
  add_box(mesh, {0, 0, 0});
  add_box(mesh, {1, 1, 0});
  return mesh;
}

// Two boxes back to back, with a wall in one plane that both have: four faces, two of them in the
// same direction, so that two pairings are equally good.
Mesh overlapping_walls() {
  Mesh mesh = pages({{0, false}, {90, true}, {270, true}});
  const auto third = std::uint32_t(mesh.positions.size());
  mesh.positions.push_back({0.7f, 0, 0.3f});
  mesh.indices.insert(mesh.indices.end(), {1, 0, third});
  return mesh;
}

// A grid on which a fin stands: the two sides of a triangle over an edge inside.
Mesh grid_with_fin() {
  Mesh mesh(grid(6, 6));
  const std::uint32_t middle = mesh.indices.size() / 6 * 3;
  const std::uint32_t a = mesh.indices[middle], b = mesh.indices[middle + 1];
  const Vec3f p = mesh.positions[a], q = mesh.positions[b];
  const auto tip = std::uint32_t(mesh.positions.size());
  mesh.positions.push_back({(p.x + q.x) / 2, (p.y + q.y) / 2 + 0.01f, 0.1f});
  mesh.indices.insert(mesh.indices.end(), {a, b, tip, b, a, tip});
  return mesh;
}

TEST(FanPairs, TwoCubesAtAnEdgeAreTwoCubes) {
  const Mesh mesh = two_boxes();
  const Topology topology = topology_of(mesh);
  EXPECT_EQ(topology.defects.nonmanifold_edges, 1u);
  EXPECT_EQ(topology.component_count, 2u);
  EXPECT_EQ(open_half_edges(topology), 0u);
  checked_charts(mesh);
}

// Then the faces in one plane agree, so these go through.
TEST(FanPairs, ACubeInsideOutAtAnotherOne) {
  Mesh mesh = two_boxes();
  for (std::size_t i = mesh.indices.size() / 2; i < mesh.indices.size(); i += 3) {
    std::swap(mesh.indices[i], mesh.indices[i + 1]);
  }
  const Topology topology = topology_of(mesh);
  EXPECT_EQ(topology.component_count, 1u);
  EXPECT_EQ(open_half_edges(topology), 0u);
  checked_charts(mesh);
}

// At each edge of the loop the flatter pairs are taken: through the point of contact where the
// bodies are acute, around each body where they are not.
TEST(FanPairs, BodiesThatTouchAlongALoop) {
  const Topology acute = topology_of(lens_in_ring(0.3, 1));
  EXPECT_EQ(acute.defects.nonmanifold_edges, 12u);
  EXPECT_EQ(open_half_edges(acute), 0u);
  EXPECT_EQ(acute.component_count, 1u);
  const Topology blunt = topology_of(lens_in_ring(1.5, 1.7));
  EXPECT_EQ(open_half_edges(blunt), 0u);
  EXPECT_EQ(blunt.component_count, 2u);
  checked_charts(lens_in_ring(0.3, 1));
  checked_charts(lens_in_ring(1.5, 1.7));
}

// One sheet goes through, and the other one ends there, however they are oriented.
TEST(FanPairs, ATJunctionKeepsTheSheetThatGoesThrough) {
  for (const double degrees : {30.0, 90.0, 150.0}) {
    for (int turned = 0; turned < 8; ++turned) {
      const Mesh mesh = pages({{0, !(turned & 1)}, {degrees, !(turned & 2)}, {180, !(turned & 4)}});
      const Topology topology = topology_of(mesh);
      EXPECT_TRUE(linked(topology, 0, 2)) << degrees << " " << turned;
      EXPECT_EQ(topology.component_count, 2u);
      checked_charts(mesh);
    }
  }
}

TEST(FanPairs, SheetsThatCrossBothGoThrough) {
  for (int turned = 0; turned < 16; ++turned) {
    const Mesh mesh = pages(
        {{0, !(turned & 1)}, {90, !(turned & 2)}, {180, !(turned & 4)}, {270, !(turned & 8)}});
    const Topology topology = topology_of(mesh);
    // Four walls that agree around the edge are the corners of two solids.
    const bool solids = turned == 5 || turned == 10;
    EXPECT_EQ(linked(topology, 0, 2) && linked(topology, 1, 3), !solids) << turned;
    EXPECT_EQ(topology.component_count, 2u);
    checked_charts(mesh);
  }
}

TEST(FanPairs, ABookFallsIntoPages) {
  const Mesh mesh = pages({{0, true}, {12, false}, {24, true}, {36, false}, {48, true}});
  EXPECT_EQ(topology_of(mesh).component_count, 5u);
  EXPECT_EQ(checked_charts(mesh).charts.size(), 5u);
}

// The flattest pair alone would leave the other two apart.
TEST(FanPairs, TwoGoodPairsAreBetterThanTheFlattest) {
  const Topology topology =
      topology_of(pages({{0, false}, {115, true}, {131, false}, {230, true}}));
  EXPECT_TRUE(linked(topology, 0, 1));
  EXPECT_TRUE(linked(topology, 2, 3));
}

TEST(FanPairs, ASurfaceGoesOnBesideAFin) {
  const Mesh mesh = grid_with_fin();
  const Topology topology = topology_of(mesh);
  EXPECT_EQ(topology.defects.nonmanifold_edges, 1u);
  EXPECT_EQ(topology.defects.duplicate_triangles, 1u);
  EXPECT_EQ(topology.defects.misoriented_edges, 0u);
  EXPECT_EQ(topology.component_count, 2u) << "the surface, and both sides of the fin";
  const ChartSet set = checked_charts(mesh);
  EXPECT_EQ(set.charts.size(), 2u);
}

// Given uvs may unfold a fin, or lay one side on the other.
TEST(FanPairs, TheSidesOfAFinInGivenUvs) {
  for (const bool unfolded : {true, false}) {
    Mesh mesh;
    mesh.positions = {{0, 0, 0}, {1, 0, 0}, {0.4f, 0.5f, 0}};
    mesh.indices = {0, 1, 2, 1, 0, 2};
    mesh.texcoords = {{0, 0}, {1, 0}, {0.4f, 0.5f}, {0.4f, -0.5f}};
    mesh.texcoord_indices = {0, 1, 2, 1, 0, unfolded ? 3u : 2u};
    ChartOptions options;
    options.keep_uv_charts = true;
    const Result<ChartSet> set = make_charts(mesh.view(), options, {});
    ASSERT_TRUE(set.ok());
    EXPECT_EQ(check_charts(mesh.view(), *set).fault, "");
    EXPECT_EQ(set->charts.size(), unfolded ? 1u : 2u);
    EXPECT_EQ(set->repairs.kept_charts, unfolded ? 1u : 2u);
  }
}

// Two of three coincident triangles cancel. The surface goes through the third.
TEST(FanPairs, ATriangleWithAPairOfCopies) {
  Mesh mesh(grid(6, 6));
  const std::size_t middle = mesh.indices.size() / 6 * 3;
  const std::uint32_t a = mesh.indices[middle], b = mesh.indices[middle + 1],
                      c = mesh.indices[middle + 2];
  mesh.indices.insert(mesh.indices.begin(), {b, a, c, a, b, c});
  const Topology topology = topology_of(mesh);
  EXPECT_EQ(topology.defects.nonmanifold_edges, 3u);
  EXPECT_EQ(topology.component_count, 2u);
  EXPECT_EQ(topology.defects.misoriented_edges, 0u);
  checked_charts(mesh);
}

TEST(FanPairs, CopiesAreSheetsOfTheirOwn) {
  Mesh mesh(grid(6, 6));
  const std::vector<std::uint32_t> sheet = mesh.indices;
  for (int k = 0; k < 5; ++k) {
    for (std::size_t i = 0; i < sheet.size(); i += 3) {
      const std::size_t back = k % 2 ? 1 : 0;
      for (const std::size_t c : {i, i + 1 + back, i + 2 - back}) mesh.indices.push_back(sheet[c]);
    }
  }
  const Topology topology = topology_of(shuffled(mesh, 1));
  EXPECT_EQ(topology.component_count, 6u);
  EXPECT_EQ(topology.defects.misoriented_edges, 0u);
}

TEST(FanPairs, TheOrderOfTrianglesDoesNotMatter) {
  for (const Mesh& mesh :
       {two_boxes(), lens_in_ring(0.3, 1), lens_in_ring(1.5, 1.7), grid_with_fin(),
        pages({{0, false}, {115, true}, {131, false}, {230, true}}),
        pages({{0, true}, {90, true}, {180, true}, {270, true}, {10, false}, {200, false}}),
        overlapping_walls()}) {
    const auto pairs = linked_pairs(mesh);
    EXPECT_FALSE(pairs.empty());
    for (std::uint64_t seed = 0; seed < 20; ++seed) {
      EXPECT_EQ(linked_pairs(shuffled(mesh, seed)), pairs) << seed;
    }
    for (const float scale : {1e-3f, 7.0f}) {  // nor do the unit, the place and the rotation
      for (const float turn : {0.0f, 0.3f, 1.1f}) {
        const float c = std::cos(turn), d = std::sin(turn);
        Mesh moved = mesh;
        for (Vec3f& p : moved.positions) {
          p = {c * p.x - d * p.y, d * p.x + c * p.y, p.z};
          p = {scale * (p.x + 5), scale * (c * p.y - d * p.z - 3), scale * (d * p.y + c * p.z)};
        }
        EXPECT_EQ(linked_pairs(moved), pairs) << scale << " " << turn;
      }
    }
  }
}

// Fans at random, with coincident triangles and without area.
TEST(FanPairs, AnyFanIsPlaced) {
  std::mt19937_64 random(5);
  for (int round = 0; round < 300; ++round) {
    SCOPED_TRACE(round);
    std::vector<Page> around;
    const int count = 3 + int(random() % (round % 10 ? 8 : 50));
    for (int i = 0; i < count; ++i) {
      around.push_back({15.0 * double(random() % 24), random() % 2 == 0});
    }
    Mesh mesh = pages(around);
    mesh.indices.insert(mesh.indices.end(), {0, 1, 0, 1, 1, 0});
    const Topology topology = topology_of(mesh);
    for (std::uint32_t h = 0; h < topology.opposite.size(); ++h) {
      const std::uint32_t o = topology.opposite[h];
      if (o == kNoIndex) continue;
      ASSERT_EQ(topology.opposite[o], h);
      ASSERT_EQ(topology.corner_vertex[h], topology.corner_vertex[next_half_edge(o)]);
    }
    checked_charts(mesh);
  }
}

}  // namespace
}  // namespace atlas::test
