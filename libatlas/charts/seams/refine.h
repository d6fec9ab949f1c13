// Internal: moves single triangles between charts, to make seams shorter or charts simpler.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "libatlas/charts/mesh/frames.h"
#include "libatlas/charts/mesh/local_chart.h"
#include "libatlas/charts/mesh/topology.h"

namespace atlas {

// Moves triangle t, which half-edge h belongs to, to the chart across h, with a frame that fits
// there.
void move_triangle(const Topology& topology, std::uint32_t h, Partition& partition, Frames& frames);

// Whether the chart of t stays connected without t, judged from the triangles around t's corners.
bool removable(const Topology& topology, const Partition& partition, std::uint32_t t);

// A limit on charts' normals. No limit if `axes` is empty.
struct ConeLimit {
  std::span<const Vec3f> axes;  // by Partition::chart
  double least_cosine = -1;

  bool excludes(const Vec3f& normal, std::uint32_t chart) const;
};

struct BorderRules {
  double crease_degrees = 60;  // of border_weight()
  ConeLimit cone;
};

// Moves triangles while that shortens the borders between charts. No triangle goes to a chart whose
// cone excludes its normal. Terminates, since every move shortens the borders. Linear in the number
// of border triangles.
void smooth_borders(const Topology& topology, const BorderRules& rules, Partition& partition,
                    Frames& frames);

// Returns the frame of triangle `from` carried to `to`, across their common edge.
Frames::Frame carry_frame(const Topology& topology, const Frames::Frame& frame, std::uint32_t from,
                          std::uint32_t to);

// Gives the triangle of each half-edge the frame from across it, one after the other. Does nothing
// if `frames` is empty.
void carry_frames(const Topology& topology, std::span<const std::uint32_t> half_edges,
                  Frames& frames);

}  // namespace atlas
