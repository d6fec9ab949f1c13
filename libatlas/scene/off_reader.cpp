// Reads OFF, the format of Geomview, in text and binary. OpenMesh also reads it, but not well
// enough for a scene: its reader (9.0) keeps only floats, and accepts a file that ends early, a
// word in place of a number, or a comment between vertices; it then repeats the last face or uses
// arbitrary vertices.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cstring>
#include <optional>
#include <span>

#include "libatlas/scene/building/formats.h"
#include "libatlas/scene/files/file_bytes.h"
#include "libatlas/scene/files/text_scanner.h"
#include "libatlas/scene/off_colours.h"

namespace atlas {
namespace fs = std::filesystem;
namespace {

// The attributes that [ST][C][N]OFF declares for a vertex: x y z, then these, in this order.
struct OffLayout {
  bool normal = false, colour = false, texture = false, binary = false;

  int before_colour() const { return normal ? 6 : 3; }
};

Status malformed(const std::string& place, std::string_view what) {
  return {ErrorCode::bad_input,
          fmt::format("{}: {} (correct the line or export again)", place, what)};
}

Status cut_short(const std::string& file, std::string_view what) {
  return {
      ErrorCode::bad_input,
      fmt::format("{}: {}, but the file ends before (it was cut short: copy or export it again)",
                  file, what)};
}

// Texture coordinates and normals are given per vertex.
FaceCorners corners_of(const std::vector<std::int64_t>& vertices, const OffLayout& layout,
                       const SceneBuilder& builder) {
  const std::span<const std::int64_t> all(vertices);
  return {all, all.first(layout.texture ? all.size() : 0),
          all.first(builder.normals.empty() ? 0 : all.size())};
}

class TextOff {
 public:
  TextOff(const FileBytes& bytes, TextScanner scan, OffLayout layout, SceneBuilder& builder)
      : begin_(bytes.begin()),
        end_(bytes.end()),
        scan_(scan),
        layout_(layout),
        builder_(builder),
        colours_(builder) {}

  Status run(const Context& context) {
    if (Status s = read_counts(); !s.ok()) return s;
    if (Status s = read_vertices(context); !s.ok()) return s;
    if (Status s = read_faces(context); !s.ok()) return s;
    while (next_filled_line()) {
      builder_.defects.add(DefectKind::element_ignored, [&] { return place(); });
      scan_.next_line();
    }
    return {};
  }

 private:
  static constexpr int kMost = 32;  // limit on the numbers of a vertex

  std::string place() const { return fmt::format("{}:{}", builder_.file, line_ + 1); }

  bool next_filled_line() {
    while (!scan_.at_end() && scan_.at_line_end()) scan_.next_line();
    line_ = scan_.line();
    return !scan_.at_end();
  }

  Status read_counts() {
    constexpr std::string_view kWhat = "the numbers of vertices, faces and edges are missing";
    if (!next_filled_line()) return cut_short(builder_.file, "a header is announced");
    std::int64_t counts[2] = {-1, -1};
    for (std::int64_t& count : counts) {
      scan_.skip_blanks();
      if (!scan_.integer_here(count) || !scan_.at_blank() || count < 0) {
        return malformed(place(), kWhat);
      }
    }
    scan_.next_line();  // the number of edges is not needed, and often missing
    // A vertex takes at least six bytes, a face two.
    const auto left = static_cast<std::uint64_t>(end_ - scan_.position()) + 1;
    vertices_ = static_cast<std::uint64_t>(counts[0]);
    faces_ = static_cast<std::uint64_t>(counts[1]);
    if (vertices_ > left / 6 || faces_ > (left - 6 * vertices_) / 2) {
      return cut_short(builder_.file,
                       fmt::format("{} vertices and {} faces are announced", vertices_, faces_));
    }
    return {};
  }

  // Reads the numbers of a line. Returns their count, or -1 after a word that is not a number.
  // Clears `whole` if the colour, which begins with number `colour`, is not written in whole
  // numbers.
  int read_numbers(double* n, int colour, bool& whole) {
    int count = 0;
    while (count < kMost && !scan_.at_line_end()) {
      const char* start = scan_.position();
      if (!scan_.number(n[count])) return -1;
      const std::string_view text(start, std::size_t(scan_.position() - start));
      const int of_colour = count - colour;
      if (of_colour >= 0 && of_colour < 3 && text.find_first_of(".eEn") != text.npos) whole = false;
      ++count;
    }
    return count;
  }

  Status read_vertices(const Context& context) {
    builder_.positions.reserve(vertices_);
    builder_.illumination.reserve(layout_.colour ? vertices_ : 0);
    builder_.texcoords.reserve(layout_.texture ? vertices_ : 0);
    std::vector<std::string> bad;  // places of the first unusable positions
    for (std::uint64_t i = 0; i < vertices_; ++i) {
      if (i % 16384 == 0) {
        if (context.cancelled()) return Status::cancelled();
        report(context);
      }
      if (!next_filled_line()) {
        return cut_short(builder_.file,
                         fmt::format("vertex {} of {} is missing", i + 1, vertices_));
      }
      double n[kMost];
      bool whole = true;
      const int count = read_numbers(n, layout_.before_colour(), whole);
      if (count < 0) {
        return malformed(
            place(), fmt::format("'{}' is not a number of a vertex", scan_.word().substr(0, 40)));
      }
      if (Status s = add_vertex(n, count, whole); !s.ok()) return s;
      if (!usable_position(builder_.positions.back()) && bad.size() < DefectReport::kMaxPlaces) {
        bad.push_back(place());
      }
      scan_.next_line();
    }
    colours_.finish_vertices();
    auto next_bad = bad.begin();
    builder_.check_positions([&](std::size_t) { return *next_bad++; });
    return {};
  }

  void report(const Context& context) const {
    context.report("reading", double(scan_.position() - begin_) / double(end_ - begin_));
  }

  Status add_vertex(const double* n, int count, bool whole) {
    const int least = layout_.before_colour() + 2 * layout_.texture;
    const int colour = layout_.colour ? count - least : 0;
    if (count < least || (layout_.colour && colour != 3 && colour != 4)) {
      return malformed(place(),
                       fmt::format("a vertex of this file needs {} numbers{}; it has {}", least,
                                   layout_.colour ? " and 3 or 4 of a colour" : "", count));
    }
    builder_.positions.push_back({n[0], n[1], n[2]});
    if (layout_.normal && builder_.wants_normals)
      builder_.normals.push_back({float(n[3]), float(n[4]), float(n[5])});
    if (layout_.colour)
      colours_.add_vertex({n + layout_.before_colour(), std::size_t(colour)}, whole);
    const double* uv = n + layout_.before_colour() + colour;
    if (layout_.texture) builder_.texcoords.push_back({float(uv[0]), float(uv[1])});
    if (count > least + colour) {  // the header does not say what they mean
      builder_.defects.add(DefectKind::element_ignored, [&] {
        return fmt::format("{}, the last {} numbers", place(), count - least - colour);
      });
    }
    return {};
  }

  Status read_faces(const Context& context) {
    builder_.reserve_triangles(faces_, layout_.texture);
    std::vector<std::int64_t> corners;
    for (std::uint64_t f = 0; f < faces_; ++f) {
      if (f % 16384 == 0) {
        if (context.cancelled()) return Status::cancelled();
        report(context);
      }
      if (!next_filled_line()) {
        return cut_short(builder_.file, fmt::format("face {} of {} is missing", f + 1, faces_));
      }
      if (Status s = read_corners(corners, f); !s.ok()) return s;
      read_face_colour();
      builder_.add_face(corners_of(corners, layout_, builder_), [&] { return place(); });
      scan_.next_line();
    }
    colours_.finish_faces();
    return {};
  }

  // A colour may follow the corners of a face: nothing, an index into a map of colours that is in
  // another file, or three or four numbers.
  void read_face_colour() {
    double n[kMost];
    bool whole = true;
    const int count = read_numbers(n, 0, whole);
    builder_.face_colour.reset();
    if (count == 0) return;
    if (count == 3 || count == 4) return colours_.next_face({n, std::size_t(count)}, whole);
    builder_.defects.add(DefectKind::element_ignored,
                         [&] { return place() + ", what follows the corners of the face"; });
  }

  // Some programs spread a face over several lines. Only the end of a line separates the face's
  // colour from the next face, so nothing may follow such a face on its last line: with an index
  // missing, the faces after it would be read from the wrong place.
  Status read_corners(std::vector<std::int64_t>& corners, std::uint64_t face) {
    corners.clear();
    std::int64_t count = 0;
    if (!read_integer(count) || count < 0) {
      return malformed(place(), "a face begins with the number of its corners");
    }
    for (std::int64_t k = 0; k < count; ++k) {
      while (!scan_.at_end() && scan_.at_line_end()) scan_.next_line();
      if (scan_.at_end()) {
        return cut_short(builder_.file,
                         fmt::format("face {} of {} has {} corners", face + 1, faces_, count));
      }
      std::int64_t v;
      if (!read_integer(v)) {
        return malformed(place(), fmt::format("'{}' is not one of the {} indices of a face",
                                              scan_.word().substr(0, 40), count));
      }
      corners.push_back(v);
    }
    if (scan_.line() == line_ || scan_.at_line_end()) return {};
    return malformed(place(), fmt::format("a face of {} corners needs {} indices", count, count));
  }

  bool read_integer(std::int64_t& value) {
    scan_.skip_blanks();
    return scan_.integer_here(value) && scan_.at_blank();
  }

  const char *begin_, *end_;
  TextScanner scan_;
  OffLayout layout_;
  SceneBuilder& builder_;
  OffColours colours_;
  std::uint64_t vertices_ = 0, faces_ = 0;
  std::uint32_t line_ = 0;
};

// Geomview writes big-endian words and, after each face's corners, the number of components of its
// colour. OpenMesh writes words in the machine's byte order and no such number. The header does not
// distinguish them, so the form is taken with which the data end at the file's end. Without these
// numbers, all faces need at least three corners; otherwise the 0 that Geomview writes for a face
// without a colour would look like a face without corners, and a file cut short after it would look
// complete.
class BinaryOff {
 public:
  BinaryOff(std::string_view data, OffLayout layout, SceneBuilder& builder)
      : data_(data), layout_(layout), builder_(builder) {}

  Status run(const Context& context) {
    for (const bool counted : {true, false}) {
      for (const bool big : {true, false}) {
        big_ = big;
        counted_ = counted;
        if (fits()) return read(context);
      }
    }
    return cut_short(builder_.file, "its vertices and faces are announced in binary");
  }

 private:
  std::size_t words() const { return data_.size() / 4; }
  std::uint32_t word(std::size_t i) const {
    std::uint32_t bits;
    std::memcpy(&bits, data_.data() + 4 * i, 4);
    return big_ ? __builtin_bswap32(bits) : bits;
  }
  float number(std::size_t i) const { return std::bit_cast<float>(word(i)); }

  std::size_t vertex_words() const {
    return std::size_t(layout_.before_colour()) + 4 * layout_.colour + 2 * layout_.texture;
  }
  // Returns the index of the word after the face that begins at `at`, or nothing if it reaches
  // beyond the file's end.
  std::optional<std::size_t> after_face(std::size_t at) const {
    if (at >= words() || word(at) >= words() - at) return {};
    const std::uint32_t corners = word(at);
    at += 1 + corners;
    if (!counted_) return corners < 3 ? std::nullopt : std::optional(at);
    if (at >= words() || word(at) > 4 || word(at) >= words() - at) return {};
    return at + 1 + word(at);
  }

  bool fits() {
    if (words() < 3) return false;
    vertices_ = word(0);
    faces_ = word(1);
    first_face_ = 3 + vertices_ * vertex_words();
    if (first_face_ > words() || faces_ > words() - first_face_) return false;
    std::optional<std::size_t> at = first_face_;
    for (std::size_t f = 0; f < faces_ && at; ++f) at = after_face(*at);
    return at == words() && data_.size() % 4 == 0;
  }

  Status read(const Context& context) {
    builder_.positions.reserve(vertices_);
    OffColours colours(builder_);
    for (std::size_t i = 0; i < vertices_; ++i) {
      if (i % 65536 == 0 && context.cancelled()) return Status::cancelled();
      std::size_t at = 3 + i * vertex_words();
      builder_.positions.push_back({number(at), number(at + 1), number(at + 2)});
      if (layout_.normal && builder_.wants_normals)
        builder_.normals.push_back({number(at + 3), number(at + 4), number(at + 5)});
      at += std::size_t(layout_.before_colour());
      if (layout_.colour) {
        colours.add_vertex(
            std::array<double, 4>{number(at), number(at + 1), number(at + 2), number(at + 3)},
            false);
        at += 4;
      }
      if (layout_.texture) builder_.texcoords.push_back({number(at), number(at + 1)});
    }
    colours.finish_vertices();
    builder_.check_positions(
        [&](std::size_t i) { return fmt::format("{}: vertex {}", builder_.file, i); });
    builder_.reserve_triangles(faces_, layout_.texture);
    std::vector<std::int64_t> corners;
    std::size_t at = first_face_;
    for (std::size_t f = 0; f < faces_; ++f, at = *after_face(at)) {
      if (f % 65536 == 0) {
        if (context.cancelled()) return Status::cancelled();
        context.report("reading", double(at) / double(words()));
      }
      corners.clear();
      for (std::size_t k = 0; k < word(at); ++k) corners.push_back(word(at + 1 + k));
      read_face_colour(at + 1 + word(at), colours);
      builder_.add_face(corners_of(corners, layout_, builder_),
                        [&] { return fmt::format("{}: face {}", builder_.file, f); });
    }
    colours.finish_faces();
    return {};
  }

  // `at` is behind the corners of the face.
  void read_face_colour(std::size_t at, OffColours& colours) {
    builder_.face_colour.reset();
    const std::uint32_t count = counted_ ? word(at) : 0;
    if (count != 3 && count != 4) return;
    std::array<double, 4> rgba{};
    for (std::size_t c = 0; c < count; ++c) rgba[c] = number(at + 1 + c);
    colours.next_face(std::span(rgba).first(count), false);
  }

  std::string_view data_;
  OffLayout layout_;
  SceneBuilder& builder_;
  bool big_ = true, counted_ = true;
  std::size_t vertices_ = 0, faces_ = 0, first_face_ = 0;
};

// Reads the keyword, which many files lack and some write without a blank before the counts.
Status read_keyword(TextScanner& scan, const std::string& file, OffLayout& layout) {
  while (!scan.at_end() && scan.at_line_end()) scan.next_line();
  const auto error = [&](ErrorCode code, std::string_view what) {
    return Status(code, fmt::format("{}:{}: {}", file, scan.line() + 1, what));
  };
  for (bool prefix = true; prefix;) {
    prefix = false;
    if (scan.take('S')) prefix = layout.texture = scan.take('T');
    if (scan.take('C')) prefix = layout.colour = true;
    if (scan.take('N')) prefix = layout.normal = true;
  }
  const char* at = scan.position();
  const bool four = *at == '4' && (at[1] == 'O' || at[1] == 'n');
  if (four || *at == 'n') {
    return error(ErrorCode::unsupported,
                 "vertices of other than three coordinates (export as OFF, without 4 and n)");
  }
  const bool digits = *at >= '0' && *at <= '9';
  if (!digits && !(scan.take('O') && scan.take('F') && scan.take('F'))) {
    return error(ErrorCode::bad_input,
                 "an OFF file begins with OFF, COFF, NOFF or STOFF (is it one? export it again)");
  }
  TextScanner ahead = scan;
  if (ahead.word() == "BINARY") {
    layout.binary = true;
    ahead.next_line();
    scan = ahead;
  }
  return {};
}

}  // namespace

Status read_off(const fs::path& path, SceneBuilder& builder, const Context& context) {
  auto bytes = read_file_bytes(path);
  if (!bytes.ok()) return bytes.status();
  builder.objects.push_back({});
  builder.materials.push_back({});
  constexpr TextScanner::Lines kLines = TextScanner::Lines::never_joined;
  TextScanner scan(bytes->begin(), bytes->end(), kLines);
  OffLayout layout;
  const bool binary = read_keyword(scan, builder.file, layout).ok() && layout.binary;
  if (!binary) {
    if (Status s = turn_into_lines(*bytes, path); !s.ok()) return s;
    scan = TextScanner(bytes->begin(), bytes->end(), kLines);
    layout = {};
    if (Status s = read_keyword(scan, builder.file, layout); !s.ok()) return s;
  }
  if (!layout.binary) return TextOff(*bytes, scan, layout, builder).run(context);
  const auto header = static_cast<std::size_t>(scan.position() - bytes->begin());
  return BinaryOff(bytes->text().substr(std::min(header, bytes->size)), layout, builder)
      .run(context);
}

}  // namespace atlas
