// Where memory runs out, calls return a status, the atlas is as it was, and the next call works.
#include <gtest/gtest.h>

#include <cstdint>

#include "libatlas/c/atlas.h"
#include "tests/c/failing_memory.h"
#include "tests/support/shapes.h"

namespace atlas::test {
namespace {

// Runs a call with the first, the second, ... and later allocations failing, until none fails.
template <class Call>
int runs_until_none_fails(libatlas_context* context, const Call& call) {
  int failed = 0;
  for (long n = 1; n < 10'000'000; n += 1 + n / 8) {
    let_allocation_fail(n);
    const libatlas_status status = call();
    const bool one_failed = allocation_failed();
    if (status == LIBATLAS_OK) {
      if (!one_failed) return failed;
      continue;  // what failed could be done without
    }
    EXPECT_EQ(status, LIBATLAS_OUT_OF_MEMORY) << n;
    EXPECT_STREQ(libatlas_message(context), "out of memory");
    ++failed;
  }
  return -1;
}

TEST(Memory, WhereItRunsOutCallsReturnAStatus) {
  libatlas_context* const context = libatlas_context_create();
  libatlas_set_threads(context, 1);
  libatlas_atlas* atlas = nullptr;
  ASSERT_EQ(libatlas_atlas_create(context, &atlas), LIBATLAS_OK);
  const Shape shape = box(2);
  libatlas_mesh mesh;
  libatlas_mesh_init(&mesh, sizeof mesh);
  mesh.positions = shape.positions.data();
  mesh.position_count = shape.positions.size();
  mesh.indices = shape.indices.data();
  mesh.index_count = shape.indices.size();
  mesh.density = 2;
  std::uint32_t number = 9;
  EXPECT_GT(runs_until_none_fails(
                context, [&] { return libatlas_add_mesh(context, atlas, &mesh, &number); }),
            5);
  EXPECT_EQ(number, 0u);  // no mesh that failed was left
  libatlas_unwrapped* unwrapped = nullptr;
  const auto unwrap = [&] {
    libatlas_unwrapped_destroy(unwrapped);
    return libatlas_unwrap(context, atlas, nullptr, &unwrapped);
  };
  EXPECT_GT(runs_until_none_fails(context, unwrap), 40);
  libatlas_mesh_uvs uvs = {};
  uvs.size = sizeof uvs;
  EXPECT_EQ(libatlas_get_mesh(context, unwrapped, 0, &uvs), LIBATLAS_OK);
  EXPECT_EQ(uvs.triangle_count, shape.triangle_count());
  libatlas_atlas_info info = {};
  info.size = sizeof info;
  EXPECT_EQ(libatlas_get_info(context, unwrapped, &info), LIBATLAS_OK);
  EXPECT_NEAR(info.surface_area, 6, 1e-6);  // nothing is left of meshes that were refused
  libatlas_unwrapped_destroy(unwrapped);
  libatlas_atlas_destroy(atlas);
  libatlas_context_destroy(context);
}

}  // namespace
}  // namespace atlas::test
