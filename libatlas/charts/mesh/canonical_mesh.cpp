#include "libatlas/charts/mesh/canonical_mesh.h"

#include <algorithm>
#include <array>
#include <bit>
#include <utility>

#include "libatlas/charts/mesh/pair_links.h"
#include "libatlas/core/counting_sort.h"
#include "libatlas/core/first_index.h"
#include "libatlas/core/half_edge.h"
#include "libatlas/core/sort_total.h"

namespace atlas {
namespace {

// Half-edges are told apart by up to so many classes, by the numbers of triangles at the three
// corners.
constexpr std::size_t kMostClasses = 4096;
// How many triangles around a half-edge are compared first; each round compares kWider times as
// many.
constexpr std::size_t kFirstRound = 16, kWider = 4;
// Surroundings whose sizes agree to this are alike. Rounding to floats stays below.
constexpr double kAlike = 1e-4;

// How the triangles around a half-edge look.
struct Surroundings {
  std::uint64_t joints = 0;  // a hash of how they are joined
  double size = 0;           // a weighted sum of squared edges
  bool all = false;          // they are the whole piece
};

// A set of triangles that are joined by edges of two triangles.
struct WalkedPiece {
  std::uint32_t triangles = 0, root = kNoIndex;  // root: the half-edge where the walk begins
  std::uint64_t joints = 0;
  std::uint64_t size = 0;  // rounded down to a sixteenth of a power of two, as an increasing number
};

class Walker {
 public:
  // `corners` has places, and `opposite` is what pair_links() finds for them.
  Walker(const MeshView& mesh, const std::vector<Vec3f>& points,
         const std::vector<std::uint32_t>& corners, const std::vector<std::uint32_t>& opposite)
      : mesh_(mesh), points_(points), corners_(corners), opposite_(opposite) {
    count_classes();
  }

  // Returns the half-edges by which the walk enters the triangles, in its order.
  std::vector<std::uint32_t> run() {
    const std::size_t n = corners_.size() / 3;
    seen_.assign(n, 0);
    std::vector<std::uint32_t> order;
    order.reserve(n);
    // A mesh of one piece needs no walk that finds it.
    walk(root_of(corners_.size(), [](std::size_t i) { return std::uint32_t(i); }), order);
    if (order.size() == n) return order;
    order.clear();
    std::vector<WalkedPiece> pieces = find_pieces();
    sort_total(pieces.begin(), pieces.end(), [&](const WalkedPiece& a, const WalkedPiece& b) {
      if (a.triangles != b.triangles) return a.triangles > b.triangles;
      if (a.joints != b.joints) return a.joints < b.joints;
      return a.size != b.size ? a.size > b.size : before(a.root, b.root);
    });
    for (const WalkedPiece& piece : pieces) walk(piece.root, order);
    return order;
  }

 private:
  std::uint32_t valence(std::uint32_t h) const { return valence_[corners_[h]]; }

  void count_classes() {
    valence_.assign(points_.size(), 0);
    for (const std::uint32_t v : corners_) ++valence_[v];
    const std::size_t classes = std::min(kMostClasses, std::bit_ceil(corners_.size()));
    std::vector<std::uint32_t> count(classes, 0);
    class_.resize(corners_.size());
    for (std::uint32_t h = 0; h < corners_.size(); ++h) {
      const std::array<std::uint32_t, 3> around{valence(h), valence(next_half_edge(h)),
                                                valence(previous_half_edge(h))};
      class_[h] = std::uint16_t(hash_words(around) % classes);
      ++count[class_[h]];
    }
    // From here on, classes are numbered from the rarest on.
    std::vector<std::uint16_t> by_count(classes), rank(classes);
    for (std::size_t c = 0; c < classes; ++c) by_count[c] = std::uint16_t(c);
    sort_total(by_count.begin(), by_count.end(), [&](std::uint16_t a, std::uint16_t b) {
      return count[a] != count[b] ? count[a] < count[b] : a < b;
    });
    for (std::size_t i = 0; i < classes; ++i) rank[by_count[i]] = std::uint16_t(i);
    for (std::uint16_t& c : class_) c = rank[c];
  }

  // Appends the triangles that can be reached from a half-edge, up to `most`, as the half-edges by
  // which they are entered. Calls joint(h, index) for each half-edge that is looked across, with
  // the index of the triangle on its other side, or kNoIndex if that is none of these.
  template <class Joint>
  void walk(std::uint32_t root, std::size_t most, std::vector<std::uint32_t>& order,
            const Joint& joint) {
    if (last_seen_ > kNoIndex - seen_.size()) {
      std::fill(seen_.begin(), seen_.end(), 0u);
      last_seen_ = 0;
    }
    const std::size_t start = order.size();
    const auto enter = [&](std::uint32_t h) {
      seen_[h / 3] = ++last_seen_;
      order.push_back(h);
    };
    const std::uint32_t earlier = last_seen_;
    enter(root);
    for (std::size_t at = start; at < order.size(); ++at) {
      std::uint32_t h = order[at];
      for (int k = at == start ? 0 : 1; k < 3; ++k) {
        if (k > 0) h = next_half_edge(h);
        const std::uint32_t o = opposite_[h];
        if (o != kNoIndex && seen_[o / 3] <= earlier && order.size() - start < most) enter(o);
        const bool here = o != kNoIndex && seen_[o / 3] > earlier;
        joint(h, here ? seen_[o / 3] - earlier : kNoIndex);
      }
    }
  }

  void walk(std::uint32_t root, std::vector<std::uint32_t>& order) {
    walk(root, corners_.size(), order, [](std::uint32_t, std::uint32_t) {});
  }

  std::vector<WalkedPiece> find_pieces() {
    std::vector<WalkedPiece> pieces;
    std::vector<std::uint32_t> piece;
    std::vector<bool> found(seen_.size(), false);
    for (std::uint32_t t = 0; t < found.size(); ++t) {
      if (found[t]) continue;
      piece.clear();
      walk(3 * t, piece);
      for (const std::uint32_t h : piece) found[h / 3] = true;
      const std::uint32_t root = root_of(3 * piece.size(), [&](std::size_t i) {
        return piece[i / 3] - piece[i / 3] % 3 + std::uint32_t(i % 3);
      });
      const Surroundings around = look_around(root, kFirstRound * kWider);
      pieces.push_back({std::uint32_t(piece.size()), root, around.joints,
                        std::bit_cast<std::uint64_t>(around.size) >> 48});
    }
    return pieces;
  }

  // Returns the half-edge, of `count` that half_edge(i) gives, where the walk is to begin.
  template <class HalfEdge>
  std::uint32_t root_of(std::size_t count, const HalfEdge& half_edge) {
    std::uint16_t rarest = kMostClasses;
    std::vector<std::uint32_t>& left = candidates_;
    for (std::size_t i = 0; i < count; ++i) {
      const std::uint32_t h = half_edge(i);
      if (class_[h] > rarest) continue;
      if (class_[h] < rarest) left.clear();
      rarest = class_[h];
      left.push_back(h);
    }
    // Where all vertices are alike, sizes leave fewer. Comparing takes about as long as a walk.
    std::size_t effort = 2 * count / 3 + 256;
    if (left.size() * kFirstRound > effort) keep_longest(left);
    bool all = false;
    for (std::size_t most = kFirstRound; left.size() > 1 && !all; most *= kWider) {
      if (left.size() * most > effort) break;
      effort -= left.size() * most;
      all = keep_alike(left, most);
    }
    return *std::min_element(left.begin(), left.end(),
                             [&](std::uint32_t a, std::uint32_t b) { return before(a, b); });
  }

  void keep_longest(std::vector<std::uint32_t>& half_edges) const {
    const auto size = [&](std::uint32_t h) {
      return squared(h) + 0.5 * squared(next_half_edge(h));
    };
    double largest = 0;
    for (const std::uint32_t h : half_edges) largest = std::max(largest, size(h));
    std::erase_if(half_edges, [&](std::uint32_t h) { return size(h) < (1 - kAlike) * largest; });
  }

  // Keeps the half-edges with the largest surroundings of up to `most` triangles, of those that are
  // joined in the way with the largest hash. Returns whether these are the whole piece.
  bool keep_alike(std::vector<std::uint32_t>& half_edges, std::size_t most) {
    std::vector<Surroundings> around;
    around.reserve(half_edges.size());
    for (const std::uint32_t h : half_edges) around.push_back(look_around(h, most));
    Surroundings best;
    for (const Surroundings& a : around) best.joints = std::max(best.joints, a.joints);
    for (const Surroundings& a : around)
      if (a.joints == best.joints) best.size = std::max(best.size, a.size);
    std::size_t kept = 0;
    for (std::size_t i = 0; i < around.size(); ++i) {
      const Surroundings& a = around[i];
      if (a.joints != best.joints || a.size < (1 - kAlike) * best.size) continue;
      best.all = a.all;
      half_edges[kept++] = half_edges[i];
    }
    half_edges.resize(kept);
    return best.all;
  }

  // Describes the first triangles of the walk from a half-edge, up to `most`.
  Surroundings look_around(std::uint32_t root, std::size_t most) {
    Surroundings around;
    around.all = true;
    double weight = 1;
    order_.clear();
    walk(root, most, order_, [&](std::uint32_t h, std::uint32_t index) {
      around.joints =
          hash_words<4>({std::uint32_t(around.joints), std::uint32_t(around.joints >> 32), index,
                         valence(previous_half_edge(h))});
      around.size += weight * squared(h);
      weight = weight < 1.5 ? weight + 0.3819660112501051 : weight - 0.6180339887498949;
      if (index == kNoIndex && opposite_[h] != kNoIndex) around.all = false;
    });
    return around;
  }

  double squared(std::uint32_t h) const {
    const Vec3f &a = points_[corners_[h]], &b = points_[corners_[next_half_edge(h)]];
    const double x = double{b.x} - a.x, y = double{b.y} - a.y, z = double{b.z} - a.z;
    return x * x + y * y + z * z;
  }

  // An order of half-edges by where they lie, and by what the input says about their triangles.
  bool before(std::uint32_t g, std::uint32_t h) const {
    const auto place = [&](std::uint32_t corner) {
      const Vec3f& p = points_[corners_[corner]];
      return std::array{p.x, p.y, p.z};
    };
    for (int k = 0; k < 3; ++k) {
      if (corners_[g] != corners_[h]) return place(g) < place(h);
      g = next_half_edge(g);
      h = next_half_edge(h);
    }
    const auto a = attributes(g), b = attributes(h);
    return a != b ? a < b : g < h;
  }

  std::array<double, 11> attributes(std::uint32_t h) const {
    std::array<double, 11> values{};
    const std::uint32_t t = h / 3;
    if (!mesh_.materials.empty()) values[0] = mesh_.materials[t];
    if (!mesh_.density.empty()) values[1] = double{mesh_.density[t]};
    for (std::size_t k = 0; k < 3; ++k) {
      if (!mesh_.seams.empty()) values[2 + k] = mesh_.seams[h] != 0;
      const std::uint32_t uv =
          mesh_.texcoord_indices.empty() ? kNoIndex : mesh_.texcoord_indices[h];
      if (uv < mesh_.texcoords.size()) {
        values[5 + 2 * k] = double{mesh_.texcoords[uv].x};
        values[6 + 2 * k] = double{mesh_.texcoords[uv].y};
      }
      h = next_half_edge(h);
    }
    return values;
  }

  const MeshView& mesh_;
  const std::vector<Vec3f>& points_;
  const std::vector<std::uint32_t>& corners_;
  const std::vector<std::uint32_t>& opposite_;
  std::vector<std::uint32_t> valence_;  // one per place: how many corners lie there
  std::vector<std::uint16_t> class_;    // one per half-edge; low numbers are rare
  // One per triangle: its number among all that were seen so far, one for each walk over it.
  std::vector<std::uint32_t> seen_;
  std::uint32_t last_seen_ = 0;
  std::vector<std::uint32_t> candidates_, order_;  // scratch memory
};

template <class T>
std::vector<T> per_triangle(std::span<const T> input, const CanonicalMesh& mesh) {
  std::vector<T> values;
  if (input.empty()) return values;
  values.reserve(mesh.first_corner.size());
  for (const std::uint32_t first : mesh.first_corner) values.push_back(input[first / 3]);
  return values;
}

template <class T>
std::vector<T> per_corner(std::span<const T> input, const CanonicalMesh& mesh) {
  std::vector<T> values;
  if (input.empty()) return values;
  values.reserve(3 * mesh.first_corner.size());
  for (std::uint32_t h : mesh.first_corner) {
    for (int k = 0; k < 3; ++k, h = next_half_edge(h)) values.push_back(input[h]);
  }
  return values;
}

// Returns the links of the mesh from those of the input.
std::vector<std::uint32_t> renumbered(const std::vector<std::uint32_t>& opposite,
                                      const CanonicalMesh& mesh) {
  // One per input triangle: the number here of the corner that is the input's first.
  std::vector<std::uint32_t> number(mesh.first_corner.size());
  for (std::uint32_t t = 0; t < number.size(); ++t) {
    const std::uint32_t first = mesh.first_corner[t];
    number[first / 3] = 3 * t + (3 - first % 3) % 3;
  }
  std::vector<std::uint32_t> links = per_corner(std::span(opposite), mesh);
  for (std::uint32_t& o : links) {
    if (o == kNoIndex) continue;
    const std::uint32_t corner = number[o / 3];
    o = corner - corner % 3 + (corner % 3 + o % 3) % 3;
  }
  return links;
}

// Numbers places in the order in which triangles name them.
void number_places(const WeldedVertices& welded, CanonicalMesh& mesh) {
  std::vector<std::uint32_t> number(welded.points.size(), kNoIndex);
  mesh.places.scale = welded.scale;
  mesh.places.points.reserve(number.size());
  mesh.places.source.reserve(number.size());
  for (std::uint32_t& v : mesh.indices) {
    std::uint32_t& own = number[v];
    if (own == kNoIndex) {
      own = std::uint32_t(mesh.places.points.size());
      mesh.places.points.push_back(welded.points[v]);
      mesh.places.source.push_back(welded.source[v]);
    }
    v = own;
  }
}

}  // namespace

CanonicalMesh canonical_mesh(const MeshView& input, const WeldedVertices& welded) {
  std::vector<std::uint32_t> corners(input.indices.size());
  for (std::size_t i = 0; i < corners.size(); ++i) corners[i] = welded.place[input.indices[i]];
  const std::vector<std::uint32_t> opposite = pair_links(corners, welded.points.size());
  CanonicalMesh mesh;
  mesh.first_corner = Walker(input, welded.points, corners, opposite).run();
  mesh.opposite = renumbered(opposite, mesh);
  mesh.indices = per_corner(std::span<const std::uint32_t>(corners), mesh);
  number_places(welded, mesh);
  mesh.materials = per_triangle(input.materials, mesh);
  mesh.density = per_triangle(input.density, mesh);
  mesh.texcoord_indices = per_corner(input.texcoord_indices, mesh);
  mesh.seams = per_corner(input.seams, mesh);
  mesh.polygons = per_triangle(input.polygons, mesh);
  if (!input.seam_weights.empty()) mesh.seam_weights.assign(mesh.places.points.size(), 0);
  for (std::uint32_t c = 0; !input.seam_weights.empty() && c < mesh.indices.size(); ++c) {
    float& own = mesh.seam_weights[mesh.indices[c]];
    own = std::max(own, input.seam_weights[input.indices[mesh.input_corner(c)]]);
  }
  return mesh;
}

}  // namespace atlas
