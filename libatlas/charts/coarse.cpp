#include "libatlas/charts/coarse.h"

#include <algorithm>
#include <cmath>

#include "libatlas/charts/fan_centre.h"
#include "libatlas/core/glm_bridge.h"

namespace atlas {
namespace {

// A hole of the mesh whose rim is shorter than this share of its cell's is passed over.
constexpr double kSmallHole = 0.35;
// Arcs longer than this share of the rim get corners in between, so that the fan follows them.
constexpr double kLongArc = 0.26;
// Scan noise: most edges fold by more than nine degrees, though a cell has many triangles. Smooth
// meshes of that size fold by three to five at most edges.
constexpr double kNoisyCosine = 0.988, kNoisyShare = 0.6, kNoisyCell = 20;
constexpr int kDivideRounds = 8;

struct Loop {
  std::uint32_t begin, end;  // range of half-edges
  double length;
  bool open;  // all of it on the mesh's border
};

// The borders of cells as loops of half-edges.
class Rims {
 public:
  Rims(const Topology& topology, const Cells& cells) : topology_(topology), cells_(cells) {}

  void run() {
    const auto n = static_cast<std::uint32_t>(topology_.opposite.size());
    first_.assign(cells_.count + 2, 0);
    for (std::uint32_t h = 0; h < n; ++h) {
      if (on_rim(h)) ++first_[cell(h) + 2];
    }
    for (std::size_t i = 2; i < first_.size(); ++i) first_[i] += first_[i - 1];
    rim_.resize(first_.back());
    for (std::uint32_t h = 0; h < n; ++h) {
      if (on_rim(h)) rim_[first_[cell(h) + 1]++] = h;
    }
    first_.pop_back();
    seen_.assign(n, 0);
  }

  std::uint32_t cell(std::uint32_t h) const { return cells_.of_triangle[h / 3]; }
  std::uint32_t across(std::uint32_t h) const {
    const std::uint32_t o = topology_.opposite[h];
    return o == kNoIndex ? kNoIndex : cell(o);
  }
  bool on_rim(std::uint32_t h) const { return cell(h) != kNoIndex && across(h) != cell(h); }

  // The loops of one cell, over `path`; each call walks anew.
  const std::vector<Loop>& loops(std::uint32_t k) {
    loops_.clear();
    path.clear();
    for (std::uint32_t i = first_[k]; i < first_[k + 1]; ++i) {
      if (!seen_[rim_[i]]) walk(rim_[i]);
    }
    for (std::uint32_t i = first_[k]; i < first_[k + 1]; ++i) seen_[rim_[i]] = 0;
    return loops_;
  }
  const std::vector<std::uint32_t>& half_edges() const { return rim_; }

  std::vector<std::uint32_t> path;

 private:
  void walk(std::uint32_t start) {
    Loop loop{static_cast<std::uint32_t>(path.size()), 0, 0, true};
    std::uint32_t h = start;
    while (!seen_[h]) {
      seen_[h] = 1;
      path.push_back(h);
      loop.open = loop.open && topology_.opposite[h] == kNoIndex;
      loop.length += edge_length(h);
      h = next_half_edge(h);
      while (!on_rim(h)) h = next_half_edge(topology_.opposite[h]);
    }
    loop.end = static_cast<std::uint32_t>(path.size());
    loops_.push_back(loop);
  }

 public:
  double edge_length(std::uint32_t h) const {
    return glm::distance(to_dvec(topology_.points[topology_.corner_vertex[h]]),
                         to_dvec(topology_.points[topology_.corner_vertex[next_half_edge(h)]]));
  }

 private:
  const Topology& topology_;
  const Cells& cells_;
  std::vector<std::uint32_t> first_, rim_;
  std::vector<std::uint8_t> seen_;
  std::vector<Loop> loops_;
};

std::size_t longest_loop(const std::vector<Loop>& loops) {
  std::size_t longest = 0;
  for (std::size_t i = 1; i < loops.size(); ++i) {
    if (loops[i].length > loops[longest].length * (1 + 1e-4)) longest = i;
  }
  return longest;
}

bool has_one_rim(const std::vector<Loop>& loops) {
  if (loops.empty()) return false;
  const std::size_t longest = longest_loop(loops);
  for (std::size_t i = 0; i < loops.size(); ++i) {
    if (i == longest) continue;
    if (!loops[i].open || loops[i].length > kSmallHole * loops[longest].length) return false;
  }
  return true;
}

// Divides cells in two by breadth-first growth from two triangles far from each other.
class Divider {
 public:
  Divider(const Topology& topology, Cells& cells) : topology_(topology), cells_(cells) {}

  void divide(const std::vector<std::uint32_t>& bad) {
    std::vector<std::vector<std::uint32_t>> lists(bad.size());
    std::vector<std::uint32_t> place(cells_.count, kNoIndex);
    for (std::uint32_t i = 0; i < bad.size(); ++i) place[bad[i]] = i;
    for (std::uint32_t t = 0; t < cells_.of_triangle.size(); ++t) {
      const std::uint32_t k = cells_.of_triangle[t];
      if (k != kNoIndex && place[k] != kNoIndex) lists[place[k]].push_back(t);
    }
    mark_.resize(cells_.of_triangle.size(), 0);
    for (const auto& list : lists) {
      if (list.size() > 1) divide_one(list);
    }
  }

 private:
  void divide_one(const std::vector<std::uint32_t>& list) {
    const std::uint32_t old = cells_.of_triangle[list[0]];
    for (const std::uint32_t t : list) mark_[t] = 0;
    flood({list[0]}, old, 1);
    const std::uint32_t a = queue_.back();
    flood({a}, old, 2);
    const std::uint32_t b = queue_.back();
    if (a == b) return;
    // Both grow at once; who came first keeps a triangle.
    queue_ = {a, b};
    mark_[a] = 3;
    mark_[b] = 4;
    const std::uint32_t fresh = cells_.count++;
    for (std::size_t i = 0; i < queue_.size(); ++i) {
      const std::uint32_t t = queue_[i];
      for (std::uint32_t h = 3 * t; h < 3 * t + 3; ++h) {
        const std::uint32_t o = topology_.opposite[h];
        if (o == kNoIndex || cells_.of_triangle[o / 3] != old || mark_[o / 3] >= 3) continue;
        mark_[o / 3] = mark_[t];
        queue_.push_back(o / 3);
      }
    }
    for (const std::uint32_t t : queue_) {
      if (mark_[t] == 4) cells_.of_triangle[t] = fresh;
    }
  }

  void flood(std::vector<std::uint32_t> start, std::uint32_t cell, std::uint8_t mark) {
    queue_ = std::move(start);
    for (const std::uint32_t t : queue_) mark_[t] = mark;
    for (std::size_t i = 0; i < queue_.size(); ++i) {
      for (std::uint32_t h = 3 * queue_[i]; h < 3 * queue_[i] + 3; ++h) {
        const std::uint32_t o = topology_.opposite[h];
        if (o == kNoIndex || cells_.of_triangle[o / 3] != cell || mark_[o / 3] == mark) continue;
        mark_[o / 3] = mark;
        queue_.push_back(o / 3);
      }
    }
  }

  const Topology& topology_;
  Cells& cells_;
  std::vector<std::uint8_t> mark_;
  std::vector<std::uint32_t> queue_;
};

void divide_rings(const Topology& topology, Cells& cells) {
  for (int round = 0; round < kDivideRounds; ++round) {
    Rims rims(topology, cells);
    rims.run();
    std::vector<std::uint32_t> bad;
    for (std::uint32_t k = 0; k < cells.count; ++k) {
      if (!has_one_rim(rims.loops(k))) bad.push_back(k);
    }
    if (bad.empty()) return;
    Divider(topology, cells).divide(bad);
  }
}

class CoarseBuilder {
 public:
  CoarseBuilder(const Topology& topology, double crease_degrees, const Cells& cells)
      : topology_(topology),
        cells_(cells),
        rims_(topology, cells),
        crease_cosine_(std::cos(crease_degrees * M_PI / 180)) {}

  CoarseMesh run() {
    rims_.run();
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

  // A vertex where three rims meet, or two at the mesh's border.
  void find_corners() {
    std::vector<std::uint8_t> count(topology_.points.size(), 0), open(topology_.points.size(), 0);
    for (const std::uint32_t h : rims_.half_edges()) {
      if (count[from(h)] < 3) ++count[from(h)];
      if (topology_.opposite[h] == kNoIndex) open[from(h)] = 1;
    }
    corner_.resize(count.size());
    for (std::size_t v = 0; v < count.size(); ++v) corner_[v] = count[v] + open[v] >= 3;
  }

  // Corners along arcs that are long for their cell. Both sides see them: they belong to vertices.
  void add_corners(std::uint32_t k) {
    const auto& loops = rims_.loops(k);
    if (loops.empty()) return;
    const Loop loop = loops[longest_loop(loops)];
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
        length += rims_.edge_length(path[(first + end) % n]);
        ++end;
      } while (end < n && !corner_[from(path[(first + end) % n])]);
      const auto pieces = static_cast<int>(std::ceil(length / (kLongArc * loop.length) - 1e-3));
      double walked = 0;
      int mark = 1;
      for (std::uint32_t j = i; j + 1 < end && mark < pieces; ++j) {
        const double step = rims_.edge_length(path[(first + j) % n]);
        walked += step;
        // The middle of an edge may be the very place: rounding must not choose the corner.
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
    const auto& loops = rims_.loops(k);
    if (loops.empty()) return;
    const Loop loop = loops[longest_loop(loops)];
    const auto n = loop.end - loop.begin;
    const std::uint32_t* path = &rims_.path[loop.begin];
    std::uint32_t first = 0;
    while (first < n && !corner_[from(path[first])]) ++first;
    for (std::uint32_t i = 0; i < n;) {
      std::uint32_t end = i;
      do ++end;
      while (end < n && !corner_[from(path[(first + end) % n])]);
      add_arc(k, path[(first + i) % n], path[(first + end - 1) % n], path, n, first + i, end - i);
      i = end;
    }
    cell.slot_count = static_cast<std::uint32_t>(mesh_.slot_position.size()) - cell.first_slot;
  }

  // Pieces with scan noise, see kNoisyShare.
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

  // Where a half-edge starts; on noisy pieces the mean of the vertices around.
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

  void add_arc(std::uint32_t k, std::uint32_t head, std::uint32_t tail, const std::uint32_t* path,
               std::uint32_t n, std::uint32_t begin, std::uint32_t count) {
    const auto slot = static_cast<std::uint32_t>(mesh_.slot_position.size());
    mesh_.slot_position.push_back(from_glm(corner_position(head)));
    const std::uint32_t known =
        topology_.opposite[tail] == kNoIndex ? kNoIndex : arc_at_[topology_.opposite[tail]];
    if (known != kNoIndex) {
      mesh_.arcs[known].slot[1] = slot;
      mesh_.arcs[known].cell[1] = k;
      mesh_.slot_arc.push_back(known);
      for (std::uint32_t i = 0; i < count; ++i) {
        mesh_.rim_half_edges.push_back(path[(begin + i) % n]);
        mesh_.rim_arcs.push_back(known);
      }
      return;
    }
    CoarseArc arc;
    arc.slot[0] = slot;
    arc.cell[0] = k;
    for (std::uint32_t i = 0; i < count; ++i) {
      const std::uint32_t h = path[(begin + i) % n], o = topology_.opposite[h];
      const double length = rims_.edge_length(h);
      arc.length += length;
      mesh_.rim_half_edges.push_back(h);
      mesh_.rim_arcs.push_back(static_cast<std::uint32_t>(mesh_.arcs.size()));
      if (o != kNoIndex && glm::dot(to_dvec(topology_.calm_normal(h / 3)),
                                    to_dvec(topology_.calm_normal(o / 3))) < crease_cosine_) {
        arc.crease += length;
      }
    }
    arc_at_[head] = static_cast<std::uint32_t>(mesh_.arcs.size());
    mesh_.slot_arc.push_back(arc_at_[head]);
    mesh_.arcs.push_back(arc);
  }

  const Topology& topology_;
  const Cells& cells_;
  Rims rims_;
  double crease_cosine_;
  CoarseMesh mesh_;
  std::vector<std::uint8_t> corner_, noisy_;
  std::vector<std::uint32_t> arc_at_;  // by the half-edge that begins side 0
};

}  // namespace

CoarseMesh build_coarse(const Topology& topology, double crease_degrees, Cells& cells) {
  divide_rings(topology, cells);
  return CoarseBuilder(topology, crease_degrees, cells).run();
}

}  // namespace atlas
