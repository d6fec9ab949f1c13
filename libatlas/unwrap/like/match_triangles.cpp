#include "libatlas/unwrap/like/match_triangles.h"

#include <algorithm>
#include <array>
#include <functional>
#include <glm/geometric.hpp>
#include <map>
#include <tuple>
#include <utility>

#include "libatlas/core/glm_bridge.h"
#include "libatlas/core/nearest_point.h"
#include "libatlas/core/sort_total.h"

namespace atlas {
namespace {

// A triangle by its places in ascending order.
struct Key {
  std::array<std::uint32_t, 3> places;
  std::uint32_t triangle;
  bool operator<(const Key& other) const {  // the arrays of libc++ 14 have no <=>
    return std::tie(places, triangle) < std::tie(other.places, other.triangle);
  }
};

Key key_of(std::array<std::uint32_t, 3> places, std::uint32_t triangle) {
  std::sort(places.begin(), places.end());
  return {places, triangle};
}

class Matcher {
 public:
  Matcher(const JoinedMesh& mesh, const JoinedMesh& earlier, double tolerance)
      : mesh_(mesh),
        earlier_(earlier),
        squared_(tolerance * tolerance),
        place_of_(mesh.points.size(), kNoIndex),
        owner_(earlier.points.size(), kNoIndex),
        used_(earlier.triangle_count(), 0),
        matches_(mesh.triangle_count()) {}

  std::vector<TriangleMatch> run() {
    match_places();
    match_by_places();
    match_across();
    for (std::uint32_t t = 0; t < matches_.size(); ++t) {
      TriangleMatch& m = matches_[t];
      for (std::uint32_t k = 0; k < 3 && m.earlier != kNoIndex; ++k)
        m.moved =
            m.moved || distance(corner(t, k), earlier_corner(m.earlier, m.corners[k])) > squared_;
    }
    return std::move(matches_);
  }

 private:
  std::uint32_t corner(std::uint32_t t, std::uint32_t k) const { return mesh_.corners[3 * t + k]; }
  std::uint32_t earlier_corner(std::uint32_t t, std::uint32_t k) const {
    return earlier_.corners[3 * t + k];
  }

  double distance(std::uint32_t place, std::uint32_t earlier) const {
    const glm::dvec3 d = to_dvec(mesh_.points[place]) - to_dvec(earlier_.points[earlier]);
    return glm::dot(d, d);
  }

  void match_places() {
    struct Object {
      std::vector<std::uint32_t> places = {}, earlier = {};
    };
    std::map<std::uint32_t, Object> objects;
    const bool apart = !mesh_.objects.empty() && !earlier_.objects.empty();
    for (std::uint32_t p = 0; p < place_of_.size(); ++p)
      objects[apart ? mesh_.objects[p] : 0].places.push_back(p);
    for (std::uint32_t p = 0; p < owner_.size(); ++p)
      objects[apart ? earlier_.objects[p] : 0].earlier.push_back(p);
    for (const auto& [number, object] : objects) match_places(object.places, object.earlier);
  }

  // Each place takes the nearest earlier one, and each earlier one keeps the nearest of those.
  void match_places(const std::vector<std::uint32_t>& places,
                    const std::vector<std::uint32_t>& earlier) {
    std::vector<Vec3f> points;
    for (const std::uint32_t p : earlier) points.push_back(earlier_.points[p]);
    const NearestPoint nearest(points);
    for (const std::uint32_t p : places) {
      const auto found = nearest.find(mesh_.points[p], squared_);
      if (found.id == kNoIndex) continue;
      const std::uint32_t was = earlier[found.id];
      std::uint32_t& owner = owner_[was];
      if (owner != kNoIndex && distance(owner, was) <= found.squared) continue;
      if (owner != kNoIndex) place_of_[owner] = kNoIndex;
      owner = p;
      place_of_[p] = was;
    }
  }

  void match_by_places() {
    std::vector<Key> keys;
    for (std::uint32_t t = 0; t < used_.size(); ++t)
      keys.push_back(key_of({earlier_corner(t, 0), earlier_corner(t, 1), earlier_corner(t, 2)}, t));
    sort_total(keys.begin(), keys.end(), std::less<>());
    for (std::uint32_t t = 0; t < matches_.size(); ++t) {
      std::array<std::uint32_t, 3> places;
      for (std::uint32_t k = 0; k < 3; ++k) places[k] = place_of_[corner(t, k)];
      if (std::find(places.begin(), places.end(), kNoIndex) == places.end())
        choose(t, places, keys);
    }
  }

  // Of several triangles with these corners, takes one that is turned the same way.
  void choose(std::uint32_t t, const std::array<std::uint32_t, 3>& places,
              const std::vector<Key>& keys) {
    const Key wanted = key_of(places, 0);
    TriangleMatch best;
    for (auto at = std::lower_bound(keys.begin(), keys.end(), wanted);
         at != keys.end() && at->places == wanted.places; ++at) {
      if (used_[at->triangle]) continue;
      const auto corners = corners_at(places, at->triangle);
      const bool alike = (corners[0] + 1) % 3 == corners[1];
      if (best.earlier == kNoIndex || alike) best = {at->triangle, corners};
      if (alike) break;
    }
    if (best.earlier == kNoIndex) return;
    matches_[t] = best;
    used_[best.earlier] = 1;
    found_.push_back(t);
  }

  std::array<std::uint8_t, 3> corners_at(const std::array<std::uint32_t, 3>& places,
                                         std::uint32_t earlier) const {
    std::array<std::uint8_t, 3> corners = {};
    std::array<bool, 3> taken = {};
    for (std::uint32_t k = 0; k < 3; ++k) {
      for (std::uint8_t i = 0; i < 3; ++i) {
        // Begins at corner k, so that corners at one place keep their order.
        const auto c = std::uint8_t((k + i) % 3);
        if (taken[c] || earlier_corner(earlier, c) != places[k]) continue;
        corners[k] = c;
        taken[c] = true;
        break;
      }
    }
    return corners;
  }

  void match_across() {
    for (std::size_t i = 0; i < found_.size(); ++i) {
      for (std::uint32_t k = 0; k < 3; ++k) cross(found_[i], k);
    }
  }

  // Matches the triangle across an edge with what lies across the same edge of the earlier mesh.
  void cross(std::uint32_t t, std::uint32_t k) {
    const std::uint32_t h = mesh_.across[3 * t + k];
    if (h == kNoIndex || matches_[h / 3].earlier != kNoIndex) return;
    const TriangleMatch& m = matches_[t];
    const std::uint32_t from = m.corners[k], to = m.corners[(k + 1) % 3];
    const std::uint32_t g = earlier_.across[3 * m.earlier + ((from + 1) % 3 == to ? from : to)];
    if (g == kNoIndex || used_[g / 3]) return;
    const std::uint32_t u = h / 3, w = g / 3, apex = previous_half_edge(h),
                        earlier_apex = previous_half_edge(g);
    const std::uint32_t place = mesh_.corners[apex], was = earlier_.corners[earlier_apex];
    if (place_of_[place] != was && (place_of_[place] != kNoIndex || owner_[was] != kNoIndex))
      return;
    place_of_[place] = was;
    owner_[was] = place;
    TriangleMatch& found = matches_[u];
    found.earlier = w;
    found.corners[apex % 3] = std::uint8_t(earlier_apex % 3);
    const bool same = mesh_.corners[h] == corner(t, k);
    const std::uint32_t earlier_from = earlier_corner(m.earlier, from);
    for (const std::uint32_t c : {h, next_half_edge(h)}) {
      const bool at_from = (c == h) == same;
      const bool g_is_from = earlier_.corners[g] == earlier_from;
      const std::uint32_t e = at_from == g_is_from ? g : next_half_edge(g);
      found.corners[c % 3] = std::uint8_t(e % 3);
    }
    used_[w] = 1;
    found_.push_back(u);
  }

  const JoinedMesh& mesh_;
  const JoinedMesh& earlier_;
  double squared_;                       // of the tolerance
  std::vector<std::uint32_t> place_of_;  // one per place: the earlier one
  std::vector<std::uint32_t> owner_;     // the inverse
  std::vector<std::uint8_t> used_;       // one per earlier triangle
  std::vector<TriangleMatch> matches_;
  std::vector<std::uint32_t> found_;  // triangles with a match, in the order found
};

}  // namespace

std::vector<TriangleMatch> match_triangles(const JoinedMesh& mesh, const JoinedMesh& earlier,
                                           double tolerance) {
  return Matcher(mesh, earlier, tolerance).run();
}

}  // namespace atlas
