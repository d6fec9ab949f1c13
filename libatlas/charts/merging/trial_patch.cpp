#include "libatlas/charts/merging/trial_patch.h"

#include <algorithm>

namespace atlas {

// Adds cells to places_, breadth-first from those that are in it. If `within_patch`, only cells
// that the last sweep met are added.
void TrialPatch::sweep(const TrialMesh& mesh, bool within_patch, std::size_t cells) {
  const std::uint32_t last = sweeps_++;
  for (const std::uint32_t c : places_) met_[c] = sweeps_;
  for (std::size_t i = 0; i < places_.size() && places_.size() < cells; ++i) {
    for (const std::uint32_t next : mesh.neighbours(places_[i])) {
      if (met_[next] == sweeps_ || (within_patch && met_[next] != last)) continue;
      met_[next] = sweeps_;
      places_.push_back(next);
      if (places_.size() == cells) break;
    }
  }
}

void TrialPatch::take(const TrialMesh& mesh, std::size_t cells, std::span<const Vec2d> uvs) {
  const auto count = static_cast<std::uint32_t>(mesh.cells().size());
  met_.resize(std::max<std::size_t>(met_.size(), count), 0);
  places_.clear();
  for (auto c = static_cast<std::uint32_t>(mesh.first_count()); c < count; ++c)
    places_.push_back(c);
  sweep(mesh, false, cells);
  // A sweep from one end to the other keeps the numbers within a fan close to each other.
  const std::size_t taken = places_.size();
  places_ = {places_.back()};
  sweep(mesh, true, taken);
  number_vertices(mesh);
  uvs_.clear();
  for (const std::uint32_t v : vertex_) uvs_.push_back(uvs[v]);
}

void TrialPatch::number_vertices(const TrialMesh& mesh) {
  const JoinedFans all = mesh.fans();
  outside_.resize(std::max(outside_.size(), mesh.vertex_count()), 0);
  number_.resize(outside_.size());
  for (std::uint32_t c = 0; c < all.cells.size(); ++c) {
    if (met_[c] == sweeps_) continue;
    for (std::uint32_t i = all.first[c]; i < all.first[c + 1]; ++i)
      outside_[all.triangles[i].a] = sweeps_;
  }
  vertex_ = places_;
  cells_.clear();
  first_.assign(1, 0);
  triangles_.clear();
  for (std::uint32_t c = 0; c < places_.size(); ++c) {
    const auto fan = all.triangles.subspan(all.first[places_[c]],
                                           all.first[places_[c] + 1] - all.first[places_[c]]);
    cells_.push_back(all.cells[places_[c]]);
    for (const JoinedFans::Triangle& t : fan) {
      number_[t.a] = kNoIndex;
      triangles_.push_back({t.slot, c, t.a, t.b});
    }
    first_.push_back(static_cast<std::uint32_t>(triangles_.size()));
  }
  for (const bool held : {false, true}) {
    if (held) first_held_ = vertex_.size();
    for (const JoinedFans::Triangle& t : triangles_) {
      if (number_[t.a] != kNoIndex || (outside_[t.a] == sweeps_) != held) continue;
      number_[t.a] = static_cast<std::uint32_t>(vertex_.size());
      vertex_.push_back(t.a);
    }
  }
  for (JoinedFans::Triangle& t : triangles_) {
    t.a = number_[t.a];
    t.b = number_[t.b];
  }
  triangles_.resize(triangles_.size() + JoinedFans::kBeyond);
}

void TrialPatch::give_back(std::span<Vec2d> uvs) const {
  for (std::size_t v = 0; v < vertex_.size(); ++v) uvs[vertex_[v]] = uvs_[v];
}

}  // namespace atlas
