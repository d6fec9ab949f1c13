// Internal: the surroundings of a small chart that is joined to a large one.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "libatlas/charts/merging/trial_mesh.h"

namespace atlas {

// The cells of a trial that are nearest to its second chart, and that one itself: what a descent
// changes. With their own numbers for vertices, those last that other cells have, too, which are
// held.
class TrialPatch {
 public:
  // Of so many cells, if the trial has more. `uvs`: 1 a vertex of the trial.
  void take(const TrialMesh& mesh, std::size_t cells, std::span<const Vec2d> uvs);

  JoinedFans fans() const {
    return {cells_, first_, {triangles_.data(), triangles_.size() - JoinedFans::kBeyond}};
  }
  std::size_t first_held() const { return first_held_; }
  std::span<Vec2d> uvs() { return uvs_; }  // 1 a vertex of the patch
  void give_back(std::span<Vec2d> uvs) const;

 private:
  void sweep(const TrialMesh& mesh, bool within_patch, std::size_t cells);
  void number_vertices(const TrialMesh& mesh);

  std::vector<std::uint32_t> places_;         // of its cells in the trial
  std::vector<std::uint32_t> vertex_;         // 1 a vertex: the trial's
  std::vector<std::uint32_t> cells_, first_;  // as in JoinedFans
  std::vector<JoinedFans::Triangle> triangles_;
  std::vector<Vec2d> uvs_;
  std::size_t first_held_ = 0;
  // Of the trial, 1 a cell: the last sweep that met it; 1 a vertex: the last patch outside which a
  // cell has it, and its number in the patch.
  std::vector<std::uint32_t> met_, outside_, number_;
  std::uint32_t sweeps_ = 0;
};

}  // namespace atlas
