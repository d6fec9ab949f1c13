// What the layers of sheets look like in written files is tested in tests/pipeline.
#include "libatlas/sheets/one_sided.h"

#include <gtest/gtest.h>

#include <vector>

#include "tests/support/two_layers.h"

namespace atlas::test {
namespace {

// The layers are the same on any number of threads, and in any unit of length.
TEST(OneSided, ThreadsAndUnitsDoNotMatter) {
  const Height flat = [](double, double) { return 0.0; };
  for (const float unit : {1e-6f, 1.0f, 1e6f}) {
    LoadedScene loaded = sheet({}, {.cells = 7, .from_above = false, .light = 1}, flat);
    for (Vec3f& p : loaded.scene.positions) p = {p.x * unit, p.y * unit, p.z * unit};
    MeshView mesh;
    mesh.positions = loaded.scene.positions;
    mesh.indices = loaded.scene.indices;
    const auto charts = make_charts(mesh, {}, {});
    ASSERT_TRUE(charts.ok());
    const ChartedMesh fine(loaded.scene.indices, *charts);
    for (const int threads : {1, 2, 5}) {
      Context context;
      context.threads = threads;
      EXPECT_EQ(one_sided_triangles(loaded.scene, *charts, fine.view(), context),
                std::vector<bool>(loaded.scene.triangle_count(), true))
          << unit;
    }
  }
}

}  // namespace
}  // namespace atlas::test
