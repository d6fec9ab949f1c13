#include "libatlas/param/injectivity.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>

#include "libatlas/core/bounds.h"
#include "libatlas/core/hull.h"
#include "libatlas/core/portable_math.h"
#include "libatlas/core/predicates.h"
#include "libatlas/param/mesh/halfedges.h"
#include "libatlas/param/mesh/rest_shape.h"
#include "libatlas/param/repair/border_check.h"

namespace atlas {
namespace {

using param::cross;
using param::HalfEdges;

// Relative rounding error of slabs, generously.
constexpr double kRounding = 1e-12;

struct Box {
  double x0, y0, x1, y1;
};

struct Edge {
  Vec2d a, b;
  std::uint32_t from, to, triangle;
  Vec2d before;  // the boundary corner before a
};

// Whether the direction from e.a to p points into the chart at that corner: strictly between the
// directions to e.b and, counter-clockwise, to e.before.
bool points_inside(const Edge& e, Vec2d p) {
  const int after_first = orientation(e.a, e.b, p), before_last = orientation(e.a, p, e.before);
  const int turn = orientation(e.a, e.b, e.before);
  if (turn > 0) return after_first > 0 && before_last > 0;
  if (turn < 0) return after_first > 0 || before_last > 0;
  return after_first > 0;
}

// Whether the triangles at two boundary vertices in the same point overlap there. Triangles fill
// the corners, so these must not overlap: neither may begin within the other. (If both begin in the
// same direction, their edges overlap along their length.)
bool corners_overlap(const Edge& e, const Edge& f) {
  return points_inside(e, f.b) || points_inside(f, e.b);
}

// Returns the distance of two edges that do not cross. If they share a vertex, this is the distance
// of the shorter one's other end from the longer one: a smaller displacement cannot flip the
// corner.
double gap(const Edge& e, const Edge& f) {
  const auto squared = squared_distance_to_segment;
  const bool shared = e.to == f.from || f.to == e.from;
  if (!shared) {
    return std::sqrt(std::min({squared(e.a, f.a, f.b), squared(e.b, f.a, f.b),
                               squared(f.a, e.a, e.b), squared(f.b, e.a, e.b)}));
  }
  const glm::dvec2 along_e = to_glm(e.b) - to_glm(e.a), along_f = to_glm(f.b) - to_glm(f.a);
  const bool e_shorter = glm::dot(along_e, along_e) < glm::dot(along_f, along_f);
  const bool forward = e.to == f.from;  // e is followed by f
  return std::sqrt(e_shorter ? squared(forward ? e.a : e.b, f.a, f.b)
                             : squared(forward ? f.b : f.a, e.a, e.b));
}

// A box that lies along its edges.
struct Slab {
  glm::dvec2 along{1, 0}, middle{0, 0}, half{-1, -1};  // half the sizes along and across; -1: unset
  bool unset() const { return half.x < 0; }

  explicit Slab() = default;
  explicit Slab(std::span<const Edge> edges) {
    glm::dvec2 doubled(0, 0);  // at twice the angle, opposite directions add up
    for (const Edge& e : edges) {
      const glm::dvec2 d = to_glm(e.b) - to_glm(e.a);
      doubled += glm::dvec2(d.x * d.x - d.y * d.y, 2 * d.x * d.y);
    }
    const double angle = portable::atan2(doubled.y, doubled.x) / 2;
    along = {portable::cos(angle), portable::sin(angle)};
    Bounds<glm::dvec2> bounds;
    for (const Edge& e : edges) {
      bounds.add(framed(to_glm(e.a)));
      bounds.add(framed(to_glm(e.b)));
    }
    const glm::dvec2 centre = bounds.low + 0.5 * bounds.size();
    middle = centre.x * along + centre.y * across();
    half = 0.5 * bounds.size();
  }

  glm::dvec2 across() const { return {-along.y, along.x}; }
  glm::dvec2 framed(glm::dvec2 p) const { return {glm::dot(p, along), glm::dot(p, across())}; }

  // Whether a line along one of this slab's sides separates them by more than `clearance`.
  bool apart(const Slab& other, double clearance) const {
    const glm::dvec2 off = glm::abs(framed(other.middle - middle));
    const glm::dvec2 a = glm::abs(framed(other.along)), b(a.y, a.x);
    const glm::dvec2 reach = half + other.half.x * a + other.half.y * b + clearance;
    return off.x > reach.x || off.y > reach.y;
  }
};

// A binary tree of boxes over the border in its own order. Neighbours on the border are neighbours
// in the plane, so boxes are as tight as if edges were sorted, whatever their lengths. Teeth along
// a ragged border lie beside each other while their upright boxes overlap. They are told apart by
// slabs, which are made when first needed.
class BorderTree {
 public:
  BorderTree(std::span<const Edge> edges, const InjectivityOptions& options, Injectivity& result)
      : edges_(edges), options_(options), result_(result) {
    if (edges_.empty()) return;
    boxes_.resize(4 * ((edges_.size() + leaf - 1) / leaf));
    build(1, 0, static_cast<std::uint32_t>(edges_.size()));
    const Box& all = boxes_[1];
    rounding_ = kRounding *
                std::max({std::abs(all.x0), std::abs(all.y0), std::abs(all.x1), std::abs(all.y1)});
  }

  void find_pairs() {
    if (edges_.empty()) return;
    const Node root{1, 0, static_cast<std::uint32_t>(edges_.size())};
    visit(root, root);
  }

 private:
  static constexpr std::uint32_t leaf = 4;
  struct Node {
    std::uint32_t id, begin, end;
    bool is_leaf() const { return end - begin <= leaf; }
    // Ranges are divided at a multiple of the leaf size, so there are never more nodes than twice
    // the leaves rounded up to a power of two.
    std::uint32_t middle() const {
      const std::uint32_t leaves = (end - begin + leaf - 1) / leaf;
      return begin + leaves / 2 * leaf;
    }
    Node left() const { return {2 * id, begin, middle()}; }
    Node right() const { return {2 * id + 1, middle(), end}; }
  };

  Box& box(std::uint32_t id) {
    if (id >= boxes_.size()) boxes_.resize(2 * id);
    return boxes_[id];
  }

  void build(std::uint32_t id, std::uint32_t begin, std::uint32_t end) {
    const Node node{id, begin, end};
    constexpr double inf = std::numeric_limits<double>::infinity();
    Box b{inf, inf, -inf, -inf};
    if (node.is_leaf()) {
      for (std::uint32_t i = begin; i < end; ++i) {
        b = around(b, box_of(edges_[i]));
      }
    } else {
      build(2 * id, begin, node.middle());
      build(2 * id + 1, node.middle(), end);
      b = around(box(2 * id), box(2 * id + 1));
    }
    box(id) = b;
  }

  static Box box_of(const Edge& e) {
    return {std::min(e.a.x, e.b.x), std::min(e.a.y, e.b.y), std::max(e.a.x, e.b.x),
            std::max(e.a.y, e.b.y)};
  }

  static Box around(const Box& a, const Box& b) {
    return {std::min(a.x0, b.x0), std::min(a.y0, b.y0), std::max(a.x1, b.x1), std::max(a.y1, b.y1)};
  }

  bool apart(const Box& a, const Box& b) const {
    const double c = options_.clearance;
    return a.x1 + c < b.x0 || b.x1 + c < a.x0 || a.y1 + c < b.y0 || b.y1 + c < a.y0;
  }

  bool full() const {
    return result_.crossings.size() >= std::max<std::size_t>(options_.max_crossings, 1);
  }

  const Slab& slab(const Node& node) {
    slabs_.resize(boxes_.size());
    Slab& slab = slabs_[node.id];
    if (slab.unset()) slab = Slab(edges_.subspan(node.begin, node.end - node.begin));
    return slab;
  }

  // Whether slabs show that the nodes, whose boxes meet, are apart.
  bool beside(const Node& i, const Node& j) {
    const bool neighbours = i.end == j.begin || j.end == i.begin;  // they share a vertex
    if (neighbours || i.id == j.id) return false;
    const Slab &a = slab(i), &b = slab(j);
    const double clearance = options_.clearance + rounding_;
    return a.apart(b, clearance) || b.apart(a, clearance);
  }

  void visit(const Node& i, const Node& j) {
    if (full() || apart(boxes_[i.id], boxes_[j.id]) || beside(i, j)) return;
    if (i.id == j.id) {
      if (i.is_leaf()) return test(i, j);
      visit(i.left(), i.left());
      visit(i.right(), i.right());
      return visit(i.left(), i.right());
    }
    if (i.is_leaf() && j.is_leaf()) return test(i, j);
    if (j.is_leaf() || (!i.is_leaf() && i.end - i.begin >= j.end - j.begin)) {
      visit(i.left(), j);
      return visit(i.right(), j);
    }
    visit(i, j.left());
    visit(i, j.right());
  }

  void test(const Node& i, const Node& j) {
    for (std::uint32_t k = i.begin; k < i.end; ++k) {
      if (apart(box_of(edges_[k]), boxes_[j.id])) continue;
      for (std::uint32_t l = i.id == j.id ? k + 1 : j.begin; l < j.end; ++l)
        test(edges_[k], edges_[l]);
    }
  }

  void test(const Edge& e, const Edge& f) {
    if (full()) return;
    const BorderCrossing pair{{e.from, e.to}, {f.from, f.to}, e.triangle, f.triangle};
    const bool at_corner = e.a == f.a && e.from != f.from && corners_overlap(e, f);
    if (at_corner || segments_cross(e.a, e.b, f.a, f.b)) {
      result_.crossings.push_back(pair);
    } else if (options_.clearance > 0 && e.triangle != f.triangle &&
               result_.close.size() < options_.max_crossings && gap(e, f) < options_.clearance) {
      result_.close.push_back(pair);
    }
  }

  std::span<const Edge> edges_;
  const InjectivityOptions& options_;
  Injectivity& result_;
  std::vector<Box> boxes_;
  std::vector<Slab> slabs_;  // by node
  double rounding_ = 0;      // of slabs
};

// Returns the turning sense of a closed polygon that may touch itself in corners, exactly: the turn
// at its lexicographically lowest corner. If several of its corners lie there, they do not overlap,
// and if any of them turns right, the outermost edges do: the polygon encloses a hole.
int turning_sense(std::span<const Edge> loop) {
  const auto before = [](Vec2d a, Vec2d b) { return a.x != b.x ? a.x < b.x : a.y < b.y; };
  Vec2d lowest = loop[0].a;
  for (const Edge& e : loop) lowest = before(e.a, lowest) ? e.a : lowest;
  int sense = 1;
  for (const Edge& e : loop) {
    if (e.a == lowest) sense = std::min(sense, orientation(e.before, e.a, e.b));
  }
  return sense;
}

void check_triangles(const LocalMesh& mesh, std::span<const Vec2d> uvs, double clearance,
                     Injectivity& out) {
  for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t) {
    const auto& tri = mesh.triangles[t];
    const Vec2d a = uvs[tri[0]], b = uvs[tri[1]], c = uvs[tri[2]];
    if (orientation(a, b, c) <= 0) {
      out.flipped.push_back(t);
    } else if (clearance > 0) {
      const glm::dvec2 e = to_glm(b) - to_glm(a), f = to_glm(c) - to_glm(a), g = f - e;
      const double longest = std::max({glm::dot(e, e), glm::dot(f, f), glm::dot(g, g)});
      if (cross(e, f) < clearance * std::sqrt(longest)) out.thin.push_back(t);
    }
  }
}

}  // namespace

void param::check_border(const BorderView& view, std::span<const Vec2d> uvs,
                         const InjectivityOptions& options, Injectivity& out) {
  const auto& [half_edges, border] = view;
  out.loops = static_cast<std::uint32_t>(border.loop_start.size() - 1);
  std::vector<Edge> edges;
  edges.reserve(border.half_edges.size());
  for (std::uint32_t l = 0; l < out.loops; ++l) {
    std::uint32_t before = half_edges.from(border.half_edges[border.loop_start[l + 1] - 1]);
    for (std::uint32_t i = border.loop_start[l]; i < border.loop_start[l + 1]; ++i) {
      const std::uint32_t h = border.half_edges[i];
      const std::uint32_t a = half_edges.from(h), b = half_edges.to(h);
      edges.push_back({uvs[a], uvs[b], a, b, HalfEdges::triangle(h), uvs[before]});
      before = a;
    }
  }
  BorderTree(edges, options, out).find_pairs();
  if (!out.crossings.empty() || !out.flipped.empty()) return;
  int counter_clockwise = 0;
  for (std::uint32_t l = 0; l < out.loops; ++l) {
    const std::uint32_t begin = border.loop_start[l], end = border.loop_start[l + 1];
    counter_clockwise += turning_sense(std::span(edges).subspan(begin, end - begin)) > 0;
  }
  out.nested = counter_clockwise != 1;
}

Injectivity check_injectivity(const LocalMesh& mesh, std::span<const Vec2d> uvs,
                              const InjectivityOptions& options) {
  assert(uvs.size() == mesh.positions.size());
  Injectivity out;
  check_triangles(mesh, uvs, options.clearance, out);
  HalfEdges half_edges;
  half_edges.build(mesh);
  HalfEdges::Border border;
  half_edges.border(border);
  param::check_border({half_edges, border}, uvs, options, out);
  out.injective = out.flipped.empty() && out.crossings.empty() && !out.nested;
  return out;
}

}  // namespace atlas
