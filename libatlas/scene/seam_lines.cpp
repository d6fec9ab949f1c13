#include "libatlas/scene/seam_lines.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <string>
#include <utility>

#include "libatlas/core/bounds.h"
#include "libatlas/core/half_edge.h"
#include "libatlas/core/nearest_point.h"
#include "libatlas/scene/files/file_bytes.h"
#include "libatlas/scene/files/text_scanner.h"

namespace atlas {
namespace {

constexpr double kNear = 1e-5;  // of the scene's size

struct Polylines {
  std::vector<Vec3d> points;
  std::vector<std::array<std::size_t, 2>> segments;  // into points
};

class LineReader {
 public:
  LineReader(const std::filesystem::path& path, const FileBytes& bytes)
      : path_(path), scanner_(bytes.begin(), bytes.end()) {}

  Result<Polylines> run() {
    for (; !scanner_.at_end(); scanner_.next_line()) {
      if (scanner_.at_line_end()) continue;
      const std::string_view kind = scanner_.word();
      const bool read = kind == "v" ? take_point() : kind != "l" || take_line();
      if (!read)
        return Status(ErrorCode::bad_input,
                      fmt::format("{}:{}: {} (correct the line or export again)", path_.string(),
                                  scanner_.line() + 1, error_));
    }
    return std::move(lines_);
  }

 private:
  bool take_point() {
    Vec3d p;
    error_ = "three finite numbers must follow v";
    if (!scanner_.number(p.x) || !scanner_.number(p.y) || !scanner_.number(p.z)) return false;
    if (!std::isfinite(p.x) || !std::isfinite(p.y) || !std::isfinite(p.z)) return false;
    lines_.points.push_back(p);
    return true;
  }

  bool take_line() {
    std::size_t last = 0;
    for (std::size_t count = 0;; ++count) {
      if (scanner_.at_line_end()) {
        error_ = "a polyline needs two vertices at least";
        return count >= 2;
      }
      std::int64_t number = 0;
      error_ = "numbers of vertices must follow l";
      if (!scanner_.integer_here(number)) return false;
      if (scanner_.take('/')) scanner_.word();  // the number of a texture coordinate
      const auto n = std::int64_t(lines_.points.size());
      error_ = fmt::format("a polyline names vertex {} of {} before it", number, n);
      if (number < -n || number == 0 || number > n) return false;
      const auto at = std::size_t(number > 0 ? number - 1 : n + number);
      if (count > 0) lines_.segments.push_back({last, at});
      last = at;
    }
  }

  const std::filesystem::path& path_;
  TextScanner scanner_;
  Polylines lines_;
  std::string error_;
};

using Edge = std::pair<std::uint32_t, std::uint32_t>;  // the lower place first

// Marks the edges of the scene that are segments.
class SeamFinder {
 public:
  explicit SeamFinder(const Scene& scene) : scene_(scene), nearest_(scene.positions) {
    Bounds<glm::dvec3> bounds;
    for (const Vec3f p : scene.positions) bounds.add(to_dvec(p));
    const glm::dvec3 size = bounds.size();
    squared_ = kNear * kNear * glm::dot(size, size);
    for (const std::uint32_t v : scene.indices) places_.push_back(place(scene.positions[v], 0));
  }

  void mark(const Polylines& lines, SeamLines& seams) const {
    std::vector<std::pair<Edge, std::size_t>> wanted;  // and the segment
    const auto at = [&](std::size_t i) {
      const Vec3d p = lines.points[i], o = scene_.origin;
      return place({float(p.x - o.x), float(p.y - o.y), float(p.z - o.z)}, squared_);
    };
    for (std::size_t s = 0; s < lines.segments.size(); ++s) {
      const std::uint32_t a = at(lines.segments[s][0]), b = at(lines.segments[s][1]);
      if (a != kNoIndex && b != kNoIndex) wanted.push_back({std::minmax(a, b), s});
    }
    std::sort(wanted.begin(), wanted.end());
    std::vector<std::uint8_t> found(lines.segments.size(), 0);
    seams.edges.assign(scene_.indices.size(), 0);
    for (std::uint32_t h = 0; h < places_.size(); ++h) {
      const Edge edge = std::minmax(places_[h], places_[next_half_edge(h)]);
      for (auto w = std::lower_bound(wanted.begin(), wanted.end(), std::pair(edge, std::size_t{0}));
           w != wanted.end() && w->first == edge; ++w)
        seams.edges[h] = found[w->second] = 1;
    }
    seams.segments = found.size();
    seams.found = std::size_t(std::count(found.begin(), found.end(), 1));
  }

 private:
  // Positions at one place get the lowest number of them.
  std::uint32_t place(Vec3f p, double squared) const { return nearest_.find(p, squared).id; }

  const Scene& scene_;
  NearestPoint nearest_;
  double squared_ = 0;                 // of the farthest that a position may lie off
  std::vector<std::uint32_t> places_;  // one per corner
};

}  // namespace

Result<SeamLines> read_seam_lines(const std::filesystem::path& path, const Scene& scene) {
  const auto bytes = read_text_bytes(path);
  if (!bytes.ok()) return bytes.status();
  const Result<Polylines> lines = LineReader(path, *bytes).run();
  if (!lines.ok()) return lines.status();
  const auto bad = [&](std::string text) {
    return Status(ErrorCode::bad_input, path.string() + ": " + std::move(text));
  };
  if (lines->segments.empty())
    return bad("no polyline (seams are the lines `l i j ...` of an OBJ file)");
  SeamLines seams;
  SeamFinder(scene).mark(*lines, seams);
  if (seams.found == 0)
    return bad(
        fmt::format("none of the {} segments of its polylines is an edge of the scene (give "
                    "them in the scene's coordinates, along its edges)",
                    seams.segments));
  return seams;
}

}  // namespace atlas
