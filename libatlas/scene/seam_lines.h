// Seams that a user has drawn: the polylines of an OBJ file.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <vector>

#include "libatlas/core/status.h"
#include "libatlas/scene/scene.h"

namespace atlas {

struct SeamLines {
  // 3 a triangle of the scene: 1 if its edge from that corner to the next is a seam
  // (MeshView::seams).
  std::vector<std::uint8_t> edges = {};
  std::size_t segments = 0;  // of the polylines
  std::size_t found = 0;     // those that are edges of the scene
};

// Reads the lines `v x y z` and `l i j ...` of an OBJ file, whatever else it holds: it may be the
// scene's own file or another one, in the same coordinates. A segment is an edge of the scene if
// its ends are the nearest positions to the edge's ends, within 1e-5 of the scene's size. Errors:
// not_found, io; bad_input with the line for an index out of range or a number that cannot be read,
// and for a file without polylines, or whose polylines follow no edge.
Result<SeamLines> read_seam_lines(const std::filesystem::path& path, const Scene& scene);

}  // namespace atlas
