#include "examples/cabin/refine.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/geometric.hpp>
#include <numeric>
#include <unordered_map>

namespace cabin {
namespace {

constexpr Id kNone = ~0u;

std::uint64_t pair_key(Id a, Id b) {
  return a < b ? std::uint64_t(a) << 32 | b : std::uint64_t(b) << 32 | a;
}

// The mesh's edges by position, so that both sides of a crease share one.
struct Edges {
  struct Edge {
    Id first = 0, count = 0;  // range of `users`: 3 * triangle + corner where it starts
    double length = 0;
    float priority = 0;
    bool smooth = false;  // a single smooth sheet, so its midpoint may leave the straight line
    bool split = false;
  };
  std::vector<Edge> edges;
  std::vector<Id> users;
  std::vector<std::array<Id, 3>> of_triangle;
  std::vector<std::uint8_t> longest;  // corner where each triangle's longest edge starts

  explicit Edges(const Mesh& mesh);
};

float tone(glm::vec3 light) {
  // Approximates perception: differences in the dark count more than those in full sun.
  return std::sqrt(std::max(0.0f, (light.x + light.y + light.z) / 3) + 2.0f);
}

Edges::Edges(const Mesh& mesh) {
  const std::size_t corners = mesh.triangles.size() * 3;
  std::vector<std::pair<std::uint64_t, Id>> keyed(corners);
  for (Id i = 0; i < corners; ++i) {
    const Triangle& t = mesh.triangles[i / 3];
    keyed[i] = {
        pair_key(mesh.vertices[t.vertex[i % 3]].point, mesh.vertices[t.vertex[(i + 1) % 3]].point),
        i};
  }
  std::sort(keyed.begin(), keyed.end());
  users.resize(corners);
  of_triangle.resize(mesh.triangles.size());
  for (std::size_t i = 0; i < corners;) {
    Edge edge;
    edge.first = Id(i);
    edge.smooth = true;
    std::uint64_t sheet = 0;
    std::size_t j = i;
    for (; j < corners && keyed[j].first == keyed[i].first; ++j) {
      const Id user = keyed[j].second;
      const Triangle& t = mesh.triangles[user / 3];
      const Id a = t.vertex[user % 3], b = t.vertex[(user % 3 + 1) % 3];
      const std::uint64_t key = pair_key(a, b);
      if (j > i && key != sheet) edge.smooth = false;
      sheet = key;
      edge.length = glm::distance(glm::dvec3(mesh.vertices[a].position),
                                  glm::dvec3(mesh.vertices[b].position));
      const float change = std::abs(tone(mesh.direct[a] + mesh.indirect[a]) -
                                    tone(mesh.direct[b] + mesh.indirect[b]));
      // Because of the small constant, dark and even areas are refined at the end, too, largest
      // edges first.
      edge.priority = std::max(edge.priority, float((change + 0.05) * edge.length));
      users[j] = user;
      of_triangle[user / 3][user % 3] = Id(edges.size());
    }
    edge.count = Id(j - i);
    edges.push_back(edge);
    i = j;
  }
  longest.resize(mesh.triangles.size());
  for (std::size_t t = 0; t < of_triangle.size(); ++t) {
    const auto& e = of_triangle[t];
    // Edges of equal length are ordered by their id, because all triangles must agree on the order.
    const auto longer = [&](int a, int b) {
      return std::pair(edges[e[a]].length, e[a]) > std::pair(edges[e[b]].length, e[b]);
    };
    int best = longer(1, 0) ? 1 : 0;
    if (longer(2, best)) best = 2;
    longest[t] = std::uint8_t(best);
  }
}

// Marks `edge` and the edges that conformity requires. Returns how many triangles that adds.
std::size_t mark(Edges& all, Id edge, std::vector<Id>& stack) {
  std::size_t added = 0;
  stack.assign(1, edge);
  while (!stack.empty()) {
    const Id e = stack.back();
    stack.pop_back();
    if (all.edges[e].split) continue;
    all.edges[e].split = true;
    added += all.edges[e].count;
    for (Id i = 0; i < all.edges[e].count; ++i) {
      const Id triangle = all.users[all.edges[e].first + i] / 3;
      stack.push_back(all.of_triangle[triangle][all.longest[triangle]]);
    }
  }
  return added;
}

// Splits triangles. Vertices and texture coordinates at the middle of split edges are made once.
class Splitter {
 public:
  Splitter(Mesh& mesh, const Edges& edges)
      : mesh_(mesh), edges_(edges), point_(edges.edges.size(), kNone) {
    std::size_t split = 0;
    for (const auto& e : edges.edges) split += e.split;
    vertices_.reserve(split + split / 8);
    texcoords_.reserve(split + split / 8);
  }

  // Splits one triangle at its marked edges: first the longest, then the others in what is left.
  void split(std::size_t t, std::vector<Triangle>& out) {
    const Triangle& old = mesh_.triangles[t];
    const auto& e = edges_.of_triangle[t];
    const int k = edges_.longest[t], k1 = (k + 1) % 3, k2 = (k + 2) % 3;
    if (!edges_.edges[e[k]].split) {
      out.push_back(old);
      return;
    }
    const auto corner = [&](int i) { return std::pair(old.vertex[i], old.texcoord[i]); };
    const auto middle = [&](int from) {
      const int to = (from + 1) % 3;
      return std::pair(vertex(e[from], old.vertex[from], old.vertex[to]),
                       texcoord(old.texcoord[from], old.texcoord[to]));
    };
    using C = std::pair<Id, Id>;
    const auto emit = [&](C a, C b, C c) {
      out.push_back(
          {{a.first, b.first, c.first}, {a.second, b.second, c.second}, old.object, old.material});
    };
    const C a = corner(k), b = corner(k1), c = corner(k2), m = middle(k);
    if (edges_.edges[e[k1]].split) {
      const C n = middle(k1);
      emit(m, b, n);
      emit(m, n, c);
    } else {
      emit(m, b, c);
    }
    if (edges_.edges[e[k2]].split) {
      const C n = middle(k2);
      emit(m, c, n);
      emit(m, n, a);
    } else {
      emit(m, c, a);
    }
  }

 private:
  Id vertex(Id edge, Id a, Id b) {
    const auto [it, fresh] = vertices_.emplace(pair_key(a, b), Id(mesh_.vertices.size()));
    if (fresh) add_vertex(edge, std::min(a, b), std::max(a, b));
    return it->second;
  }
  Id texcoord(Id a, Id b) {
    const auto [it, fresh] = texcoords_.emplace(pair_key(a, b), Id(mesh_.texcoords.size()));
    if (fresh) mesh_.texcoords.push_back((mesh_.texcoords[a] + mesh_.texcoords[b]) * 0.5f);
    return it->second;
  }

  void add_vertex(Id edge, Id a, Id b) {
    const Vertex p = mesh_.vertices[a], q = mesh_.vertices[b];
    Vertex middle;
    if (point_[edge] == kNone) point_[edge] = mesh_.points++;
    middle.point = point_[edge];
    middle.normal = glm::normalize(p.normal + q.normal);
    middle.ray_start = (p.ray_start + q.ray_start) * 0.5f;
    middle.position = (p.position + q.position) * 0.5f;
    if (mesh_.curved && edges_.edges[edge].smooth) {
      const glm::vec3 d = q.position - p.position;
      middle.position +=
          (p.normal * glm::dot(p.normal, d) - q.normal * glm::dot(q.normal, d)) * 0.125f;
    }
    mesh_.vertices.push_back(middle);
    mesh_.indirect.push_back((mesh_.indirect[a] + mesh_.indirect[b]) * 0.5f);
  }

  Mesh& mesh_;
  const Edges& edges_;
  std::vector<Id> point_;
  std::unordered_map<std::uint64_t, Id> vertices_, texcoords_;
};

// If cancelled, the mesh stays as it is.
void refine_once(Mesh& mesh, std::size_t wished, const atlas::Context& context) {
  Edges all(mesh);
  if (context.cancelled()) return;
  std::vector<Id> order(all.edges.size());
  std::iota(order.begin(), order.end(), 0);
  std::sort(order.begin(), order.end(), [&](Id a, Id b) {
    return std::pair(-all.edges[a].priority, a) < std::pair(-all.edges[b].priority, b);
  });
  std::size_t count = mesh.triangles.size();
  std::vector<Id> stack;
  for (Id edge : order) {
    if (count >= wished) break;
    count += mark(all, edge, stack);
  }
  if (context.cancelled()) return;
  std::vector<Triangle> triangles;
  triangles.reserve(count);
  Splitter splitter(mesh, all);
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) splitter.split(t, triangles);
  mesh.triangles.swap(triangles);
}

}  // namespace

void refine(Mesh& mesh, const RefineOptions& options, const Lighting& lighting,
            const atlas::Context& context) {
  const double start = double(mesh.triangles.size());
  for (int pass = 1; pass <= options.passes; ++pass) {
    const double goal =
        start * std::pow(double(options.triangles) / start, double(pass) / options.passes);
    if (context.cancelled() || goal <= double(mesh.triangles.size())) continue;
    const std::size_t first = mesh.vertices.size();
    refine_once(mesh, std::size_t(std::lround(goal)), context);
    lighting.light_directly(mesh, first, context);
    context.report("refining", double(pass) / options.passes);
  }
}

}  // namespace cabin
