#include "libatlas/charts/merging/coarse.h"

#include <cmath>
#include <span>
#include <unordered_set>
#include <utility>

#include "libatlas/charts/cells/rims.h"
#include "libatlas/charts/cells/tips.h"
#include "libatlas/charts/merging/fan_centre.h"
#include "libatlas/charts/merging/unroll.h"
#include "libatlas/charts/mesh/border_weight.h"
#include "libatlas/core/degrees.h"
#include "libatlas/core/glm_bridge.h"

namespace atlas {
namespace {

// Arcs longer than this share of the rim get corners in between, so that the fan follows them.
constexpr double kLongArc = 0.26;
// A piece has scan noise if more than kNoisyShare of its edges fold by more than nine degrees
// although its cells have more than kNoisyCell triangles on average. Smooth meshes of that size
// fold by three to five degrees at most edges.
constexpr double kNoisyCosine = 0.988, kNoisyShare = 0.6, kNoisyCell = 20;

class CoarseBuilder {
 public:
  CoarseBuilder(const Topology& topology, double crease_degrees, const Cells& cells, Rims rims)
      : topology_(topology),
        cells_(cells),
        rims_(std::move(rims)),
        crease_angle_(radians(crease_degrees)) {}

  CoarseMesh run() {
    mesh_.cells.resize(cells_.count);
    measure_cells();
    find_noise();
    find_corners();
    for (std::uint32_t k = 0; k < cells_.count; ++k) add_corners(k);
    arc_at_.assign(topology_.opposite.size(), kNoIndex);
    for (std::uint32_t k = 0; k < cells_.count; ++k) add_rim(k);
    for (CoarseCell& cell : mesh_.cells) centre_fan(mesh_, cell);
    return std::move(mesh_);
  }

 private:
  std::uint32_t from(std::uint32_t h) const { return topology_.corner_vertex[h]; }

  void measure_cells() {
    for (std::uint32_t t = 0; t < cells_.of_triangle.size(); ++t) {
      if (cells_.of_triangle[t] == kNoIndex) continue;
      CoarseCell& cell = mesh_.cells[cells_.of_triangle[t]];
      const double area = topology_.areas[t];
      const glm::dvec3 n = to_dvec(topology_.normals[t]);
      const std::uint32_t* v = &topology_.corner_vertex[3 * std::size_t{t}];
      const glm::dvec3 middle = (to_dvec(topology_.points[v[0]]) + to_dvec(topology_.points[v[1]]) +
                                 to_dvec(topology_.points[v[2]])) /
                                3.0;
      cell.area += area;
      cell.centre = from_glm(to_glm(cell.centre) + area * middle);
      cell.normal_sum = from_glm(to_glm(cell.normal_sum) + area * n);
      const double products[6] = {n.x * n.x, n.x * n.y, n.x * n.z, n.y * n.y, n.y * n.z, n.z * n.z};
      for (int i = 0; i < 6; ++i) cell.moments[i] += area * products[i];
    }
    for (CoarseCell& cell : mesh_.cells) {
      if (cell.area > 0) cell.centre = from_glm(to_glm(cell.centre) / cell.area);
      const double length = glm::length(to_glm(cell.normal_sum));
      cell.normal = length > 0 ? from_glm(to_glm(cell.normal_sum) / length) : Vec3d{0, 0, 1};
    }
  }

  // Corners are vertices where three rims meet, or two at the mesh's boundary.
  void find_corners() {
    std::vector<std::uint8_t> count(topology_.points.size(), 0), open(topology_.points.size(), 0);
    for (const std::uint32_t h : rims_.half_edges()) {
      if (count[from(h)] < 3) ++count[from(h)];
      if (topology_.opposite[h] == kNoIndex) open[from(h)] = 1;
    }
    corner_.resize(count.size());
    for (std::size_t v = 0; v < count.size(); ++v) corner_[v] = count[v] + open[v] >= 3;
  }

  // Adds corners along arcs that are long for their cell. Corners belong to vertices, so the cells
  // on both sides get them.
  void add_corners(std::uint32_t k) {
    const std::span<const RimLoop> loops = rims_.loops(k);
    if (loops.empty()) return;
    const RimLoop loop = loops[longest_loop(loops)];
    const auto n = loop.end - loop.begin;
    const std::uint32_t* path = &rims_.path[loop.begin];
    std::uint32_t first = 0;
    while (first < n && !corner_[from(path[first])]) ++first;
    if (first == n) {
      first = 0;
      corner_[from(path[0])] = 1;
    }
    for (std::uint32_t i = 0; i < n;) {
      double length = 0;
      std::uint32_t end = i;
      do {
        length += edge_length(topology_, path[(first + end) % n]);
        ++end;
      } while (end < n && !corner_[from(path[(first + end) % n])]);
      const auto pieces = static_cast<int>(std::ceil(length / (kLongArc * loop.length) - 1e-3));
      double walked = 0;
      int mark = 1;
      for (std::uint32_t j = i; j + 1 < end && mark < pieces; ++j) {
        const double step = edge_length(topology_, path[(first + j) % n]);
        walked += step;
        // If a corner is due at the middle of an edge, the tolerance keeps rounding from choosing
        // its end.
        if (walked + (0.5 + 1e-4) * step < mark * length / pieces) continue;
        corner_[from(path[(first + j + 1) % n])] = 1;
        ++mark;
      }
      i = end;
    }
  }

  void add_rim(std::uint32_t k) {
    CoarseCell& cell = mesh_.cells[k];
    cell.first_slot = static_cast<std::uint32_t>(mesh_.slot_position.size());
    const std::span<const RimLoop> loops = rims_.loops(k);
    if (loops.empty()) return;
    const RimLoop loop = loops[longest_loop(loops)];
    const auto n = loop.end - loop.begin;
    const std::span path(&rims_.path[loop.begin], n);
    std::uint32_t first = 0;
    while (first < n && !corner_[from(path[first])]) ++first;
    for (std::uint32_t i = 0; i < n;) {
      std::uint32_t end = i;
      do ++end;
      while (end < n && !corner_[from(path[(first + end) % n])]);
      add_arc(k, path, first + i, end - i);
      i = end;
    }
    cell.slot_count = static_cast<std::uint32_t>(mesh_.slot_position.size()) - cell.first_slot;
  }

  // Finds the pieces with scan noise, see kNoisyShare.
  void find_noise() {
    struct Fold {
      double sharp = 0, edges = 0, triangles = 0;
      std::uint32_t cells = 0;
    };
    std::vector<Fold> folds(topology_.component_count);
    std::vector<std::uint8_t> counted(cells_.count, 0);
    for (std::uint32_t h = 0; h < topology_.opposite.size(); ++h) {
      const std::uint32_t k = cells_.of_triangle[h / 3], o = topology_.opposite[h];
      if (k == kNoIndex) continue;
      Fold& fold = folds[topology_.component[h / 3]];
      fold.triangles += h % 3 == 0;
      fold.cells += !counted[k];
      counted[k] = 1;
      if (o == kNoIndex || o < h) continue;
      fold.edges += 1;
      fold.sharp += glm::dot(to_dvec(topology_.normals[h / 3]), to_dvec(topology_.normals[o / 3])) <
                    kNoisyCosine;
    }
    noisy_.resize(folds.size());
    for (std::size_t i = 0; i < folds.size(); ++i) {
      noisy_[i] = folds[i].sharp > kNoisyShare * folds[i].edges &&
                  folds[i].triangles > kNoisyCell * folds[i].cells;
    }
  }

  // Returns where a half-edge starts; on noisy pieces, the mean of that vertex and its neighbours.
  glm::dvec3 corner_position(std::uint32_t head) const {
    const auto place = [&](std::uint32_t h) { return to_dvec(topology_.points[from(h)]); };
    if (!noisy_[topology_.component[head / 3]]) return place(head);
    glm::dvec3 sum = place(head);
    int count = 1;
    std::uint32_t h = head;
    do {
      sum += place(next_half_edge(h));
      ++count;
      h = topology_.opposite[previous_half_edge(h)];
    } while (h != kNoIndex && h != head);
    return h == kNoIndex ? place(head) : sum / double(count);
  }

  // Adds `count` half-edges of the closed path around cell k as an arc.
  void add_arc(std::uint32_t k, std::span<const std::uint32_t> path, std::uint32_t begin,
               std::uint32_t count) {
    const auto n = static_cast<std::uint32_t>(path.size());
    const auto at = [&](std::uint32_t i) { return path[(begin + i) % n]; };
    const std::uint32_t head = at(0), tail = at(count - 1);
    const auto slot = static_cast<std::uint32_t>(mesh_.slot_position.size());
    mesh_.slot_position.push_back(from_glm(corner_position(head)));
    mesh_.slot_half_edge.push_back(head);
    const std::uint32_t known =
        topology_.opposite[tail] == kNoIndex ? kNoIndex : arc_at_[topology_.opposite[tail]];
    if (known != kNoIndex) {
      mesh_.arcs[known].slot[1] = slot;
      mesh_.arcs[known].cell[1] = k;
      mesh_.slot_arc.push_back(known);
      for (std::uint32_t i = 0; i < count; ++i) {
        mesh_.rim_half_edges.push_back(at(i));
        mesh_.rim_arcs.push_back(known);
      }
      return;
    }
    CoarseArc arc;
    arc.slot[0] = slot;
    arc.cell[0] = k;
    for (std::uint32_t i = 0; i < count; ++i) {
      const std::uint32_t h = at(i), o = topology_.opposite[h];
      const double length = edge_length(topology_, h);
      arc.length += length;
      mesh_.rim_half_edges.push_back(h);
      mesh_.rim_arcs.push_back(static_cast<std::uint32_t>(mesh_.arcs.size()));
      arc.weight += o == kNoIndex ? length : border_weight(topology_, h, crease_angle_);
    }
    arc_at_[head] = static_cast<std::uint32_t>(mesh_.arcs.size());
    mesh_.slot_arc.push_back(arc_at_[head]);
    mesh_.arcs.push_back(arc);
  }

  const Topology& topology_;
  const Cells& cells_;
  Rims rims_;
  double crease_angle_;
  CoarseMesh mesh_;
  std::vector<std::uint8_t> corner_, noisy_;
  std::vector<std::uint32_t> arc_at_;  // by the half-edge that begins side 0
};

void mark_sharp(const Topology& topology, const std::vector<std::uint32_t>& tips,
                CoarseMesh& mesh) {
  const bool noisy = !topology.calm_normals.empty();
  std::unordered_set<std::uint32_t> tip;
  for (const std::uint32_t h : tips) tip.insert(topology.corner_vertex[h]);
  for (const std::uint32_t h : mesh.slot_half_edge) {
    mesh.slot_sharp.push_back(tip.contains(topology.corner_vertex[h]) ||
                              (!noisy && std::abs(angle_defect(topology, h)) >= kSharpDefect));
  }
}

}  // namespace

CoarseMesh build_coarse(const Topology& topology, double crease_degrees, Cells& cells) {
  const std::vector<std::uint32_t> tips = find_tips(topology);
  divide_at_tips(topology, tips, cells);
  Rims rims = divide_rings(topology, cells);
  CoarseMesh mesh = CoarseBuilder(topology, crease_degrees, cells, std::move(rims)).run();
  mark_sharp(topology, tips, mesh);
  unroll_cells(topology, cells, tips, mesh);
  return mesh;
}

double fan_error(const CoarseMesh& mesh, const CoarseCell& cell) {
  double twice = 0;
  for (std::uint32_t s = cell.first_slot; s < cell.first_slot + cell.slot_count; ++s) {
    const glm::dvec3 centre = to_glm(cell.centre), a = to_glm(mesh.slot_position[s]) - centre,
                     b = to_glm(mesh.slot_position[mesh.next_slot(s, cell)]) - centre;
    twice += glm::length(glm::cross(a, b));
  }
  return cell.area > 0 ? std::abs(0.5 * twice / cell.area - 1) : 0;
}

}  // namespace atlas
