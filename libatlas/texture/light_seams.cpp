#include "libatlas/texture/light_seams.h"

#include <algorithm>
#include <cmath>
#include <span>
#include <tuple>
#include <unordered_map>

#include "libatlas/charts/mesh/weld.h"
#include "libatlas/core/degrees.h"
#include "libatlas/core/disjoint_sets.h"
#include "libatlas/core/glm_bridge.h"
#include "libatlas/core/half_edge.h"
#include "libatlas/core/parallel.h"
#include "libatlas/scene/triangle_area.h"
#include "libatlas/texture/standing_walls.h"

namespace atlas {
namespace {

// See LightSeamOptions::texel.
constexpr double kThinTexels = 4;

// Where the light jumps along this share of the creases between two faces, the faces part along all
// of them. Seams that end midway would leave slits in charts.
constexpr double kSomeOfACrease = 0.25;

// A half-edge, by the welded vertices that its edge connects.
struct Side {
  std::uint32_t low, high, half_edge;
};

// What is known of a half-edge at an edge that several triangles share.
struct Bank {
  bool upward;        // runs from the edge's lower vertex to the higher one
  Vec3f light[2];     // display values at these
  glm::dvec3 normal;  // of its triangle, unit length; 0 without area
};

// A half-edge at which its face may end: no other triangle of its edge continues it smoothly, or
// one does so beyond something that stands on the edge.
struct Crease {
  std::uint32_t half_edge, other;  // of the same edge: the one that continues it, else any
  double length;
  bool jumps;  // the light is another on the triangle that continues it, else on all others
};

// A half-edge that another continues smoothly with visibly other light.
struct Step {
  std::uint32_t half_edge, other;
};

double difference(const Vec3f& a, const Vec3f& b) {
  return std::max({std::abs(a.x - b.x), std::abs(a.y - b.y), std::abs(a.z - b.z)});
}

class LightSeamFinder {
 public:
  LightSeamFinder(const LuminanceSampler& sampler, const ToneMapping& tone,
                  const LightSeamOptions& options)
      : scene_(sampler.scene()),
        sampler_(sampler),
        tone_(tone),
        options_(options),
        least_cosine_(cosine_of(options.crease_degrees)),
        faces_(scene_.positions.size()) {}

  LightSeams run(const Context& context) {
    weld();
    gather_sides();
    if (sides_.empty() || context.cancelled()) return {};
    find_creases();
    part_below_walls(context);
    if (context.cancelled()) return {};
    if (std::none_of(creases_.begin(), creases_.end(), [](const Crease& c) { return c.jumps; }))
      return {};
    join_faces();
    keep_jumping_creases();
    keep_creases_of_wide_faces();
    return result();
  }

 private:
  void weld() {
    const std::vector<std::uint8_t> used = used_vertices(scene_.indices, scene_.positions.size());
    welded_ = weld_vertices(scene_.positions, used);
    differs_.assign(welded_.points.size(), 0);
    for (std::size_t v = 0; v < used.size(); ++v) {
      if (!used[v]) continue;
      const std::uint32_t at = welded_.place[v];
      if (scene_.illumination[v] != scene_.illumination[welded_.source[at]]) differs_[at] = 1;
    }
  }

  std::uint32_t place(std::uint32_t h) const { return welded_.place[scene_.indices[h]]; }
  glm::dvec3 position(std::uint32_t h) const {
    return to_dvec(scene_.positions[scene_.indices[h]]);
  }

  double length_of(std::uint32_t h) const {
    return glm::distance(position(h), position(next_half_edge(h)));
  }

  // Fills sides_ with the half-edges at one of whose ends vertices differ in light, sorted by edge.
  void gather_sides() {
    const auto corners = static_cast<std::uint32_t>(scene_.indices.size());
    for (std::uint32_t h = 0; h < corners; ++h) {
      const std::uint32_t a = place(h), b = place(next_half_edge(h));
      if (a != b && (differs_[a] || differs_[b]))
        sides_.push_back({std::min(a, b), std::max(a, b), h});
    }
    std::sort(sides_.begin(), sides_.end(), [](const Side& a, const Side& b) {
      return std::tie(a.low, a.high, a.half_edge) < std::tie(b.low, b.high, b.half_edge);
    });
  }

  void find_creases() {
    std::vector<Bank> banks;
    for (std::size_t i = 0, j = 0; i < sides_.size(); i = j) {
      banks.clear();
      for (;
           j < sides_.size() && sides_[j].low == sides_[i].low && sides_[j].high == sides_[i].high;
           ++j) {
        banks.push_back(bank(sides_[j]));
      }
      for (std::size_t k = i; k < j && j - i > 1; ++k) judge(i, k - i, banks);
    }
  }

  // Appends side first + k to the creases, or joins it to the face that continues it.
  void judge(std::size_t first, std::size_t k, std::span<const Bank> banks) {
    const std::uint32_t h = sides_[first + k].half_edge;
    const double length = length_of(h);
    const std::size_t next = continuation(k, banks);
    if (next != k) {
      const std::uint32_t other = sides_[first + next].half_edge;
      const bool jumps = jump(banks[next], banks[k]) > options_.visible_jump;
      if (parted(k, banks))
        creases_.push_back({h, other, length, jumps});
      else if (jumps)
        steps_.push_back({h, other});
      else
        faces_.join(scene_.indices[h], scene_.indices[other]);
      return;
    }
    bool jumps = true;
    for (std::size_t i = 0; i < banks.size(); ++i)
      jumps = jumps && (i == k || jump(banks[i], banks[k]) > options_.visible_jump);
    creases_.push_back({h, sides_[first + (k == 0)].half_edge, length, jumps});
  }

  // Returns the bank that continues bank k smoothly, if possible with its orientation; k if there
  // is none.
  std::size_t continuation(std::size_t k, std::span<const Bank> banks) const {
    std::size_t found = k;
    for (std::size_t i = 0; i < banks.size(); ++i) {
      if (i == k || !smooth(banks[i], banks[k])) continue;
      if (banks[i].upward != banks[k].upward) return i;
      if (found == k) found = i;
    }
    return found;
  }

  // Returns whether something stands on the surface at the edge, such as the partition between two
  // rooms. Layers of a thin sheet do not.
  bool parted(std::size_t k, std::span<const Bank> banks) const {
    return std::any_of(banks.begin(), banks.end(), [&](const Bank& bank) {
      return bank.normal != glm::dvec3(0) &&
             std::abs(glm::dot(bank.normal, banks[k].normal)) <= least_cosine_;
    });
  }

  Bank bank(const Side& side) const {
    const std::uint32_t h = side.half_edge, t = h / 3;
    const LuminanceSampler::Triangle triangle = sampler_.prepare(t, 0);
    const auto light = [&](std::uint32_t corner) {
      const float* e = triangle.illumination[corner % 3];
      return tone_.display({e[0], e[1], e[2]});
    };
    const glm::dvec3 normal = normal_of(t);
    const Vec3f from = light(h), to = light(next_half_edge(h));
    if (place(h) == side.low) return {true, {from, to}, normal};
    return {false, {to, from}, normal};
  }

  // Returns 0 for a triangle without area.
  glm::dvec3 normal_of(std::uint32_t t) const {
    const glm::dvec3 p = position(3 * t);
    const glm::dvec3 cross = glm::cross(position(3 * t + 1) - p, position(3 * t + 2) - p);
    const double twice = glm::length(cross);
    return twice > 0 ? cross / twice : glm::dvec3(0);
  }

  bool smooth(const Bank& a, const Bank& b) const {
    const double cosine = glm::dot(a.normal, b.normal);
    return (a.upward != b.upward ? cosine : -cosine) > least_cosine_;
  }

  static double jump(const Bank& a, const Bank& b) {
    return (difference(a.light[0], b.light[0]) + difference(a.light[1], b.light[1])) / 2;
  }

  // A partition that stands on the floors of two rooms, or passes through them, often shares no
  // vertices with them. Makes creases of the steps that something stands on, and joins the faces
  // at all others.
  void part_below_walls(const Context& context) {
    if (steps_.empty()) return;
    join_faces();
    const std::vector<std::uint8_t> stands = stand_at_steps(context);
    if (context.cancelled()) return;
    for (std::size_t i = 0; i < steps_.size(); ++i) {
      const auto [h, other] = steps_[i];
      if (stands[i])
        creases_.push_back({h, other, length_of(h), true});
      else
        faces_.join(scene_.indices[h], scene_.indices[other]);
    }
    steps_.clear();
  }

  // Returns for each step whether something stands on it. Faces that are not wide even if they end
  // at all steps, as where light is constant per triangle, are not looked at.
  std::vector<std::uint8_t> stand_at_steps(const Context& context) {
    std::vector<std::uint8_t> stands(steps_.size(), 0);
    std::vector<std::uint32_t> wide;
    const FaceSizes sizes = face_sizes();
    for (std::uint32_t i = 0; i < stands.size(); ++i)
      if (!thin(sizes, steps_[i].half_edge) && !thin(sizes, steps_[i].other)) wide.push_back(i);
    if (wide.empty()) return stands;
    const StandingWalls walls(scene_, options_.texel);
    parallel_for(context, wide.size(), 64, [&](std::size_t begin, std::size_t end) {
      for (std::size_t k = begin; k < end; ++k) {
        const std::uint32_t h = steps_[wide[k]].half_edge;
        stands[wide[k]] = walls.along({position(h), position(next_half_edge(h)), normal_of(h / 3)},
                                      least_cosine_);
      }
    });
    return stands;
  }

  // A face is what hangs together by vertices of the input, by vertices of one light, or by edges
  // that are no creases.
  void join_faces() {
    for (std::size_t h = 0; h < scene_.indices.size(); h += 3) {
      faces_.join(scene_.indices[h], scene_.indices[h + 1]);
      faces_.join(scene_.indices[h], scene_.indices[h + 2]);
    }
    for (std::uint32_t v = 0; v < scene_.positions.size(); ++v) {
      const std::uint32_t at = welded_.place[v];
      if (at != kNoIndex && !differs_[at]) faces_.join(v, welded_.source[at]);
    }
  }

  std::uint32_t face(std::uint32_t h) { return faces_.find(scene_.indices[h]); }

  void keep_jumping_creases() {
    struct Lengths {
      double jumping = 0, all = 0;
    };
    std::unordered_map<std::uint64_t, Lengths> between;  // two faces
    const auto key = [&](const Crease& c) {
      const std::uint64_t a = face(c.half_edge), b = face(c.other);
      return std::min(a, b) << 32 | std::max(a, b);
    };
    for (const Crease& c : creases_) {
      Lengths& lengths = between[key(c)];
      lengths.all += c.length;
      lengths.jumping += c.jumps ? c.length : 0;
    }
    std::erase_if(creases_, [&](const Crease& c) {
      if (face(c.half_edge) == face(c.other)) return !c.jumps;
      const Lengths& lengths = between[key(c)];
      return lengths.jumping < kSomeOfACrease * lengths.all;
    });
  }

  // By the vertex that stands for a face: its area, and the length of its creases and steps.
  struct FaceSizes {
    std::vector<double> area, border;
  };

  FaceSizes face_sizes() {
    FaceSizes sizes{std::vector<double>(scene_.positions.size(), 0), {}};
    sizes.border = sizes.area;
    for (std::uint32_t h = 0; h < scene_.indices.size(); h += 3)
      sizes.area[face(h)] += triangle_area(scene_, h / 3);
    for (const Crease& c : creases_) sizes.border[face(c.half_edge)] += c.length;
    for (const Step& s : steps_) sizes.border[face(s.half_edge)] += length_of(s.half_edge);
    return sizes;
  }

  bool thin(const FaceSizes& sizes, std::uint32_t h) {
    const std::uint32_t f = face(h);
    return 2 * sizes.area[f] < kThinTexels * options_.texel * sizes.border[f];
  }

  void keep_creases_of_wide_faces() {
    const FaceSizes sizes = face_sizes();
    std::erase_if(creases_, [&](const Crease& c) {
      return thin(sizes, c.half_edge) || thin(sizes, c.other);
    });
  }

  LightSeams result() const {
    LightSeams seams;
    if (creases_.empty()) return seams;
    seams.edges.assign(scene_.indices.size(), 0);
    for (const Crease& c : creases_) {
      seams.edges[c.half_edge] = 1;
      if (c.half_edge < c.other || !seams.edges[c.other]) seams.length += c.length;
    }
    return seams;
  }

  const Scene& scene_;
  const LuminanceSampler& sampler_;
  const ToneMapping& tone_;
  const LightSeamOptions& options_;
  double least_cosine_;
  DisjointSets faces_;  // of vertices
  WeldedVertices welded_;
  std::vector<std::uint8_t> differs_;  // one per place: vertices there have different light
  std::vector<Side> sides_;
  std::vector<Crease> creases_;
  std::vector<Step> steps_;
};

// Triangles without area close T-junctions: a vertex hangs on the edge of a neighbour, whose light
// runs straight from end to end.
class HangingVertices {
 public:
  HangingVertices(const LuminanceSampler& sampler, const ToneMapping& tone, double visible_jump)
      : scene_(sampler.scene()), sampler_(sampler), tone_(tone), visible_jump_(visible_jump) {
    for (std::uint32_t t = 0; t < scene_.triangle_count(); ++t) measure(t);
  }

  // Makes seams of all such edges if the light jumps along enough of them.
  void add_to(LightSeams& seams) const {
    if (edges_.empty() || jumping_ < kSomeOfACrease * all_) return;
    seams.edges.resize(scene_.indices.size(), 0);
    seams.length += all_;
    for (const std::uint32_t h : edges_) seams.edges[h] = 1;
  }

 private:
  // A vertex this near to an edge, relative to its length, hangs on it.
  static constexpr double kNear = 1e-6;

  glm::dvec3 position(std::uint32_t corner) const {
    return to_dvec(scene_.positions[scene_.indices[corner]]);
  }

  void measure(std::uint32_t t) {
    const glm::dvec3 p = position(3 * t), q = position(3 * t + 1), r = position(3 * t + 2);
    const double squared[3] = {glm::dot(q - p, q - p), glm::dot(r - q, r - q),
                               glm::dot(p - r, p - r)};
    const auto k = std::uint32_t(std::max_element(squared, squared + 3) - squared);
    const glm::dvec3 cross = glm::cross(q - p, r - p);
    if (!(glm::dot(cross, cross) <= kNear * kNear * squared[k] * squared[k])) return;
    if (!(squared[0] > 0 && squared[1] > 0 && squared[2] > 0)) return;
    const std::uint32_t h = 3 * t + k;
    const double length = std::sqrt(squared[k]);
    edges_.push_back(h);
    all_ += length;
    const double at = glm::dot(position(previous_half_edge(h)) - position(h),
                               position(next_half_edge(h)) - position(h)) /
                      squared[k];
    if (jump(h, std::clamp(float(at), 0.0f, 1.0f)) > visible_jump_) jumping_ += length;
  }

  // Returns the difference between the light of the third vertex and that at its place on the edge.
  double jump(std::uint32_t h, float at) const {
    const LuminanceSampler::Triangle triangle = sampler_.prepare(h / 3, 0);
    float on_edge[3] = {0, 0, 0}, hanging[3] = {0, 0, 0};
    on_edge[h % 3] = 1 - at;
    on_edge[next_half_edge(h) % 3] = at;
    hanging[previous_half_edge(h) % 3] = 1;
    const auto shown = [&](const float w[3]) {
      return tone_.display(LuminanceSampler::sample(triangle, w[0], w[1], w[2]));
    };
    return difference(shown(on_edge), shown(hanging));
  }

  const Scene& scene_;
  const LuminanceSampler& sampler_;
  const ToneMapping& tone_;
  double visible_jump_;
  std::vector<std::uint32_t> edges_;  // half-edges that a vertex hangs on
  double all_ = 0, jumping_ = 0;      // length of them
};

}  // namespace

LightSeams find_light_seams(const LuminanceSampler& sampler, const ToneMapping& tone,
                            const LightSeamOptions& options, const Context& context) {
  LightSeams seams = LightSeamFinder(sampler, tone, options).run(context);
  HangingVertices(sampler, tone, options.visible_jump).add_to(seams);
  return seams;
}

}  // namespace atlas
