// Internal: parses one chunk of an OBJ file on its own, so that chunks can be parsed in parallel.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "libatlas/core/vec.h"
#include "libatlas/scene/defects.h"

namespace atlas {

// A line that changes the state of the faces after it.
struct ObjEvent {
  enum Kind { object, group, material, library, smoothing };
  Kind kind{};
  std::uint32_t face = 0;  // number of the chunk's faces before it
  std::uint32_t line = 0;
  std::string_view text;
};

// Lines count from 0 at the chunk's start. Corners hold the file's index minus 1. Corners listed in
// Corners::relative had negative indices; they hold the index plus the number of elements so far in
// the chunk, to which the number of elements in earlier chunks must be added.
struct ObjChunk {
  static constexpr std::int32_t kNoIndex = -0x7fffffff - 1;

  // The indices of one kind of attribute: empty while no corner has named one, else 1 per corner,
  // and kNoIndex where it names none.
  struct Corners {
    std::vector<std::int32_t> index;
    std::vector<std::uint32_t> relative;
  };

  std::vector<Vec3d> positions;
  std::vector<Vec3f> colours;  // empty, or 1 per position; x is NaN where the line has none
  std::vector<Vec2f> texcoords;
  std::vector<Vec3f> normals;
  Corners position, texcoord, normal;
  std::vector<std::uint32_t> face_end, face_line;  // face i has the corners up to face_end[i]
  std::vector<ObjEvent> events;
  // Lines of positions that are not finite floats, of non-finite colours, and of ignored elements.
  std::vector<std::uint32_t> bad_positions, bad_values, ignored;
  std::uint32_t lines = 0;
  std::string error;  // if not empty, the chunk is malformed at error_line
  std::uint32_t error_line = 0;
};

// What a scene takes of a file only if it is asked for.
struct ObjWanted {
  bool normals = false, smoothing = false;
};

// Parses [begin, end), which begins and ends at line boundaries. Reports errors only in
// chunk.error.
ObjChunk parse_obj_chunk(const char* begin, const char* end, const ObjWanted& wanted);

}  // namespace atlas
