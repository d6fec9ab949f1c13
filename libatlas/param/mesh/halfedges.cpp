#include "libatlas/param/mesh/halfedges.h"

namespace atlas::param {

void HalfEdges::build(const LocalMesh& mesh) {
  if (mesh.opposite.empty()) return build(mesh.triangles, mesh.positions.size());
  triangles_ = mesh.triangles;
  opposite_ = mesh.opposite;
}

void HalfEdges::build(std::span<const std::array<std::uint32_t, 3>> triangles,
                      std::size_t vertices) {
  triangles_ = triangles;
  const std::uint32_t count = static_cast<std::uint32_t>(3 * triangles_.size());
  first_.assign(vertices + 1, 0);
  for (const auto& tri : triangles_) {
    for (const std::uint32_t v : tri) ++first_[v + 1];
  }
  for (std::size_t v = 1; v < first_.size(); ++v) first_[v] += first_[v - 1];
  // Lists the outgoing half-edges of each vertex. Filling moves first_[v] to the end of v's range.
  out_.resize(count);
  for (std::uint32_t h = 0; h < count; ++h) out_[first_[from(h)]++] = h;
  found_.assign(count, kNoIndex);
  for (std::uint32_t h = 0; h < count; ++h) {
    if (found_[h] != kNoIndex) continue;
    const std::uint32_t g = find_opposite(h);
    if (g == kNoIndex) continue;
    found_[h] = g;
    found_[g] = h;
  }
  opposite_ = found_;
}

// Searches the triangles around the end or the start of h, whichever are fewer; otherwise vertices
// of high valence would take quadratic time.
std::uint32_t HalfEdges::find_opposite(std::uint32_t h) const {
  const std::uint32_t a = from(h), b = to(h);
  const auto outgoing = [&](std::uint32_t v) {
    const std::uint32_t begin = v == 0 ? 0 : first_[v - 1];
    return std::span(out_).subspan(begin, first_[v] - begin);
  };
  const bool at_start = outgoing(a).size() < outgoing(b).size();
  for (const std::uint32_t o : outgoing(at_start ? a : b)) {
    const std::uint32_t g = at_start ? next_half_edge(next_half_edge(o)) : o;
    if (found_[g] == kNoIndex && from(g) == b && to(g) == a && g != h) return g;
  }
  return kNoIndex;
}

void HalfEdges::border(Border& out) const {
  out.half_edges.clear();
  out.loop_start.assign(1, 0);
  std::vector<bool> seen(opposite_.size(), false);
  for (std::uint32_t h = 0; h < opposite_.size(); ++h) {
    if (opposite_[h] != kNoIndex || seen[h]) continue;
    for (std::uint32_t g = h; !seen[g]; g = next_border(g)) {
      seen[g] = true;
      out.half_edges.push_back(g);
    }
    out.loop_start.push_back(static_cast<std::uint32_t>(out.half_edges.size()));
  }
}

std::vector<std::array<std::uint32_t, 2>> border_edges(
    std::span<const std::array<std::uint32_t, 3>> triangles, std::size_t vertices) {
  HalfEdges half_edges;
  half_edges.build(triangles, vertices);
  std::vector<std::array<std::uint32_t, 2>> edges;
  for (std::uint32_t h = 0; h < 3 * triangles.size(); ++h)
    if (half_edges.opposite(h) == kNoIndex) edges.push_back({half_edges.from(h), half_edges.to(h)});
  return edges;
}

}  // namespace atlas::param
