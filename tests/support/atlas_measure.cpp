#include "tests/support/atlas_measure.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <fstream>
#include <glm/geometric.hpp>
#include <glm/mat2x2.hpp>
#include <glm/matrix.hpp>
#include <map>
#include <sstream>
#include <string>
#include <unordered_map>

#include "libatlas/core/disjoint_sets.h"
#include "libatlas/core/glm_bridge.h"

namespace atlas::test {
namespace {

using Id = std::uint32_t;

// Faces with welded positions, and with uvs in texels.
struct Prepared {
  const UvMesh& mesh;
  std::vector<Id> place;          // one per position
  std::vector<glm::dvec2> texel;  // one per uv
  std::vector<Id> chart;          // one per face
  double seam = 0;

  Prepared(const UvMesh& m, int width, int height);
  std::array<glm::dvec2, 3> uv(std::size_t face) const {
    const auto& t = mesh.faces[face].uv;
    return {texel[t[0]], texel[t[1]], texel[t[2]]};
  }
  glm::dvec3 position(std::size_t face, int k) const {
    return to_glm(mesh.positions[mesh.faces[face].position[k]]);
  }
};

struct Side {
  Id face;
  glm::dvec2 low, high;  // texels at the edge's lower and higher position
};

Prepared::Prepared(const UvMesh& m, int width, int height) : mesh(m) {
  std::map<std::array<double, 3>, Id> places;
  for (const Vec3d& p : mesh.positions)
    place.push_back(places.emplace(std::array{p.x, p.y, p.z}, Id(places.size())).first->second);
  for (const Vec2d& t : mesh.uvs) texel.emplace_back(t.x * width, t.y * height);
  std::unordered_map<std::uint64_t, std::vector<Side>> edges;
  edges.reserve(mesh.faces.size() * 2);
  std::unordered_map<std::uint64_t, double> length;
  for (Id f = 0; f < mesh.faces.size(); ++f)
    for (int k = 0; k < 3; ++k) {
      const int next = (k + 1) % 3;
      Id a = place[mesh.faces[f].position[k]], b = place[mesh.faces[f].position[next]];
      glm::dvec2 ta = uv(f)[k], tb = uv(f)[next];
      if (a > b) {
        std::swap(a, b);
        std::swap(ta, tb);
      }
      edges[std::uint64_t(a) << 32 | b].push_back({f, ta, tb});
      length[std::uint64_t(a) << 32 | b] = glm::distance(position(f, k), position(f, next));
    }
  DisjointSets sets(mesh.faces.size());
  for (const auto& [key, sides] : edges)
    for (std::size_t i = 0; i < sides.size(); ++i)
      for (std::size_t j = i + 1; j < sides.size(); ++j) {
        const bool joined = mesh.faces[sides[i].face].page == mesh.faces[sides[j].face].page &&
                            sides[i].low == sides[j].low && sides[i].high == sides[j].high;
        if (joined)
          sets.join(sides[i].face, sides[j].face);
        else if (sides.size() == 2)
          seam += length[key];
      }
  for (Id f = 0; f < mesh.faces.size(); ++f) chart.push_back(sets.find(f));
}

double cross2(glm::dvec2 a, glm::dvec2 b) {
  return a.x * b.y - a.y * b.x;
}

double uv_area(const Prepared& p, std::size_t f) {
  const auto t = p.uv(f);
  return 0.5 * cross2(t[1] - t[0], t[2] - t[0]);
}

double surface_area(const Prepared& p, std::size_t f) {
  const glm::dvec3 a = p.position(f, 0);
  return 0.5 * glm::length(glm::cross(p.position(f, 1) - a, p.position(f, 2) - a));
}

// Returns the singular values of the map from texels to the surface, the larger one first. They are
// those of the 2x2 matrix that maps uv edges to the triangle's edges in a frame of its plane.
std::pair<double, double> singular_values(const Prepared& p, std::size_t f) {
  const auto t = p.uv(f);
  const glm::dvec3 e1 = p.position(f, 1) - p.position(f, 0),
                   e2 = p.position(f, 2) - p.position(f, 0);
  const glm::dvec3 x = glm::normalize(e1);
  const double along = glm::dot(e2, x), up = glm::length(e2 - along * x);
  const glm::dmat2 edges(glm::dvec2(glm::length(e1), 0), glm::dvec2(along, up));
  const glm::dmat2 m = edges * glm::inverse(glm::dmat2(t[1] - t[0], t[2] - t[0]));
  // |s1 + s2| and |s1 - s2| are the lengths of the conformal and the anticonformal part.
  const double sum = std::hypot(m[0][0] + m[1][1], m[0][1] - m[1][0]);
  const double difference = std::hypot(m[0][0] - m[1][1], m[0][1] + m[1][0]);
  return {(sum + difference) / 2, std::abs(sum - difference) / 2};
}

double percentile(std::vector<std::pair<double, double>>& values, double weight, double share) {
  std::sort(values.begin(), values.end());
  double sum = 0;
  for (const auto& [value, w] : values)
    if ((sum += w) >= share * weight) return value;
  return values.empty() ? 0 : values.back().first;
}

void measure_distortion(const Prepared& p, double page_area, AtlasMeasures& out) {
  const std::size_t n = p.mesh.faces.size();
  double surface = 0, flat = 0;
  std::unordered_map<Id, double> orientation;
  for (std::size_t f = 0; f < n; ++f) {
    const double a = uv_area(p, f);
    surface += surface_area(p, f);
    flat += std::abs(a);
    orientation[p.chart[f]] += a;
  }
  out.charts = orientation.size();
  for (const auto& [chart, sign] : orientation) out.mirrored += sign < 0;
  out.utilization = flat / (page_area * double(out.pages));
  out.scale = surface > 0 ? std::sqrt(flat / surface) : 0;
  out.seam = surface > 0 ? p.seam / std::sqrt(surface) : 0;
  double weight = 0;
  std::vector<std::pair<double, double>> stretches, ratios;
  for (std::size_t f = 0; f < n; ++f) {
    const double a = uv_area(p, f), area = surface_area(p, f);
    if (area <= 1e-14 * surface / double(n)) continue;
    if (std::abs(a) < 1e-12 * page_area) {
      ++out.degenerate;
      continue;
    }
    out.flipped += (a < 0) != (orientation[p.chart[f]] < 0);
    auto [s1, s2] = singular_values(p, f);
    s1 *= out.scale;
    s2 *= out.scale;
    const double ratio = s1 / std::max(s2, 1e-300);
    out.stretch_l2 += area * (s1 * s1 + s2 * s2) / 2;
    out.stretch_linf = std::max(out.stretch_linf, s1);
    out.conformal_mean += area * ratio;
    out.conformal_max = std::max(out.conformal_max, ratio);
    out.dirichlet_mean += area * (s1 * s1 + s2 * s2 + 1 / (s1 * s1) + 1 / (s2 * s2)) / 4;
    weight += area;
    stretches.emplace_back(s1, area);
    ratios.emplace_back(ratio, area);
  }
  if (weight > 0) {
    out.stretch_l2 = std::sqrt(out.stretch_l2 / weight);
    out.conformal_mean /= weight;
    out.dirichlet_mean /= weight;
  }
  out.stretch_999 = percentile(stretches, weight, 0.999);
  out.conformal_999 = percentile(ratios, weight, 0.999);
}

std::int64_t floor_div(std::int64_t a, std::int64_t b) {
  const std::int64_t q = a / b;
  return q * b > a ? q - 1 : q;
}

using Snapped =
    std::array<std::array<std::int64_t, 2>, 3>;  // corners in 1/256 texel, anticlockwise

// Returns the first and last texel of a row whose centres lie inside. Each edge bounds x from one
// side.
std::pair<std::int64_t, std::int64_t> row_span(const Snapped& c, std::int64_t y,
                                               std::int64_t width) {
  std::int64_t first = 0, last = width - 1;
  const std::int64_t py = 256 * y + 128;
  for (int k = 0; k < 3; ++k) {
    const auto& a = c[k];
    const auto& b = c[(k + 1) % 3];
    const std::int64_t dx = b[0] - a[0], dy = b[1] - a[1];
    // A centre is inside where dx (py - ay) - dy (px - ax) > 0, or = 0 on a left or top edge (dy >
    // 0, or dy = 0 and dx < 0). With px = 256 x + 128 that means dy 256 x <= limit, where limit is
    // one less for the strict comparison.
    const bool owns = dy > 0 || (dy == 0 && dx < 0);
    const std::int64_t limit = dx * (py - a[1]) + dy * (a[0] - 128) - (owns ? 0 : 1);
    if (dy > 0)
      last = std::min(last, floor_div(limit, 256 * dy));
    else if (dy < 0)
      first = std::max(first, -floor_div(limit, -256 * dy));
    else if (limit < 0)
      return {1, 0};
  }
  return {first, last};
}

// Returns whether bilinear lookups inside the triangle read texel (x, y). They do if the triangle
// and the open square of two texels around the centre intersect, tested by separating axes. The
// square is smaller by 1e-6 because of rounding.
bool reads(const std::array<glm::dvec2, 3>& t, int x, int y) {
  const glm::dvec2 centre(x + 0.5, y + 0.5);
  constexpr double kHalf = 1 - 1e-6;
  for (int axis = 0; axis < 2; ++axis) {
    const auto [low, high] = std::minmax({t[0][axis], t[1][axis], t[2][axis]});
    if (centre[axis] + kHalf <= low || centre[axis] - kHalf >= high) return false;
  }
  for (int k = 0; k < 3; ++k) {
    const glm::dvec2 e = t[(k + 1) % 3] - t[k], n(-e.y, e.x);
    if (glm::dot(n, centre - t[k]) <= -kHalf * (std::abs(n.x) + std::abs(n.y))) return false;
  }
  return true;
}

// Measures the texels of one page.
class PageMeter {
 public:
  PageMeter(int width, int height)
      : width_(width),
        height_(height),
        count_(std::size_t(width) * height),
        owner_(count_.size(), kNobody),
        shared_(count_.size()) {}

  void add(std::array<glm::dvec2, 3> t, Id chart, AtlasMeasures& out) {
    Snapped c;
    for (int k = 0; k < 3; ++k) {
      c[k] = {std::llround(t[k].x * 256), std::llround(t[k].y * 256)};
      if (c[k][0] < 0 || c[k][1] < 0 || c[k][0] > 256L * width_ || c[k][1] > 256L * height_) {
        ++out.outside;
        return;
      }
    }
    const std::int64_t area =
        (c[1][0] - c[0][0]) * (c[2][1] - c[0][1]) - (c[2][0] - c[0][0]) * (c[1][1] - c[0][1]);
    if (area < 0) std::swap(c[1], c[2]);
    if (area != 0) add_centres(c);
    if (cross2(t[1] - t[0], t[2] - t[0]) < 0) std::swap(t[1], t[2]);
    add_reads(t, chart);
  }

  void finish(AtlasMeasures& out, std::uint64_t& covered) const {
    for (std::uint8_t n : count_) {
      covered += n > 0;
      out.overlap += n > 1;
    }
    for (std::uint8_t s : shared_) out.bleed += s;
  }

 private:
  static constexpr Id kNobody = ~0u;

  void add_centres(const Snapped& c) {
    const auto [low, high] = std::minmax({c[0][1], c[1][1], c[2][1]});
    for (std::int64_t y = std::max<std::int64_t>(0, low / 256 - 1);
         y <= std::min<std::int64_t>(height_ - 1, high / 256); ++y) {
      const auto [first, last] = row_span(c, y, width_);
      for (std::int64_t x = first; x <= last; ++x) {
        std::uint8_t& n = count_[std::size_t(y) * width_ + x];
        n = std::uint8_t(std::min(255, n + 1));
      }
    }
  }

  void add_reads(const std::array<glm::dvec2, 3>& t, Id chart) {
    const auto [x0, x1] = std::minmax({t[0].x, t[1].x, t[2].x});
    const auto [y0, y1] = std::minmax({t[0].y, t[1].y, t[2].y});
    for (int y = std::max(0, int(y0 - 2)); y <= std::min(height_ - 1, int(y1 + 2)); ++y)
      for (int x = std::max(0, int(x0 - 2)); x <= std::min(width_ - 1, int(x1 + 2)); ++x) {
        if (!reads(t, x, y)) continue;
        const std::size_t i = std::size_t(y) * width_ + x;
        if (owner_[i] == kNobody) owner_[i] = chart;
        if (owner_[i] != chart) shared_[i] = 1;
      }
  }

  int width_, height_;
  std::vector<std::uint8_t> count_;
  std::vector<Id> owner_;
  std::vector<std::uint8_t> shared_;
};

// Parses "v/t/n" and returns (v, t), with 0 for a missing number.
std::pair<long, long> corner_of(const std::string& word) {
  const char* end = word.data() + word.size();
  long v = 0, t = 0;
  const char* at = std::from_chars(word.data(), end, v).ptr;
  if (at != end && *at == '/') std::from_chars(at + 1, end, t);
  return {v, t};
}

}  // namespace

std::vector<std::uint32_t> charts_by_texcoord(const UvMesh& mesh) {
  DisjointSets sets(mesh.uvs.size());
  for (const UvMesh::Face& f : mesh.faces)
    for (int k = 1; k < 3; ++k) sets.join(f.uv[0], f.uv[k]);
  constexpr Id kNone = 0xffffffffu;
  std::vector<Id> chart, number(mesh.uvs.size(), kNone);
  Id count = 0;
  for (const UvMesh::Face& f : mesh.faces) {
    Id& n = number[sets.find(f.uv[0])];
    if (n == kNone) n = count++;
    chart.push_back(n);
  }
  return chart;
}

Result<UvMesh> read_uv_obj(const std::filesystem::path& path) {
  std::ifstream file(path);
  if (!file) return Status(ErrorCode::not_found, path.string() + ": cannot be opened");
  UvMesh mesh;
  std::map<std::string, Id> pages;
  Id page = 0;
  std::string line, word;
  for (int number = 1; std::getline(file, line); ++number) {
    std::istringstream words(line);
    words >> word;
    if (!words) continue;
    if (word == "v") {
      Vec3d p;
      words >> p.x >> p.y >> p.z;
      mesh.positions.push_back(p);
    } else if (word == "vt") {
      Vec2d t;
      words >> t.x >> t.y;
      mesh.uvs.push_back(t);
    } else if (word == "usemtl") {
      words >> word;
      page = pages.emplace(word, Id(pages.size())).first->second;
    } else if (word == "f") {
      std::vector<std::pair<long, long>> corners;
      while (words >> word) {
        auto [v, t] = corner_of(word);
        if (v < 0) v += long(mesh.positions.size()) + 1;
        if (t < 0) t += long(mesh.uvs.size()) + 1;
        if (v < 1 || v > long(mesh.positions.size()) || t < 0 || t > long(mesh.uvs.size()))
          return Status(ErrorCode::bad_input,
                        path.string() + ":" + std::to_string(number) + ": index out of range");
        corners.emplace_back(v, t);
      }
      for (std::size_t k = 2; k < corners.size(); ++k) {
        UvMesh::Face face;
        face.page = page;
        bool complete = true;
        for (int c = 0; c < 3; ++c) {
          const auto [v, t] = corners[c == 0 ? 0 : k - 2 + c];
          complete &= t > 0;
          face.position[c] = Id(v - 1);
          face.uv[c] = Id(t - 1);
        }
        if (complete)
          mesh.faces.push_back(face);
        else
          ++mesh.faces_without_uv;
      }
    }
  }
  mesh.pages = std::max<Id>(1, Id(pages.size()));
  return mesh;
}

AtlasMeasures measure_atlas(const UvMesh& mesh, int width, int height) {
  AtlasMeasures out;
  out.triangles = mesh.faces.size();
  out.faces_without_uv = mesh.faces_without_uv;
  out.pages = mesh.pages;
  const Prepared prepared(mesh, width, height);
  measure_distortion(prepared, double(width) * height, out);
  std::vector<std::vector<Id>> by_page(mesh.pages);
  for (Id f = 0; f < mesh.faces.size(); ++f) by_page[mesh.faces[f].page].push_back(f);
  std::uint64_t covered = 0;
  for (const auto& faces : by_page) {
    PageMeter meter(width, height);
    for (Id f : faces) meter.add(prepared.uv(f), prepared.chart[f], out);
    meter.finish(out, covered);
  }
  out.covered = double(covered) / (double(width) * height * mesh.pages);
  return out;
}

}  // namespace atlas::test
