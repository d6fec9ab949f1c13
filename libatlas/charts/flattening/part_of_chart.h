// Internal: makes some triangles of a flat chart a chart of their own.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "libatlas/charts/flattening/flatten.h"

namespace atlas {

// Returns those triangles with their coordinates and vertices, renumbered. Nothing is measured.
FlatChart take_triangles(const FlatChart& whole, std::span<const std::uint32_t> triangles);

// Measures piece.distortion; `mesh` is the piece's own, relative to any origin. If it exceeds
// max_stretch, relaxes the coordinates, if that brings them within it.
void keep_to_bound(const LocalMesh& mesh, double max_stretch, FlatChart& piece);

// Turns a piece as orient_for_packing() does, and measures its size.
void turn_for_packing(FlatChart& piece);

// Returns those triangles as a chart; `triangles` are indices into whole.triangles, ascending, at
// least one. They keep their coordinates except for the turn for packing, or are relaxed if they
// exceed max_stretch by themselves and that helps. Size, cone and distortion are measured again.
FlatChart part_of_chart(const FlattenInput& input, const FlatChart& whole,
                        std::span<const std::uint32_t> triangles);

// Divides `triangles`, indices as above, into parts connected by edges. Each list is ascending, and
// the lists are in the order of their first triangles.
std::vector<std::vector<std::uint32_t>> connected_parts(const FlatChart& whole,
                                                        std::span<const std::uint32_t> triangles);

}  // namespace atlas
