// Internal: TrialMesh, the fans of two charts of the coarse mesh, joined for a trial.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "libatlas/charts/merging/coarse.h"
#include "libatlas/charts/merging/fan_solver.h"

namespace atlas {

// Data of slots and cells that trials share. Different pieces of the mesh use different entries.
struct TrialScratch {
  explicit TrialScratch(const CoarseMesh& mesh);
  // One per slot: the representative of the slots that it is joined with in the charts so far.
  std::vector<std::uint32_t> slot_class;
  std::vector<std::uint32_t> alias;   // union-find over classes, for the arcs on trial
  std::vector<std::uint32_t> vertex;  // of a class, while vertices are numbered
  std::vector<std::uint32_t> place;   // of a cell on trial: its index among them
};

// Two charts by their cells, and the arcs along which they are to be joined. `second` may be empty.
struct TrialPair {
  std::span<const std::uint32_t> first, second, glue;
};

class TrialMesh {
 public:
  TrialMesh(const CoarseMesh& mesh, TrialScratch& scratch) : mesh_(mesh), scratch_(scratch) {}

  // Joins two charts, in addition to the arcs joined already; `joined` (one per arc) is set for all
  // of these. The vertices of a fan get numbers close to each other, which makes factorization
  // cheaper.
  void assemble(const TrialPair& charts, const std::vector<std::uint8_t>& joined);
  // Returns what euler() would be for two charts whose own values are given.
  int joined_euler(int first, int second, std::span<const std::uint32_t> glue);
  // Makes the slots joined on trial stay joined.
  void commit();

  JoinedFans fans() const { return {cells_, first_, triangles()}; }
  std::span<const std::uint32_t> cells() const { return cells_; }
  std::size_t first_count() const { return first_count_; }  // cells of the first chart
  std::size_t vertex_count() const { return cells_.size() + class_.size(); }
  std::span<const JoinedFans::Triangle> triangles() const {
    return {triangles_.data(), triangles_.size() - JoinedFans::kBeyond};
  }
  int euler() const { return euler_; }
  // The vertices of each arc that is not joined.
  std::span<const std::array<std::uint32_t, 2>> border() const { return border_; }
  bool in_first(std::uint32_t cell) const { return scratch_.place[cell] < first_count_; }

 private:
  std::uint32_t root(std::uint32_t slot);
  void unite(std::uint32_t slot, std::uint32_t other);
  void unite(std::span<const std::uint32_t> glue);
  void part();
  void list_cells(std::span<const std::uint32_t> first, std::span<const std::uint32_t> second);
  void list_triangles(const std::vector<std::uint8_t>& joined);
  void number_vertices();
  void put_hubs_last();
  void sweep(std::uint32_t start);

  const CoarseMesh& mesh_;
  TrialScratch& scratch_;
  std::vector<std::uint32_t> cells_;
  std::size_t first_count_ = 0;
  std::vector<std::uint32_t> first_;             // first triangle of each cell, and the end
  std::vector<JoinedFans::Triangle> triangles_;  // and kBeyond more
  std::vector<std::uint32_t> class_;             // of each vertex that is not a centre
  std::vector<std::array<std::uint32_t, 2>> border_;
  std::vector<std::uint32_t> united_;  // classes with an alias
  // The indices of the cells that each cell is joined to; where those of each begin, and the end.
  std::vector<std::uint32_t> neighbour_, first_neighbour_;
  // Scratch of sweeps; met_, one per cell, is the last sweep that met it.
  std::vector<std::uint32_t> queue_, met_;
  std::vector<std::uint32_t> number_;  // scratch, one per vertex that is not a centre
  std::uint32_t sweeps_ = 0;
  int euler_ = 1;
};

}  // namespace atlas
