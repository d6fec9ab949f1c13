// Internal: the fans of two charts of the coarse mesh, joined for a trial.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "libatlas/charts/merging/coarse.h"
#include "libatlas/charts/merging/fan_solver.h"

namespace atlas {

// What trials keep of slots and cells; different pieces of the mesh touch different entries.
struct TrialScratch {
  explicit TrialScratch(const CoarseMesh& mesh);
  std::vector<std::uint32_t> slot_class;  // a slot of those it is joined with in the charts so far
  std::vector<std::uint32_t> alias;       // union-find over classes, for the arcs on trial
  std::vector<std::uint32_t> vertex;      // of a class, while vertices are numbered
  std::vector<std::uint32_t> place;       // of a cell on trial
};

class TrialMesh {
 public:
  TrialMesh(const CoarseMesh& mesh, TrialScratch& scratch) : mesh_(mesh), scratch_(scratch) {}

  // The cells of two charts with the arcs `glue` joined, besides those that are already; `joined`
  // (1 an arc) names all of them. The vertices of a fan get numbers close to each other: what is
  // factorised gains by that.
  void assemble(std::span<const std::uint32_t> first, std::span<const std::uint32_t> second,
                std::span<const std::uint32_t> glue, const std::vector<std::uint8_t>& joined);
  // What euler() would be for two charts of which it is known.
  int joined_euler(int first, int second, std::span<const std::uint32_t> glue);
  // The slots so joined stay so.
  void commit();

  JoinedFans fans() const { return {cells_, first_, triangles()}; }
  std::span<const std::uint32_t> cells() const { return cells_; }
  std::size_t first_count() const { return first_count_; }  // cells of the first chart
  std::size_t vertex_count() const { return cells_.size() + class_.size(); }
  std::span<const JoinedFans::Triangle> triangles() const {
    return {triangles_.data(), triangles_.size() - JoinedFans::kBeyond};
  }
  int euler() const { return euler_; }
  // Vertices of the arcs that are not joined.
  std::span<const std::array<std::uint32_t, 2>> border() const { return border_; }
  // Places of the cells that a cell is joined to.
  std::span<const std::uint32_t> neighbours(std::uint32_t place) const {
    return {neighbour_.data() + first_neighbour_[place],
            neighbour_.data() + first_neighbour_[place + 1]};
  }
  bool in_first(std::uint32_t cell) const { return scratch_.place[cell] < first_count_; }

 private:
  std::uint32_t root(std::uint32_t slot);
  void unite(std::uint32_t slot, std::uint32_t other);
  void unite(std::span<const std::uint32_t> glue);
  void part();
  void list_cells(std::span<const std::uint32_t> first, std::span<const std::uint32_t> second);
  void list_triangles(const std::vector<std::uint8_t>& joined);
  void number_vertices();
  void sweep(std::uint32_t start);

  const CoarseMesh& mesh_;
  TrialScratch& scratch_;
  std::vector<std::uint32_t> cells_;
  std::size_t first_count_ = 0;
  std::vector<std::uint32_t> first_;             // triangle of a cell, and one more
  std::vector<JoinedFans::Triangle> triangles_;  // and some beyond
  std::vector<std::uint32_t> class_;             // of a vertex that is no centre
  std::vector<std::array<std::uint32_t, 2>> border_;
  std::vector<std::uint32_t> united_;  // classes with an alias
  // As neighbours() has them; where a cell's begin, and one more.
  std::vector<std::uint32_t> neighbour_, first_neighbour_;
  std::vector<std::uint32_t> queue_, met_;  // of sweeps; met_: 1 a cell, the last that met it
  std::uint32_t sweeps_ = 0;
  int euler_ = 1;
};

}  // namespace atlas
