#include "libatlas/param/halfedges.h"

namespace atlas::param {

void HalfEdges::build(const LocalMesh& mesh) {
  triangles_ = mesh.triangles;
  opposite_ = mesh.opposite;
  if (!opposite_.empty()) return;
  const std::uint32_t count = static_cast<std::uint32_t>(3 * triangles_.size());
  first_.assign(mesh.positions.size() + 1, 0);
  for (const auto& tri : triangles_) {
    for (const std::uint32_t v : tri) ++first_[v + 1];
  }
  for (std::size_t v = 1; v < first_.size(); ++v) first_[v] += first_[v - 1];
  // Outgoing half-edges of each vertex; filling moves first_[v] to the end of v's range.
  out_.resize(count);
  for (std::uint32_t h = 0; h < count; ++h) out_[first_[from(h)]++] = h;
  found_.assign(count, none);
  for (std::uint32_t h = 0; h < count; ++h) {
    if (found_[h] != none) continue;
    const std::uint32_t a = from(h), b = to(h);
    for (std::uint32_t i = b == 0 ? 0 : first_[b - 1]; i < first_[b]; ++i) {
      const std::uint32_t g = out_[i];
      if (found_[g] == none && to(g) == a && g != h) {
        found_[h] = g;
        found_[g] = h;
        break;
      }
    }
  }
  opposite_ = found_;
}

void HalfEdges::border(Border& out) const {
  out.half_edges.clear();
  out.loop_start.assign(1, 0);
  std::vector<bool> seen(opposite_.size(), false);
  for (std::uint32_t h = 0; h < opposite_.size(); ++h) {
    if (opposite_[h] != none || seen[h]) continue;
    for (std::uint32_t g = h; !seen[g]; g = next_border(g)) {
      seen[g] = true;
      out.half_edges.push_back(g);
    }
    out.loop_start.push_back(static_cast<std::uint32_t>(out.half_edges.size()));
  }
}

}  // namespace atlas::param
