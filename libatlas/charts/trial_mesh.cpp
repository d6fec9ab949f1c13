#include "libatlas/charts/trial_mesh.h"

#include <algorithm>
#include <numeric>

namespace atlas {

TrialScratch::TrialScratch(const CoarseMesh& mesh)
    : slot_class(mesh.slot_position.size()),
      alias(slot_class.size()),
      vertex(slot_class.size(), kNoIndex),
      place(mesh.cells.size(), kNoIndex) {
  std::iota(slot_class.begin(), slot_class.end(), 0u);
  std::iota(alias.begin(), alias.end(), 0u);
}

std::uint32_t TrialMesh::root(std::uint32_t slot) {
  std::vector<std::uint32_t>& alias = scratch_.alias;
  std::uint32_t c = scratch_.slot_class[slot];
  while (alias[c] != c) c = alias[c];
  return c;
}

void TrialMesh::unite(std::uint32_t slot, std::uint32_t other) {
  const std::uint32_t a = root(slot), b = root(other);
  if (a == b) return;
  scratch_.alias[a] = b;
  united_.push_back(a);
}

void TrialMesh::assemble(std::span<const std::uint32_t> first,
                         std::span<const std::uint32_t> second, std::span<const std::uint32_t> glue,
                         const std::vector<std::uint8_t>& joined) {
  cells_.assign(first.begin(), first.end());
  cells_.insert(cells_.end(), second.begin(), second.end());
  first_count_ = first.size();
  for (std::uint32_t c = 0; c < cells_.size(); ++c) scratch_.place[cells_[c]] = c;
  for (const std::uint32_t arc : glue) {
    const CoarseArc& a = mesh_.arcs[arc];
    unite(a.slot[0], mesh_.next_slot(a.slot[1], mesh_.cells[a.cell[1]]));
    unite(mesh_.next_slot(a.slot[0], mesh_.cells[a.cell[0]]), a.slot[1]);
  }
  list_triangles(joined);
  for (const std::uint32_t c : united_) scratch_.alias[c] = c;
  united_.clear();
  for (const std::uint32_t c : class_) scratch_.vertex[c] = kNoIndex;
}

void TrialMesh::list_triangles(const std::vector<std::uint8_t>& joined) {
  triangles_.clear();
  across_.clear();
  first_.clear();
  class_.clear();
  border_.clear();
  auto vertices = static_cast<std::uint32_t>(cells_.size());
  for (std::uint32_t c = 0; c < cells_.size(); ++c) {
    const std::uint32_t k = cells_[c];
    const CoarseCell& cell = mesh_.cells[k];
    first_.push_back(static_cast<std::uint32_t>(triangles_.size()));
    for (std::uint32_t s = cell.first_slot; s < cell.first_slot + cell.slot_count; ++s) {
      const std::uint32_t own = root(s);
      std::uint32_t& vertex = scratch_.vertex[own];
      if (vertex == kNoIndex) {
        vertex = vertices++;
        class_.push_back(own);
      }
      triangles_.push_back({s, c, vertex, 0});
    }
    for (std::size_t i = first_.back(); i < triangles_.size(); ++i) {
      JoinedFans::Triangle& t = triangles_[i];
      t.b = triangles_[i + 1 == triangles_.size() ? first_.back() : i + 1].a;
      const std::uint32_t arc = mesh_.slot_arc[t.slot];
      if (joined[arc]) {
        const auto& sides = mesh_.arcs[arc].cell;
        across_.push_back(scratch_.place[sides[0] == k ? sides[1] : sides[0]]);
      } else {
        across_.push_back(kNoIndex);
        border_.push_back({t.a, t.b});
      }
    }
  }
  first_.push_back(static_cast<std::uint32_t>(triangles_.size()));
  const auto joined_sides = static_cast<int>(triangles_.size() - border_.size());
  euler_ = static_cast<int>(vertices) + joined_sides / 2 - static_cast<int>(triangles_.size());
}

// By cells, breadth-first from one end of the charts, the cell farthest from any, and back (reverse
// Cuthill-McKee).
void TrialMesh::order(std::vector<Vec2d>& uvs) {
  sweep(0);
  sweep(queue_.back());
  const auto cells = static_cast<std::uint32_t>(cells_.size());
  renumber_.assign(vertex_count(), kNoIndex);
  std::uint32_t vertices = cells;
  for (auto c = queue_.rbegin(); c != queue_.rend(); ++c) {
    for (std::uint32_t i = first_[*c]; i < first_[*c + 1]; ++i) {
      std::uint32_t& vertex = renumber_[triangles_[i].a];
      if (vertex == kNoIndex) vertex = vertices++;
    }
  }
  for (JoinedFans::Triangle& t : triangles_) {
    t.a = renumber_[t.a];
    t.b = renumber_[t.b];
  }
  for (auto& [a, b] : border_) {
    a = renumber_[a];
    b = renumber_[b];
  }
  queue_ = class_;
  old_uvs_ = uvs;
  for (std::uint32_t v = cells; v < vertices; ++v) {
    class_[renumber_[v] - cells] = queue_[v - cells];
    uvs[renumber_[v]] = old_uvs_[v];
  }
}

// Fills queue_.
void TrialMesh::sweep(std::uint32_t start) {
  met_.assign(cells_.size(), 0);
  queue_.assign(1, start);
  met_[start] = 1;
  for (std::size_t i = 0; i < queue_.size(); ++i) {
    for (std::uint32_t t = first_[queue_[i]]; t < first_[queue_[i] + 1]; ++t) {
      if (across_[t] == kNoIndex || met_[across_[t]]) continue;
      met_[across_[t]] = 1;
      queue_.push_back(across_[t]);
    }
  }
}

void TrialMesh::commit() {
  for (const JoinedFans::Triangle& t : triangles_) {
    scratch_.slot_class[t.slot] = class_[t.a - cells_.size()];
  }
}

}  // namespace atlas
