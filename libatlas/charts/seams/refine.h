// Internal: moves single triangles between charts, to make seams shorter or charts easier.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "libatlas/charts/mesh/frames.h"
#include "libatlas/charts/mesh/local_chart.h"
#include "libatlas/charts/mesh/topology.h"

namespace atlas {

// Hands triangle t to the chart across half-edge h of it, with a frame that fits there.
void move_triangle(const Topology& topology, std::uint32_t h, Partition& partition, Frames& frames);

// Whether the chart of t stays in one piece without it (decided around t's corners).
bool removable(const Topology& topology, const Partition& partition, std::uint32_t t);

// What a linked edge costs in a border: its length, or a quarter of it where the fold is sharper.
double border_weight(const Topology& topology, std::uint32_t half_edge, double crease_cosine);

// A limit on charts' normals; empty axes: none.
struct ConeLimit {
  std::span<const Vec3f> axes;  // by Partition::chart
  double least_cosine = -1;

  bool excludes(const Vec3f& normal, std::uint32_t chart) const;
};

struct BorderRules {
  double crease_degrees = 40;  // sharper edges count a quarter of their length
  ConeLimit cone;
};

// Moves triangles while that shortens the borders between charts. No triangle goes where its normal
// leaves the cone. Ends: every move shortens. Linear in the number of border triangles.
void smooth_borders(const Topology& topology, const BorderRules& rules, Partition& partition,
                    Frames& frames);

// The frame of triangle `from` carried to `to`, across their common edge.
Frames::Frame carry_frame(const Topology& topology, const Frames::Frame& frame, std::uint32_t from,
                          std::uint32_t to);

// Gives each half-edge's triangle the frame from across, one after the other; none where `frames`
// is empty.
void carry_frames(const Topology& topology, std::span<const std::uint32_t> half_edges,
                  Frames& frames);

}  // namespace atlas
