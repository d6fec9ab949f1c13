#include "libatlas/param/cgal_backend.h"

#ifdef LIBATLAS_CGAL_PARAMETERIZATION

#include <CGAL/Polygon_mesh_processing/measure.h>
#include <CGAL/Simple_cartesian.h>
#include <CGAL/Surface_mesh.h>
#include <CGAL/Surface_mesh_parameterization/ARAP_parameterizer_3.h>
#include <CGAL/Surface_mesh_parameterization/LSCM_parameterizer_3.h>
#include <CGAL/Surface_mesh_parameterization/parameterize.h>

#include "libatlas/param/distortion.h"

namespace atlas {
namespace {

namespace Smp = CGAL::Surface_mesh_parameterization;
using Kernel = CGAL::Simple_cartesian<double>;
using Mesh = CGAL::Surface_mesh<Kernel::Point_3>;

template <class Parameterizer>
Status run(Mesh& mesh, Parameterizer parameterizer, std::span<Vec2d> uvs) {
  const auto border = CGAL::Polygon_mesh_processing::longest_border(mesh).first;
  auto uv = mesh.add_property_map<Mesh::Vertex_index, Kernel::Point_2>("v:uv").first;
  const Smp::Error_code code = Smp::parameterize(mesh, parameterizer, border, uv);
  if (code != Smp::OK) {
    return {ErrorCode::no_solution, std::string("CGAL cannot flatten this chart: ") +
                                        Smp::get_error_message(code) +
                                        " (use the library's own method)"};
  }
  for (const auto v : mesh.vertices()) uvs[v] = {uv[v].x(), uv[v].y()};
  return {};
}

}  // namespace

bool cgal_backend_built() {
  return true;
}

Status cgal_parameterize(const LocalMesh& mesh, CgalMethod method, std::span<Vec2d> uvs) {
  Mesh m;
  for (std::size_t v = 0; v < mesh.positions.size(); ++v) {
    const Vec3d p = mesh.positions[v];
    m.add_vertex({p.x, p.y, p.z});
  }
  for (const auto& t : mesh.triangles) {
    m.add_face(Mesh::Vertex_index(t[0]), Mesh::Vertex_index(t[1]), Mesh::Vertex_index(t[2]));
  }
  Status status;
  if (method == CgalMethod::lscm) {
    status = run(m, Smp::LSCM_parameterizer_3<Mesh>(), uvs);
  } else {
    using Arap = Smp::ARAP_parameterizer_3<Mesh>;
    constexpr unsigned iterations = 50;
    constexpr double lambda = 0, tolerance = 1e-9;
    status = run(
        m, Arap(Arap::Border_parameterizer(), Arap::Solver_traits(), lambda, iterations, tolerance),
        uvs);
  }
  if (!status.ok()) return status;
  const double scale = area_preserving_scale(measure_distortion(mesh, uvs));
  if (!(scale > 0)) return {ErrorCode::no_solution, "CGAL flattened this chart to nothing"};
  for (Vec2d& p : uvs) p = {p.x * scale, p.y * scale};
  return {};
}

}  // namespace atlas

#else

namespace atlas {

bool cgal_backend_built() {
  return false;
}

Status cgal_parameterize(const LocalMesh&, CgalMethod, std::span<Vec2d>) {
  return {ErrorCode::unsupported,
          "CGAL's parameterisation is not part of this build (configure with "
          "-DLIBATLAS_CGAL_PARAMETERIZATION=ON; the result is then under the GPL)"};
}

}  // namespace atlas

#endif
