// Internal: some triangles of a flat chart as a chart of their own.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "libatlas/charts/flattening/flatten.h"

namespace atlas {

// Those triangles with their coordinates and vertices, numbered anew; nothing is measured.
FlatChart take_triangles(const FlatChart& whole, std::span<const std::uint32_t> triangles);

// Measures piece.distortion (mesh: the piece's own, relative to some origin). Where it exceeds
// max_stretch the coordinates are relaxed, if that brings them within it.
void keep_to_bound(const LocalMesh& mesh, double max_stretch, FlatChart& piece);

// `triangles`: places in whole.triangles, ascending, at least one. They keep their coordinates but
// for the turn that packing wants, or are relaxed where they exceed max_stretch by themselves, if
// that helps; size, cone and distortion are measured anew.
FlatChart part_of_chart(const FlattenInput& input, const FlatChart& whole,
                        std::span<const std::uint32_t> triangles);

// What of `triangles`, places as above, hangs together by whole sides: each list ascending, in the
// order of their first triangles.
std::vector<std::vector<std::uint32_t>> connected_parts(const FlatChart& whole,
                                                        std::span<const std::uint32_t> triangles);

}  // namespace atlas
