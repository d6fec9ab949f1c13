#include <fmt/format.h>

#include <vector>

#include "libatlas/c/objects.h"
#include "libatlas/c/structs.h"

namespace atlas::c {
namespace {

StridedMesh strided_mesh(const libatlas_mesh& mesh) {
  const std::size_t faces = mesh.polygon_sizes ? mesh.polygon_count : mesh.index_count / 3;
  StridedMesh strided{.positions = {mesh.positions, mesh.position_count, mesh.position_stride},
                      .indices = {mesh.indices, mesh.index_count, mesh.index_bytes},
                      .texcoords = {mesh.texcoords, mesh.texcoord_count, mesh.texcoord_stride}};
  if (mesh.normals) strided.normals = {mesh.normals, mesh.position_count, mesh.normal_stride};
  if (mesh.texcoord_indices)
    strided.texcoord_indices = {mesh.texcoord_indices, mesh.index_count, mesh.index_bytes};
  if (mesh.materials) strided.materials = {mesh.materials, faces};
  if (mesh.seams) strided.seams = {mesh.seams, mesh.index_count};
  if (mesh.triangle_density) strided.density = {mesh.triangle_density, faces};
  if (mesh.seam_weights) strided.seam_weights = {mesh.seam_weights, mesh.position_count};
  if (mesh.polygon_sizes) strided.polygon_sizes = {mesh.polygon_sizes, mesh.polygon_count};
  return strided;
}

Status check_polygons(const libatlas_mesh& mesh) {
  if ((mesh.polygon_sizes != nullptr) == (mesh.polygon_count > 0)) return {};
  return {ErrorCode::bad_input,
          fmt::format("libatlas_mesh: polygon_count is {}, but polygon_sizes is {}",
                      mesh.polygon_count, mesh.polygon_sizes ? "given" : "null")};
}

// Checks the arguments, calls add(mesh), and hands out the number of the mesh.
template <class Add>
libatlas_status add_to(libatlas_context* context, libatlas_atlas* atlas, const libatlas_mesh* mesh,
                       std::uint32_t* number, const Add& add) {
  if (number) *number = 0;
  return run_call(context, [&]() -> Status {
    if (!atlas) return null("atlas");
    libatlas_mesh own;
    if (Status s = take_struct(mesh, "libatlas_mesh", own); !s.ok()) return s;
    if (Status s = check_polygons(own); !s.ok()) return s;
    const Result<std::uint32_t> added = add(own);
    if (added.ok() && number) *number = *added;
    return added.status();
  });
}

}  // namespace
}  // namespace atlas::c

libatlas_status libatlas_mesh_init(libatlas_mesh* mesh, size_t size) {
  libatlas_mesh defaults{};
  defaults.index_bytes = 4;
  defaults.density = 1;
  return atlas::c::set_defaults(mesh, size, defaults);
}

libatlas_status libatlas_atlas_create(libatlas_context* context, libatlas_atlas** atlas) {
  using Made = atlas::Result<std::unique_ptr<libatlas_atlas>>;
  return atlas::c::run_making_call(context, atlas,
                                   [] { return Made(std::make_unique<libatlas_atlas>()); });
}

void libatlas_atlas_destroy(libatlas_atlas* atlas) {
  delete atlas;
}

libatlas_status libatlas_add_instances(libatlas_context* context, libatlas_atlas* atlas,
                                       const libatlas_mesh* mesh, const float* densities,
                                       size_t count, uint32_t* number) {
  return atlas::c::add_to(context, atlas, mesh, number, [&](const libatlas_mesh& own) {
    std::vector<float> products;
    for (std::size_t i = 0; densities && i < count; ++i)
      products.push_back(densities[i] * own.density);
    if (!densities && own.density != 1 && count > 0) products.assign(count, own.density);
    return atlas->atlas.add_instances(atlas::c::strided_mesh(own), count, products);
  });
}

libatlas_status libatlas_add_mesh(libatlas_context* context, libatlas_atlas* atlas,
                                  const libatlas_mesh* mesh, uint32_t* number) {
  return atlas::c::add_to(context, atlas, mesh, number, [&](const libatlas_mesh& own) {
    return atlas->atlas.add(atlas::c::strided_mesh(own), own.density);
  });
}
