// Internal: TrialPatch, the surroundings of a small chart that is joined to a large one.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "libatlas/charts/merging/trial_mesh.h"

namespace atlas {

// The second chart of a trial and the cells nearest to it, which are what a descent changes. The
// patch numbers its own vertices. Those shared with other cells come last, and are held.
class TrialPatch {
 public:
  // Takes this number of cells, if the trial has more. `uvs`: one per vertex of the trial.
  void take(const TrialMesh& mesh, std::size_t cells, std::span<const Vec2d> uvs);

  JoinedFans fans() const {
    return {cells_, first_, {triangles_.data(), triangles_.size() - JoinedFans::kBeyond}};
  }
  std::size_t first_held() const { return first_held_; }
  std::span<Vec2d> uvs() { return uvs_; }  // one per vertex of the patch
  void give_back(std::span<Vec2d> uvs) const;

 private:
  void sweep(const TrialMesh& mesh, bool within_patch, std::size_t cells);
  void number_vertices(const TrialMesh& mesh);

  std::vector<std::uint32_t> places_;         // indices of its cells in the trial
  std::vector<std::uint32_t> vertex_;         // one per vertex: its vertex in the trial
  std::vector<std::uint32_t> cells_, first_;  // as in JoinedFans
  std::vector<JoinedFans::Triangle> triangles_;
  std::vector<Vec2d> uvs_;
  std::size_t first_held_ = 0;
  // Of the trial. One per cell: the last sweep that met it. One per vertex: the last patch that a
  // cell outside of it shares the vertex with, and its number in the patch.
  std::vector<std::uint32_t> met_, outside_, number_;
  std::uint32_t sweeps_ = 0;
};

}  // namespace atlas
