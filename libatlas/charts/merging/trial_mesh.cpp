#include "libatlas/charts/merging/trial_mesh.h"

#include <algorithm>
#include <numeric>

namespace atlas {
namespace {

// Where more than this many fans meet at one vertex, as around the hub of a wheel, that vertex gets
// one of the last numbers. With an early one, all later rows of the factor would reach back to it.
constexpr std::uint32_t kHubFans = 24;

}  // namespace

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

void TrialMesh::unite(std::span<const std::uint32_t> glue) {
  for (const std::uint32_t arc : glue) {
    const CoarseArc& a = mesh_.arcs[arc];
    unite(a.slot[0], mesh_.next_slot(a.slot[1], mesh_.cells[a.cell[1]]));
    unite(mesh_.next_slot(a.slot[0], mesh_.cells[a.cell[0]]), a.slot[1]);
  }
}

void TrialMesh::part() {
  for (const std::uint32_t c : united_) scratch_.alias[c] = c;
  united_.clear();
}

int TrialMesh::joined_euler(int first, int second, std::span<const std::uint32_t> glue) {
  unite(glue);
  const auto fewer_vertices = static_cast<int>(united_.size());
  part();
  return first + second + static_cast<int>(glue.size()) - fewer_vertices;
}

void TrialMesh::assemble(const TrialPair& charts, const std::vector<std::uint8_t>& joined) {
  list_cells(charts.first, charts.second);
  unite(charts.glue);
  list_triangles(joined);
  number_vertices();
  part();
  for (const std::uint32_t c : class_) scratch_.vertex[c] = kNoIndex;
}

void TrialMesh::list_cells(std::span<const std::uint32_t> first,
                           std::span<const std::uint32_t> second) {
  cells_.assign(first.begin(), first.end());
  cells_.insert(cells_.end(), second.begin(), second.end());
  first_count_ = first.size();
  first_.resize(cells_.size() + 1);
  first_[0] = 0;
  for (std::uint32_t c = 0; c < cells_.size(); ++c) {
    scratch_.place[cells_[c]] = c;
    first_[c + 1] = first_[c] + mesh_.cells[cells_[c]].slot_count;
  }
  triangles_.resize(first_.back() + JoinedFans::kBeyond);
}

// Until vertices are numbered, a triangle stores its slot class in `a` and the index of the cell
// across in `b`.
void TrialMesh::list_triangles(const std::vector<std::uint8_t>& joined) {
  neighbour_.clear();
  first_neighbour_.clear();
  JoinedFans::Triangle* t = triangles_.data();
  for (std::uint32_t c = 0; c < cells_.size(); ++c) {
    const std::uint32_t k = cells_[c];
    const CoarseCell& cell = mesh_.cells[k];
    first_neighbour_.push_back(static_cast<std::uint32_t>(neighbour_.size()));
    for (std::uint32_t s = cell.first_slot; s < cell.first_slot + cell.slot_count; ++s) {
      const std::uint32_t arc = mesh_.slot_arc[s];
      std::uint32_t across = kNoIndex;
      if (joined[arc]) {
        const auto& sides = mesh_.arcs[arc].cell;
        across = scratch_.place[sides[0] == k ? sides[1] : sides[0]];
        neighbour_.push_back(across);
      }
      *t++ = {s, c, root(s), across};
    }
  }
  first_neighbour_.push_back(static_cast<std::uint32_t>(neighbour_.size()));
  std::fill_n(t, JoinedFans::kBeyond, JoinedFans::Triangle{});
}

// Numbers the vertices by cells, in reverse Cuthill-McKee order: breadth-first from the cell that
// an earlier sweep found farthest away, then backwards.
void TrialMesh::number_vertices() {
  met_.resize(std::max(met_.size(), cells_.size()), 0);
  sweep(0);
  sweep(queue_.back());
  for (std::uint32_t c = 0; c < cells_.size() && queue_.size() < cells_.size(); ++c) {
    if (met_[c] != sweeps_) queue_.push_back(c);  // joined to none of the others
  }
  class_.clear();
  border_.clear();
  const auto cells = static_cast<std::uint32_t>(cells_.size());
  for (auto c = queue_.rbegin(); c != queue_.rend(); ++c) {
    JoinedFans::Triangle *const begin = &triangles_[first_[*c]], *const end =
                                                                     &triangles_[first_[*c + 1]];
    for (JoinedFans::Triangle* t = begin; t != end; ++t) {
      std::uint32_t& vertex = scratch_.vertex[t->a];
      if (vertex == kNoIndex) {
        vertex = cells + static_cast<std::uint32_t>(class_.size());
        class_.push_back(t->a);
      }
      t->a = vertex;
    }
    for (JoinedFans::Triangle* t = begin; t != end; ++t) {
      const bool open = t->b == kNoIndex;
      t->b = (t + 1 == end ? begin : t + 1)->a;
      if (open) border_.push_back({t->a, t->b});
    }
  }
  if (cells_.size() > kHubFans) put_hubs_last();
  const auto count = static_cast<int>(first_.back());
  const int joined_sides = count - static_cast<int>(border_.size());
  euler_ = static_cast<int>(vertex_count()) + joined_sides / 2 - count;
}

void TrialMesh::put_hubs_last() {
  const auto cells = static_cast<std::uint32_t>(cells_.size());
  const std::span<JoinedFans::Triangle> all(triangles_.data(), first_.back());
  number_.assign(class_.size(), 0);
  for (const JoinedFans::Triangle& t : all) ++number_[t.a - cells];
  const auto hubs = static_cast<std::uint32_t>(
      std::count_if(number_.begin(), number_.end(), [](std::uint32_t n) { return n > kHubFans; }));
  if (hubs == 0) return;
  const std::vector<std::uint32_t> before = class_;
  auto next = static_cast<std::uint32_t>(before.size()) - hubs, last = next;
  next = 0;
  for (std::size_t v = 0; v < before.size(); ++v) {
    number_[v] = number_[v] > kHubFans ? last++ : next++;
    class_[number_[v]] = before[v];
  }
  const auto renumber = [&](std::uint32_t& v) { v = cells + number_[v - cells]; };
  for (JoinedFans::Triangle& t : all) {
    renumber(t.a);
    renumber(t.b);
  }
  for (std::array<std::uint32_t, 2>& side : border_) {
    for (std::uint32_t& v : side) renumber(v);
  }
}

// Fills queue_ with the cells, breadth-first from `start`.
void TrialMesh::sweep(std::uint32_t start) {
  ++sweeps_;
  queue_.assign(1, start);
  met_[start] = sweeps_;
  for (std::size_t i = 0; i < queue_.size(); ++i) {
    const std::uint32_t c = queue_[i];
    for (std::uint32_t n = first_neighbour_[c]; n < first_neighbour_[c + 1]; ++n) {
      const std::uint32_t next = neighbour_[n];
      if (met_[next] == sweeps_) continue;
      met_[next] = sweeps_;
      queue_.push_back(next);
    }
  }
}

void TrialMesh::commit() {
  for (const JoinedFans::Triangle& t : triangles()) {
    scratch_.slot_class[t.slot] = class_[t.a - cells_.size()];
  }
}

}  // namespace atlas
