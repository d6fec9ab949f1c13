#include "tests/param/oracles.h"

#if __has_include(<CGAL/Surface_mesh_parameterization/ARAP_parameterizer_3.h>)
#include <CGAL/Polygon_mesh_processing/measure.h>
#include <CGAL/Simple_cartesian.h>
#include <CGAL/Surface_mesh.h>
#include <CGAL/Surface_mesh_parameterization/ARAP_parameterizer_3.h>
#include <CGAL/Surface_mesh_parameterization/parameterize.h>

namespace atlas::testing {

bool cgal_parameterizers_built() {
  return true;
}

std::vector<Vec2d> cgal_arap(const LocalMesh& mesh, unsigned iterations) {
  namespace Smp = CGAL::Surface_mesh_parameterization;
  using Kernel = CGAL::Simple_cartesian<double>;
  using Mesh = CGAL::Surface_mesh<Kernel::Point_3>;
  Mesh m;
  for (std::size_t v = 0; v < mesh.positions.size(); ++v) {
    const Vec3d p = mesh.positions[v];
    m.add_vertex({p.x, p.y, p.z});
  }
  for (const auto& t : mesh.triangles) {
    m.add_face(Mesh::Vertex_index(t[0]), Mesh::Vertex_index(t[1]), Mesh::Vertex_index(t[2]));
  }
  auto uv = m.add_property_map<Mesh::Vertex_index, Kernel::Point_2>("v:uv").first;
  const auto border = CGAL::Polygon_mesh_processing::longest_border(m).first;
  using Parameterizer = Smp::ARAP_parameterizer_3<Mesh>;
  Parameterizer parameterizer(Parameterizer::Border_parameterizer(), Parameterizer::Solver_traits(),
                              0.0, iterations, 1e-12);
  if (Smp::parameterize(m, parameterizer, border, uv) != Smp::OK) return {};
  std::vector<Vec2d> out;
  for (const auto v : m.vertices()) out.push_back({uv[v].x(), uv[v].y()});
  return out;
}

}  // namespace atlas::testing
#else
namespace atlas::testing {
bool cgal_parameterizers_built() {
  return false;
}
std::vector<Vec2d> cgal_arap(const LocalMesh&, unsigned) {
  return {};
}
}  // namespace atlas::testing
#endif
