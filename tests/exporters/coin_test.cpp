// Reads a written world with an independent VRML97 library: libcoin parses it, and every index is
// checked against the arrays that it refers to.
#include <gtest/gtest.h>

#include <Inventor/SoDB.h>
#include <Inventor/SoInput.h>
#include <Inventor/VRMLnodes/SoVRMLAppearance.h>
#include <Inventor/VRMLnodes/SoVRMLCoordinate.h>
#include <Inventor/VRMLnodes/SoVRMLGroup.h>
#include <Inventor/VRMLnodes/SoVRMLImageTexture.h>
#include <Inventor/VRMLnodes/SoVRMLIndexedFaceSet.h>
#include <Inventor/VRMLnodes/SoVRMLShape.h>
#include <Inventor/VRMLnodes/SoVRMLTextureCoordinate.h>
#include <Inventor/actions/SoSearchAction.h>
#include <Inventor/errors/SoError.h>

#include <cmath>

#include "libatlas/image/image_io.h"
#include "tests/exporters/worlds.h"
#include "tests/support/leaks.h"
#include "tests/support/temp_folder.h"

namespace atlas {
namespace {

using test::TempFolder;

std::vector<std::string> complaints;

void keep_complaint(const SoError* error, void*) {
  complaints.push_back(error->getDebugString().getString());
}

class Coin : public ::testing::Test {
 protected:
  static void SetUpTestSuite() {
    const test::IgnoreLeaks coin;
    SoDB::init();
    SoError::setHandlerCallback(keep_complaint, nullptr);
  }
  void SetUp() override { complaints.clear(); }

  SoVRMLGroup* read(const std::filesystem::path& path) {
    const test::IgnoreLeaks coin;
    SoInput input;
    if (!input.openFile(path.c_str())) return nullptr;
    SoVRMLGroup* root = SoDB::readAllVRML(&input);
    if (root) root->ref();
    return root;
  }
};

std::vector<SoVRMLShape*> shapes_in(SoNode* root) {
  SoSearchAction search;
  search.setType(SoVRMLShape::getClassTypeId());
  search.setInterest(SoSearchAction::ALL);
  search.apply(root);
  std::vector<SoVRMLShape*> shapes;
  for (int i = 0; i < search.getPaths().getLength(); ++i) {
    shapes.push_back(static_cast<SoVRMLShape*>(search.getPaths()[i]->getTail()));
  }
  return shapes;
}

void expect_triangles(const SoMFInt32& list, int limit, std::size_t triangles) {
  ASSERT_EQ(std::size_t(list.getNum()), 4 * triangles);
  for (int i = 0; i < list.getNum(); ++i) {
    if (i % 4 == 3) {
      ASSERT_EQ(list[i], -1);
    } else {
      ASSERT_TRUE(list[i] >= 0 && list[i] < limit);
    }
  }
}

void expect_page(SoVRMLShape* shape, const World& world, std::size_t number) {
  const Page& page = world.pages[number];
  auto* faces = dynamic_cast<SoVRMLIndexedFaceSet*>(shape->geometry.getValue());
  ASSERT_TRUE(faces);
  EXPECT_FALSE(faces->solid.getValue());
  auto* coord = dynamic_cast<SoVRMLCoordinate*>(faces->coord.getValue());
  auto* uvs = dynamic_cast<SoVRMLTextureCoordinate*>(faces->texCoord.getValue());
  ASSERT_TRUE(coord && uvs);
  expect_triangles(faces->coordIndex, coord->point.getNum(), page.indices.size() / 3);
  expect_triangles(faces->texCoordIndex, uvs->point.getNum(), page.indices.size() / 3);
  for (std::size_t k = 0; k < page.indices.size(); ++k) {
    const int at = int(k / 3 * 4 + k % 3);
    const SbVec3f& p = coord->point[faces->coordIndex[at]];
    const SbVec2f& t = uvs->point[faces->texCoordIndex[at]];
    const Vec3f& v = world.positions[page.indices[k]];
    // Coin's own number parser loses the last bits.
    const auto near = [](float a, float b) { return std::abs(a - b) <= 4e-7f * std::abs(b); };
    ASSERT_TRUE(near(p[0], v.x) && near(p[1], v.y) && near(p[2], v.z)) << k;
    const Vec2f& uv = world.uvs[page.uv_indices[k]];
    ASSERT_TRUE(near(t[0], uv.x) && near(t[1], uv.y)) << k;
  }
  auto* appearance = dynamic_cast<SoVRMLAppearance*>(shape->appearance.getValue());
  ASSERT_TRUE(appearance);
  EXPECT_EQ(appearance->material.getValue(), nullptr);
  auto* texture = dynamic_cast<SoVRMLImageTexture*>(appearance->texture.getValue());
  ASSERT_TRUE(texture);
  EXPECT_FALSE(texture->repeatS.getValue() || texture->repeatT.getValue());
  ASSERT_EQ(texture->url.getNum(), 1);
  EXPECT_EQ(std::filesystem::path(texture->url[0].getString()).filename(), page.image);
}

TEST_F(Coin, ReadsEveryPage) {
  const TempFolder folder;
  World world = test::wavy_world(60, 3);
  world.up = Up::z;
  for (const Page& page : world.pages) {
    ASSERT_TRUE(write_png(folder / page.image, Image8(4, 4, 3, 90), {}).ok());
  }
  for (const char* name : {"w.wrl", "w.wrz"}) {
    AtomicFiles files;
    ASSERT_TRUE(write_vrml(world, folder / name, files, {}).ok());
    ASSERT_TRUE(files.commit().ok());
    SoVRMLGroup* root = read(folder / name);
    ASSERT_TRUE(root) << name;
    EXPECT_TRUE(complaints.empty()) << complaints.front();
    const auto shapes = shapes_in(root);
    ASSERT_EQ(shapes.size(), world.pages.size());
    for (std::size_t i = 0; i < shapes.size(); ++i) expect_page(shapes[i], world, i);
    root->unref();
  }
}

// Shows that the check above can fail: Coin reports a damaged file.
TEST_F(Coin, NoticesDamage) {
  const TempFolder folder;
  AtomicFiles files;
  ASSERT_TRUE(write_vrml(test::wavy_world(5, 1), folder / "w.wrl", files, {}).ok());
  ASSERT_TRUE(files.commit().ok());
  std::string text = TempFolder::read(folder / "w.wrl");
  text.replace(text.find("coordIndex ["), 12, "coordIndex { ");
  SoVRMLGroup* root = read(folder.write("bad.wrl", text));
  EXPECT_TRUE(!root || !complaints.empty());
  if (root) root->unref();
}

}  // namespace
}  // namespace atlas
