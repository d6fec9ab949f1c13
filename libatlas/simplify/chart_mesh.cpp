#include "libatlas/simplify/chart_mesh.h"

#include <OpenMesh/Core/Mesh/TriMesh_ArrayKernelT.hh>

namespace atlas::simplify {
namespace {

struct Traits : OpenMesh::DefaultTraits {
  VertexAttributes(OpenMesh::Attributes::Status);
  EdgeAttributes(OpenMesh::Attributes::Status);
  FaceAttributes(OpenMesh::Attributes::Status);
};

using Mesh = OpenMesh::TriMesh_ArrayKernelT<Traits>;
using Vertex = OpenMesh::VertexHandle;
using Half = OpenMesh::HalfedgeHandle;
using Face = OpenMesh::FaceHandle;

Vertex vertex(std::uint32_t v) {
  return Vertex(static_cast<int>(v));
}
Face face(std::uint32_t f) {
  return Face(static_cast<int>(f));
}
std::uint32_t id(OpenMesh::BaseHandle handle) {
  return static_cast<std::uint32_t>(handle.idx());
}

}  // namespace

struct ChartMesh::Impl {
  Mesh mesh;
};

// The half-edges are linked directly, because the neighbours are known already. This is several
// times faster than add_face, and cannot fail on an unlucky order of the faces.
ChartMesh::ChartMesh(const FineChart& fine) : impl_(std::make_unique<Impl>()) {
  Mesh& mesh = impl_->mesh;
  const std::uint32_t halves = static_cast<std::uint32_t>(fine.corners.size());
  std::uint32_t edges = 0;
  for (std::uint32_t h = 0; h < halves; ++h)
    edges += fine.opposite[h] == kNoIndex || h < fine.opposite[h];
  mesh.resize(fine.vertex_count(), edges, fine.triangle_count());
  std::vector<Half> link(halves);
  int edge = 0;
  for (std::uint32_t h = 0; h < halves; ++h) {
    const std::uint32_t twin = fine.opposite[h];
    if (twin != kNoIndex && twin < h) continue;
    link[h] = Half(2 * edge);
    if (twin != kNoIndex) link[twin] = Half(2 * edge + 1);
    mesh.set_vertex_handle(Half(2 * edge), vertex(fine.to(h)));
    mesh.set_vertex_handle(Half(2 * edge + 1), vertex(fine.from(h)));
    ++edge;
  }
  for (std::uint32_t h = 0; h < halves; ++h) {
    mesh.set_next_halfedge_handle(link[h], link[next_half_edge(h)]);
    mesh.set_face_handle(link[h], face(h / 3));
    if (h % 3 == 0) mesh.set_halfedge_handle(face(h / 3), link[h]);
  }
  for (std::uint32_t v = 0; v < fine.vertex_count(); ++v) {
    const Half along = link[fine.vertex_half[v]];
    if (!fine.border(v)) {
      mesh.set_halfedge_handle(vertex(v), along);
      continue;
    }
    const Half leaving = mesh.opposite_halfedge_handle(link[fine.border_into(v)]);
    mesh.set_boundary(leaving);
    mesh.set_next_halfedge_handle(mesh.opposite_halfedge_handle(along), leaving);
    mesh.set_halfedge_handle(vertex(v), leaving);
  }
}

ChartMesh::~ChartMesh() = default;
ChartMesh::ChartMesh(ChartMesh&&) noexcept = default;

void ChartMesh::ring(std::uint32_t v, Ring& out) const {
  const Mesh& mesh = impl_->mesh;
  out.vertices.clear();
  out.faces.clear();
  const Half first = mesh.halfedge_handle(vertex(v));
  out.border = mesh.is_boundary(first);
  Half h = out.border ? mesh.opposite_halfedge_handle(mesh.prev_halfedge_handle(first)) : first;
  do {
    out.vertices.push_back(id(mesh.to_vertex_handle(h)));
    if (mesh.is_boundary(h)) break;
    out.faces.push_back(id(mesh.face_handle(h)));
    h = mesh.opposite_halfedge_handle(mesh.prev_halfedge_handle(h));
  } while (h != first || out.border);
}

std::size_t ChartMesh::valence(std::uint32_t v, std::size_t limit) const {
  const Mesh& mesh = impl_->mesh;
  const Half first = mesh.halfedge_handle(vertex(v));
  Half h = first;
  std::size_t count = 0;
  do {
    ++count;
    h = mesh.opposite_halfedge_handle(mesh.prev_halfedge_handle(h));
  } while (h != first && count < limit);
  return count;
}

bool ChartMesh::can_collapse(std::uint32_t v, std::uint32_t w) {
  const Half h = impl_->mesh.find_halfedge(vertex(v), vertex(w));
  return h.is_valid() && impl_->mesh.is_collapse_ok(h);
}

void ChartMesh::collapse(std::uint32_t v, std::uint32_t w) {
  impl_->mesh.collapse(impl_->mesh.find_halfedge(vertex(v), vertex(w)));
}

bool ChartMesh::vertex_alive(std::uint32_t v) const {
  return !impl_->mesh.status(vertex(v)).deleted();
}
bool ChartMesh::face_alive(std::uint32_t f) const {
  return !impl_->mesh.status(face(f)).deleted();
}

std::array<std::uint32_t, 3> ChartMesh::corners(std::uint32_t f) const {
  const Mesh& mesh = impl_->mesh;
  const Half h = mesh.halfedge_handle(face(f));
  return {id(mesh.from_vertex_handle(h)), id(mesh.to_vertex_handle(h)),
          id(mesh.to_vertex_handle(mesh.next_halfedge_handle(h)))};
}

}  // namespace atlas::simplify
