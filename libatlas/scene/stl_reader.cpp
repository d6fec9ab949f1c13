// Reads STL, in text and binary: a soup of triangles, whose corners are joined where they are
// equal. OpenMesh also reads it, but not well enough for a scene: its reader (9.0) keeps only
// floats, takes a binary file that was cut short for an empty one, and accepts text that ends or is
// wrong inside a facet.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cstring>

#include "libatlas/core/first_index.h"
#include "libatlas/core/small_letters.h"
#include "libatlas/scene/building/formats.h"
#include "libatlas/scene/files/file_bytes.h"
#include "libatlas/scene/files/text_scanner.h"

namespace atlas {
namespace fs = std::filesystem;
namespace {

constexpr double kJoining = 0.9;                   // share of the time until faces are added
constexpr std::size_t kHeader = 84, kRecord = 50;  // bytes of a binary file

bool same_word(std::string_view word, std::string_view lower) {
  return std::equal(word.begin(), word.end(), lower.begin(), lower.end(),
                    [](char a, char b) { return small_letter(a) == b; });
}

// Joins equal corner points of faces, and numbers the points in the order in which they come.
class Soup {
 public:
  explicit Soup(SceneBuilder& builder) : builder_(builder) {}

  void reserve(std::size_t triangles) {
    corners_.reserve(3 * triangles);
    builder_.positions.reserve(triangles / 2);  // as a closed mesh has
  }

  template <class Place>
  void add_corner(Vec3d p, const Place& place) {
    if (builder_.positions.size() >= first_.most()) grow();
    p = {p.x + 0.0, p.y + 0.0, p.z + 0.0};  // -0 is 0
    std::uint32_t& entry = find(p);
    if (entry == kNoIndex) {
      entry = static_cast<std::uint32_t>(builder_.positions.size());
      builder_.positions.push_back(p);
      if (!usable_position(p) && bad_.size() < DefectReport::kMaxPlaces) bad_.push_back(place());
    }
    corners_.push_back(entry);
  }

  std::size_t corner_count() const { return corners_.size(); }
  std::span<const std::uint32_t> corners() const { return corners_; }

  // Ends the list of points. Faces can only be added after this.
  void finish_points() {
    first_ = FirstIndex();
    auto next_bad = bad_.begin();
    builder_.check_positions([&](std::size_t) { return *next_bad++; });
  }

 private:
  // Returns the table entry of a point, which is compared by its bits: NaN is equal to itself here.
  std::uint32_t& find(const Vec3d& p) {
    const auto words = std::bit_cast<std::array<std::uint32_t, 6>>(p);
    return first_.find(hash_words(words), [&](std::uint32_t i) {
      return std::memcmp(&builder_.positions[i], &p, sizeof p) == 0;
    });
  }

  void grow() {
    first_ = FirstIndex(2 * std::max<std::size_t>(512, builder_.positions.size()));
    for (std::size_t i = 0; i < builder_.positions.size(); ++i)
      find(builder_.positions[i]) = static_cast<std::uint32_t>(i);
  }

  SceneBuilder& builder_;
  FirstIndex first_;
  std::vector<std::uint32_t> corners_;
  std::vector<std::string> bad_;  // places of the first unusable positions
};

Status read_binary(const FileBytes& bytes, SceneBuilder& builder, const Context& context) {
  if (bytes.size < kHeader) {
    return {ErrorCode::bad_input,
            fmt::format("{}: neither text that begins with 'solid' nor the {} bytes of a binary "
                        "header (is it an STL file? export it again)",
                        builder.file, kHeader)};
  }
  std::uint32_t count;
  std::memcpy(&count, bytes.begin() + kHeader - 4, 4);
  const std::uint64_t needed = kHeader + kRecord * std::uint64_t{count};
  if (bytes.size < needed) {
    return {ErrorCode::bad_input,
            fmt::format("{}: {} triangles are announced, which take {} bytes, but the file has {} "
                        "(it was cut short: copy or export it again)",
                        builder.file, count, needed, bytes.size)};
  }
  if (bytes.size > needed) {
    builder.defects.add(DefectKind::element_ignored, [&] {
      return fmt::format("{}: {} bytes after triangle {}", builder.file, bytes.size - needed,
                         count);
    });
  }
  builder.objects.push_back({});
  Soup soup(builder);
  soup.reserve(count);
  const auto place = [&](std::size_t t) { return fmt::format("{}: triangle {}", builder.file, t); };
  for (std::size_t t = 0; t < count; ++t) {
    if (t % 16384 == 0) {
      if (context.cancelled()) return Status::cancelled();
      context.report("reading", kJoining * double(t) / double(count));
    }
    float n[12];  // the normal comes first
    std::memcpy(n, bytes.begin() + kHeader + kRecord * t, sizeof n);
    for (int c = 3; c < 12; c += 3) {
      soup.add_corner({n[c], n[c + 1], n[c + 2]}, [&] { return place(t); });
    }
  }
  soup.finish_points();
  builder.reserve_triangles(count, false);
  for (std::size_t t = 0; t < count; ++t) {
    if (t % 65536 == 0 && context.cancelled()) return Status::cancelled();
    const auto c = soup.corners().subspan(3 * t, 3);
    const std::int64_t corners[3] = {c[0], c[1], c[2]};
    builder.add_face({corners}, [&] { return place(t); });
  }
  return {};
}

// solid NAME { facet normal x y z { outer loop { vertex x y z }* endloop } endfacet }* endsolid
class TextStl {
 public:
  TextStl(const FileBytes& bytes, SceneBuilder& builder)
      : scan_(bytes.begin(), bytes.end(), TextScanner::Lines::never_joined),
        begin_(bytes.begin()),
        end_(bytes.end()),
        builder_(builder),
        soup_(builder) {
    soup_.reserve(bytes.size / 250);  // typical for a facet
  }

  Status run(const Context& context) {
    for (std::string_view word = next_word(); !word.empty(); word = next_word()) {
      if (!same_word(word, "solid")) return unexpected(word, "'solid'");
      builder_.objects.push_back(rest_of_line());
      if (Status s = read_solid(context); !s.ok()) return s;
    }
    soup_.finish_points();
    add_faces();
    return {};
  }

 private:
  struct Face {
    std::uint32_t end, line, object;  // the face's corners end at `end`
  };

  std::string place(std::uint32_t line) const {
    return fmt::format("{}:{}", builder_.file, line + 1);
  }

  Status unexpected(std::string_view word, std::string_view wanted) const {
    if (word.empty()) {
      return {ErrorCode::bad_input,
              fmt::format("{}: the file ends where {} should follow (it was cut short: copy or "
                          "export it again)",
                          builder_.file, wanted)};
    }
    return {ErrorCode::bad_input,
            fmt::format("{}: '{}' where {} should follow (correct the line or export again)",
                        place(line_), word.substr(0, 40), wanted)};
  }

  // Returns the next word, which is empty at the end of the file.
  std::string_view next_word() {
    while (!scan_.at_end() && scan_.at_line_end()) scan_.next_line();
    line_ = scan_.line();
    return scan_.word();
  }

  // Returns the rest of the line as a name. It may contain characters that would begin a comment.
  std::string rest_of_line() {
    const char* start = scan_.position();
    const char* stop = std::find(start, end_, '\n');
    std::string_view name(start, std::size_t(stop - start));
    const std::size_t first = name.find_first_not_of(" \t\r"),
                      last = name.find_last_not_of(" \t\r");
    scan_.next_line();
    return first == name.npos ? std::string() : std::string(name.substr(first, last - first + 1));
  }

  Status read_solid(const Context& context) {
    for (;;) {
      const std::string_view word = next_word();
      if (same_word(word, "endsolid")) break;
      if (!same_word(word, "facet")) return unexpected(word, "'facet' or 'endsolid'");
      if (faces_.size() % 16384 == 0) {
        if (context.cancelled()) return Status::cancelled();
        context.report("reading",
                       kJoining * double(scan_.position() - begin_) / double(end_ - begin_));
      }
      if (Status s = read_facet(); !s.ok()) return s;
    }
    rest_of_line();
    return {};
  }

  Status read_facet() {
    const std::uint32_t line = line_;
    std::string_view word = next_word();
    for (int skipped = 0; skipped < 4 && !word.empty() && !same_word(word, "outer"); ++skipped) {
      word = next_word();  // `normal` and its numbers, which follow from the corners
    }
    if (!same_word(word, "outer")) return unexpected(word, "'outer loop'");
    if (word = next_word(); !same_word(word, "loop")) return unexpected(word, "'loop'");
    for (word = next_word(); same_word(word, "vertex"); word = next_word()) {
      if (Status s = read_vertex(); !s.ok()) return s;
    }
    if (!same_word(word, "endloop")) return unexpected(word, "'vertex' or 'endloop'");
    if (word = next_word(); !same_word(word, "endfacet")) return unexpected(word, "'endfacet'");
    faces_.push_back({static_cast<std::uint32_t>(soup_.corner_count()), line,
                      static_cast<std::uint32_t>(builder_.objects.size() - 1)});
    return {};
  }

  Status read_vertex() {
    double n[3];
    for (double& value : n) {
      while (!scan_.at_end() && scan_.at_line_end()) scan_.next_line();
      line_ = scan_.line();
      if (scan_.at_end() || !scan_.number(value)) {
        return unexpected(scan_.word(), "a number of 'vertex x y z'");
      }
    }
    soup_.add_corner({n[0], n[1], n[2]}, [&] { return place(line_); });
    return {};
  }

  void add_faces() {
    builder_.reserve_triangles(faces_.size(), false);
    std::vector<std::int64_t> corners;
    std::size_t begin = 0;
    for (const Face& face : faces_) {
      const auto all = soup_.corners();
      corners.assign(all.begin() + std::ptrdiff_t(begin), all.begin() + face.end);
      builder_.object = face.object;
      builder_.add_face({corners}, [&] { return place(face.line); });
      begin = face.end;
    }
  }

  TextScanner scan_;
  const char *begin_, *end_;
  SceneBuilder& builder_;
  Soup soup_;
  std::vector<Face> faces_;
  std::uint32_t line_ = 0;
};

// The headers of some binary files also begin with 'solid', so the file's size decides.
bool is_text(const FileBytes& bytes) {
  if (bytes.size >= kHeader) {
    std::uint32_t count;
    std::memcpy(&count, bytes.begin() + kHeader - 4, 4);
    if (bytes.size == kHeader + kRecord * std::uint64_t{count}) return false;
  }
  std::string_view text = bytes.text();
  if (begins_with_mark(bytes)) text.remove_prefix(3);
  text.remove_prefix(std::min(text.find_first_not_of(" \t\r\n"), text.size()));
  return same_word(text.substr(0, 5), "solid") &&
         text.substr(0, 2 * kHeader).find('\0') == text.npos;
}

}  // namespace

Status read_stl(const fs::path& path, SceneBuilder& builder, const Context& context) {
  auto bytes = read_file_bytes(path);
  if (!bytes.ok()) return bytes.status();
  builder.materials.push_back({});
  if (!is_text(*bytes)) return read_binary(*bytes, builder, context);
  if (Status s = turn_into_lines(*bytes, path); !s.ok()) return s;
  return TextStl(*bytes, builder).run(context);
}

}  // namespace atlas
