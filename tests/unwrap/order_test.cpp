// unwrap_mesh() gives the same uvs whatever the order of the triangles, of their corners and of the
// vertices is.
#include <gtest/gtest.h>

#include "libatlas/unwrap/unwrap.h"
#include "tests/support/reordered.h"

namespace atlas::test {
namespace {

UnwrappedMesh unwrapped(const Shape& shape, const UnwrapOptions& options) {
  MeshView view;
  view.positions = shape.positions;
  view.indices = shape.indices;
  auto mesh = unwrap_mesh(view, options, {});
  EXPECT_TRUE(mesh.ok()) << shape.name << ": " << mesh.status().message();
  return mesh.ok() ? std::move(*mesh) : UnwrappedMesh{};
}

void expect_same_uvs(const Shape& shape, const UnwrapOptions& options) {
  const UnwrappedMesh reference = unwrapped(shape, options);
  for (std::uint64_t seed = 1; seed <= 2; ++seed) {
    const Reordered other = reordered(shape, seed);
    const UnwrappedMesh mesh = unwrapped(other.shape, options);
    ASSERT_EQ(mesh.pages, reference.pages) << shape.name;
    ASSERT_EQ(mesh.indices.size(), reference.indices.size()) << shape.name;
    for (std::size_t i = 0; i < other.corner.size(); ++i)
      ASSERT_EQ(mesh.uvs[mesh.indices[i]], reference.uvs[reference.indices[other.corner[i]]])
          << shape.name << ", corner " << i;
  }
}

TEST(UnwrapOrder, ChangesNoBitOfUvs) {
  for (const Shape& shape : zoo()) expect_same_uvs(shape, {});
}

// Strips that are longer than a page are cut for it, after charts were made.
TEST(UnwrapOrder, ChangesNoBitWhereChartsAreCutForTheirPages) {
  UnwrapOptions options;
  options.square = true;
  options.page_size = 256;
  expect_same_uvs(grid(400, 4, 100, 1), options);
  options.pages = 3;
  expect_same_uvs(together(grid(300, 6, 60, 1), torus(36, 18)), options);
}

// Slivers are pushed open in floats.
TEST(UnwrapOrder, ChangesNoBitOfSlivers) {
  expect_same_uvs(needles(200, 1e7), {});
  UnwrapOptions options;
  options.part_gaps = true;
  expect_same_uvs(torus(36, 18), options);
}

}  // namespace
}  // namespace atlas::test
