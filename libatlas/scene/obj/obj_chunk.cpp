#include "libatlas/scene/obj/obj_chunk.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "libatlas/core/is_finite.h"
#include "libatlas/scene/building/scene_builder.h"
#include "libatlas/scene/files/text_scanner.h"

namespace atlas {
namespace {

// Keywords that are skipped silently: settings of viewers, and normals and smoothing groups that
// are not wanted.
constexpr std::string_view kSilent[] = {"vn",     "vp",       "s",          "mg",
                                        "bevel",  "c_interp", "lod",        "usemap",
                                        "maplib", "d_interp", "shadow_obj", "trace_obj"};

std::int32_t clamp_index(std::int64_t index) {
  constexpr std::int64_t kMax = std::numeric_limits<std::int32_t>::max();
  return static_cast<std::int32_t>(std::clamp(index, -kMax, kMax));
}

class Parser {
 public:
  Parser(const char* begin, const char* end, const ObjWanted& wanted)
      : scan_(begin, end), normals_(wanted.normals), smoothing_(wanted.smoothing) {
    const auto bytes = static_cast<std::size_t>(end - begin);
    chunk_.positions.reserve(bytes / 100);  // typical: 100 bytes for a vertex with its two faces
    chunk_.position.index.reserve(bytes / 16);
    chunk_.face_end.reserve(bytes / 48);
    chunk_.face_line.reserve(bytes / 48);
  }

  ObjChunk run() {
    while (!scan_.at_end() && chunk_.error.empty()) {
      if (!scan_.at_line_end()) parse_line();
      if (chunk_.error.empty()) scan_.next_line();
    }
    chunk_.lines = scan_.line();
    return std::move(chunk_);
  }

 private:
  void parse_line() {
    line_ = scan_.line();
    const std::string_view keyword = scan_.word();
    if (keyword == "v") return parse_position();
    if (keyword == "f" || keyword == "fo") return parse_face();
    if (keyword == "vt") return parse_texcoord();
    if (keyword == "vn" && normals_) return parse_normal();
    if (keyword == "o") return add_event(ObjEvent::object);
    if (keyword == "g") return add_event(ObjEvent::group);
    if (keyword == "s" && smoothing_) return add_event(ObjEvent::smoothing);
    if (keyword == "usemtl") return add_event(ObjEvent::material);
    if (keyword == "mtllib") return add_event(ObjEvent::library);
    if (std::find(std::begin(kSilent), std::end(kSilent), keyword) == std::end(kSilent)) {
      chunk_.ignored.push_back(line_);
    }
  }

  void fail(std::string what) {
    chunk_.error = std::move(what);
    chunk_.error_line = line_;
  }

  // Reads up to `most` numbers until the end of the line. Returns their count, or -1 after an
  // error.
  int parse_numbers(double* values, int most, const char* what) {
    int count = 0;
    while (count < most && !scan_.at_line_end()) {
      if (!scan_.number(values[count])) {
        fail(fmt::format("'{}' is not a number of a {}", scan_.word().substr(0, 40), what));
        return -1;
      }
      ++count;
    }
    return count;
  }

  void parse_position() {
    double n[8];
    const int count = parse_numbers(n, 8, "vertex (v x y z [r g b])");
    if (count < 0) return;
    if (count < 3 || count == 5) {
      return fail(fmt::format(
          "a vertex needs 3 coordinates, then none or 3 values; it has {} numbers", count));
    }
    chunk_.positions.push_back({n[0], n[1], n[2]});
    if (!usable_position(chunk_.positions.back())) chunk_.bad_positions.push_back(line_);
    if (count >= 6) {
      add_colour({float(n[3]), float(n[4]), float(n[5])});
    } else if (!chunk_.colours.empty()) {
      chunk_.colours.push_back({NAN, 0, 0});
    }
  }

  void add_colour(Vec3f c) {
    if (!is_finite(c)) {
      chunk_.bad_values.push_back(line_);
      for (float* value : {&c.x, &c.y, &c.z}) {
        if (!std::isfinite(*value)) *value = 0;
      }
    }
    if (chunk_.colours.empty()) {
      chunk_.colours.reserve(chunk_.positions.capacity());
      chunk_.colours.resize(chunk_.positions.size() - 1, {NAN, 0, 0});
    }
    chunk_.colours.push_back(c);
  }

  void parse_texcoord() {
    double n[3] = {0, 0, 0};
    const int count = parse_numbers(n, 3, "texture coordinate (vt u v)");
    if (count == 0) fail("a texture coordinate needs at least one number");
    if (count > 0) chunk_.texcoords.push_back({float(n[0]), float(n[1])});
  }

  void parse_normal() {
    double n[3];
    const int count = parse_numbers(n, 3, "normal (vn x y z)");
    if (count < 0) return;
    if (count < 3) return fail(fmt::format("a normal needs 3 numbers; it has {}", count));
    chunk_.normals.push_back({float(n[0]), float(n[1]), float(n[2])});
  }

  void parse_face() {
    while (!scan_.at_line_end()) {
      const char* start = scan_.position();
      if (!parse_corner()) {
        const std::string_view word(start, std::size_t(scan_.word().end() - start));
        return fail(fmt::format("'{}' is not a corner of a face (v, v/vt, v//vn or v/vt/vn)",
                                word.substr(0, 40)));
      }
    }
    chunk_.face_end.push_back(static_cast<std::uint32_t>(chunk_.position.index.size()));
    chunk_.face_line.push_back(line_);
  }

  bool parse_corner() {
    std::int64_t v = 0, t = 0, n = 0;
    bool has_t = false, has_n = false;
    if (!scan_.integer_here(v)) return false;
    if (scan_.take('/')) {  // the rest may be missing: v/, v// and v/vt/ occur, too
      has_t = scan_.integer_here(t);
      if (scan_.take('/')) has_n = scan_.integer_here(n);
    }
    if (!scan_.at_blank()) return false;
    add_index(v, chunk_.positions.size(), chunk_.position);
    add_attribute(has_t, t, chunk_.texcoords.size(), chunk_.texcoord);
    if (normals_) add_attribute(has_n, n, chunk_.normals.size(), chunk_.normal);
    return true;
  }

  static void add_index(std::int64_t index, std::size_t so_far, ObjChunk::Corners& corners) {
    if (index < 0) corners.relative.push_back(static_cast<std::uint32_t>(corners.index.size()));
    corners.index.push_back(
        clamp_index(index < 0 ? static_cast<std::int64_t>(so_far) + index : index - 1));
  }

  // Adds an attribute's index to the corner whose position was added last.
  void add_attribute(bool given, std::int64_t index, std::size_t so_far,
                     ObjChunk::Corners& corners) {
    if (given && corners.index.empty()) {
      corners.index.reserve(chunk_.position.index.capacity());
      corners.index.resize(chunk_.position.index.size() - 1, ObjChunk::kNoIndex);
    }
    if (given) {
      add_index(index, so_far, corners);
    } else if (!corners.index.empty()) {
      corners.index.push_back(ObjChunk::kNoIndex);
    }
  }

  void add_event(ObjEvent::Kind kind) {
    const std::string_view text =
        kind == ObjEvent::library ? scan_.rest_with_comment() : scan_.rest();
    chunk_.events.push_back(
        {kind, static_cast<std::uint32_t>(chunk_.face_end.size()), line_, text});
  }

  TextScanner scan_;
  bool normals_, smoothing_;
  ObjChunk chunk_;
  std::uint32_t line_ = 0;
};

}  // namespace

ObjChunk parse_obj_chunk(const char* begin, const char* end, const ObjWanted& wanted) {
  return Parser(begin, end, wanted).run();
}

}  // namespace atlas
