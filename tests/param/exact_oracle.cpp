#include <CGAL/Exact_predicates_exact_constructions_kernel.h>
#include <CGAL/Polygon_2.h>
#include <CGAL/intersections.h>

#include <boost/variant/get.hpp>
#include <variant>
#include <vector>

#include "tests/param/oracles.h"

namespace atlas::testing {
namespace {

using Kernel = CGAL::Exact_predicates_exact_constructions_kernel;
using Triangle = Kernel::Triangle_2;

// Returns the T that a variant holds, or null. CGAL 5 returns boost's variant, CGAL 6 the
// standard's.
template <class T, class Variant>
const T* held(const Variant& variant) {
  if constexpr (requires { std::get_if<T>(&variant); }) {
    return std::get_if<T>(&variant);
  } else {
    return boost::get<T>(&variant);
  }
}

bool share_area(const Triangle& a, const Triangle& b) {
  if (!CGAL::do_overlap(a.bbox(), b.bbox())) return false;
  const auto common = CGAL::intersection(a, b);
  if (!common) return false;
  return held<Triangle>(*common) || held<std::vector<Kernel::Point_2>>(*common);
}

}  // namespace

bool injective_by_pairs(const LocalMesh& mesh, std::span<const Vec2d> uvs) {
  std::vector<Triangle> triangles;
  for (const auto& t : mesh.triangles) {
    const auto point = [&](std::uint32_t v) { return Kernel::Point_2(uvs[v].x, uvs[v].y); };
    triangles.emplace_back(point(t[0]), point(t[1]), point(t[2]));
    if (triangles.back().orientation() != CGAL::COUNTERCLOCKWISE) return false;
  }
  for (std::size_t i = 0; i < triangles.size(); ++i) {
    for (std::size_t j = i + 1; j < triangles.size(); ++j) {
      if (share_area(triangles[i], triangles[j])) return false;
    }
  }
  return true;
}

}  // namespace atlas::testing
