// Internal: one piece of an OBJ file, parsed on its own so that pieces can be parsed in parallel.
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
  enum Kind { object, group, material, library };
  Kind kind{};
  std::uint32_t face = 0;  // number of faces of the chunk before it
  std::uint32_t line = 0;
  std::string_view text;
};

// Lines count from 0 at the chunk's start. Corners hold index - 1 as the file gives it; those
// listed in Corners::relative were negative and hold (elements of the chunk so far) + index, to
// which the elements of the chunks before have to be added.
struct ObjChunk {
  static constexpr std::int32_t kNoIndex = -0x7fffffff - 1;

  // What corners name of one kind of attribute; empty while no corner has named any, else 1 a
  // corner, kNoIndex where it names none.
  struct Corners {
    std::vector<std::int32_t> index;
    std::vector<std::uint32_t> relative;
  };

  std::vector<Vec3d> positions;
  std::vector<Vec3f> colours;  // empty, or 1 a position; x is NaN where the line has none
  std::vector<Vec2f> texcoords;
  std::vector<Vec3f> normals;
  Corners position, texcoord, normal;
  std::vector<std::uint32_t> face_end, face_line;  // face i has the corners up to face_end[i]
  std::vector<ObjEvent> events;
  // Lines of positions that are no finite floats, of non-finite colours, of ignored elements.
  std::vector<std::uint32_t> bad_positions, bad_values, ignored;
  std::uint32_t lines = 0;
  std::string error;  // not empty: malformed at error_line
  std::uint32_t error_line = 0;
};

// Parses [begin, end), which starts and ends at line borders; without `normals` these are passed
// over. Never fails but by chunk.error.
ObjChunk parse_obj_chunk(const char* begin, const char* end, bool normals);

}  // namespace atlas
