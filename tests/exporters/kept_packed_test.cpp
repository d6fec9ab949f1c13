// Tests a World::scene that was read from glTF with compressed data.
#include <gtest/gtest.h>

#include <cstdint>
#include <string>
#include <vector>

#include "tests/exporters/kept_gltf.h"
#include "tests/support/draco_gltf.h"
#include "tests/support/gltf_maker.h"
#include "tests/support/gltf_oracle.h"
#include "tests/support/packed_gltf.h"
#include "tests/support/temp_folder.h"

namespace atlas::test {
namespace {

// The file that is written holds plain data, and so does not need the extension.
TEST(KeptPacked, CompressedDataIsWrittenPlain) {
  const TempFolder folder;
  const Grid grid;
  PackedGltf gltf = packed_grid();
  gltf.j["animations"] = json::array(
      {{{"samplers",
         {{{"input", gltf.floats({0, 1}, "SCALAR", 1)},
           {"output", gltf.packed_positions({0, 0, 0, 5, 6, 7}, 0)}}}},
        {"channels", {{{"sampler", 0}, {"target", {{"node", 0}, {"path", "translation"}}}}}}}});
  const WorldFile written = keep(folder.write("packed.glb", gltf.glb()), folder / "kept.glb");
  EXPECT_EQ(written.not_kept, std::vector<std::string>{});
  const GltfOracle after(folder / "kept.glb");
  EXPECT_EQ(after.document.dump().find(kMeshopt), std::string::npos);
  const std::vector<OracleTriangle> triangles = after.triangles();
  ASSERT_EQ(3 * triangles.size(), grid.indices.size());
  // The codec may begin a triangle at another corner, so the sums of its corners are compared.
  for (std::size_t t = 0; t < triangles.size(); ++t) {
    const std::vector<double>& p = triangles[t].attributes.at("POSITION");
    for (std::size_t axis = 0; axis < 3; ++axis) {
      double wanted = 0;
      for (std::size_t c = 0; c < 3; ++c)
        wanted += double(grid.positions[3 * grid.indices[3 * t + c] + axis]);
      EXPECT_NEAR(p[axis] + p[3 + axis] + p[6 + axis], wanted, 1e-9) << t;
    }
  }
  const json& sampler = after.document["animations"][0]["samplers"][0];
  EXPECT_EQ(after.values(sampler["output"]), (std::vector<double>{0, 0, 0, 5, 6, 7}));
}

// So it is for a mesh that Draco has compressed, also one that is not shown and so copied as it is.
TEST(KeptPacked, DracoIsWrittenPlain) {
  const TempFolder folder;
  const std::vector<std::uint8_t> bytes{1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12};
  DracoSource source;
  source.indices = {0, 1, 2, 0, 2, 3};
  source.points = 4;
  source.attributes = {{draco::GeometryAttribute::POSITION, 3, draco::DT_FLOAT32, kSquare.data()},
                       {draco::GeometryAttribute::COLOR, 3, draco::DT_UINT8, bytes.data()}};
  DracoGltf gltf;
  const auto add = [&] {
    const int positions = gltf.promised(4, "VEC3"), heat = gltf.promised(4, "VEC3", 5121);
    return gltf.primitive(source, {{"POSITION", positions}, {"_HEAT", heat}});
  };
  gltf.single(add());
  gltf.j["meshes"].push_back({{"primitives", json::array({add()})}});
  gltf.j["nodes"].push_back({{"mesh", 1}});
  const WorldFile written = keep(folder.write("packed.glb", gltf.glb()), folder / "kept.glb");
  EXPECT_EQ(written.not_kept, std::vector<std::string>{});
  EXPECT_EQ(written.meshes_without_uvs, 1u);
  const GltfOracle after(folder / "kept.glb");
  EXPECT_EQ(after.document.dump().find(kDraco), std::string::npos);
  const std::vector<OracleTriangle> triangles = after.triangles();
  ASSERT_EQ(triangles.size(), 2u);
  EXPECT_EQ(triangles[1].attributes.at("POSITION"),
            (std::vector<double>{0, 0, 0, 1, 1, 0, 0, 1, 0}));
  EXPECT_EQ(triangles[1].attributes.at("_HEAT"),
            (std::vector<double>{1, 2, 3, 7, 8, 9, 10, 11, 12}));
  const json& hidden = after.document["meshes"][1]["primitives"][0];
  EXPECT_EQ(after.values(hidden["indices"]), (std::vector<double>{0, 1, 2, 0, 2, 3}));
  EXPECT_EQ(after.values(hidden["attributes"]["POSITION"]),
            std::vector<double>(kSquare.begin(), kSquare.end()));
  EXPECT_EQ(after.values(hidden["attributes"]["_HEAT"]),
            std::vector<double>(bytes.begin(), bytes.end()));
}

}  // namespace
}  // namespace atlas::test
