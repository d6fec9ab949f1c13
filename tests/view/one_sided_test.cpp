// Worlds with thin sheets, from file to picture: the back faces of one-sided triangles are not
// seen.
#include <gtest/gtest.h>

#include <array>
#include <filesystem>

#include "libatlas/exporters/world.h"
#include "libatlas/image/image_io.h"
#include "libatlas/view/play.h"
#include "tests/support/temp_folder.h"
#include "tests/view/shapes.h"

namespace atlas::testing {
namespace {

namespace fs = std::filesystem;

// A square whose two layers show the left third of the page (red) in front, towards +z, and the
// right third (blue) behind. Beside it, at x from 2 to 3, is a green square of a single layer.
World sheet_world(const fs::path& folder) {
  World world;
  world.positions = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0},
                     {2, 0, 0}, {3, 0, 0}, {3, 1, 0}, {2, 1, 0}};
  world.uvs = {{1 / 6.f, 0.5f}, {5 / 6.f, 0.5f}, {0.5f, 0.5f}};
  Page page;
  page.image = "page.png";
  page.image_source = folder / "page.png";
  const auto add = [&](std::array<std::uint32_t, 6> corners, std::uint32_t uv, bool one_sided) {
    page.indices.insert(page.indices.end(), corners.begin(), corners.end());
    page.uv_indices.insert(page.uv_indices.end(), 6, uv);
    page.one_sided.insert(page.one_sided.end(), 2, one_sided);
  };
  add({0, 1, 2, 0, 2, 3}, 0, true);
  add({4, 5, 6, 4, 6, 7}, 2, false);
  add({3, 1, 0, 3, 2, 1}, 1, true);  // by the other diagonal
  world.pages.push_back(page);
  Image8 image(48, 16, 3, 0);
  for (int y = 0; y < 16; ++y) {
    for (int x = 0; x < 48; ++x) image.at(x, y)[x < 16 ? 0 : x < 32 ? 1 : 2] = 255;
  }
  EXPECT_TRUE(write_png(folder / "page.png", image, {}).ok());
  return world;
}

using Colour = std::array<int, 3>;

// Returns the colour in the middle of a picture.
Colour seen(const ViewScene& view, const Camera& camera, const RenderOptions& options) {
  test_context();
  Result<Renderer> renderer = Renderer::make(view, options);
  EXPECT_TRUE(renderer.ok()) << renderer.status().message();
  EXPECT_TRUE(renderer->draw(camera, still({0, 1, 0})).ok());
  const Image8 image = renderer->read_image();
  const std::uint8_t* p = image.at(image.width / 2, image.height / 2);
  return {p[0], p[1], p[2]};
}

TEST(OneSided, EachSideOfASheetShowsItsOwnLayer) {
  const test::TempFolder folder;
  const World world = sheet_world(folder.path());
  RenderOptions options;
  options.width = options.height = 32;
  options.map_resolution = 64;
  for (const char* name : {"w.wrl", "w.wrz", "w.gltf", "w.glb"}) {
    AtomicFiles files;
    const Result<WorldFile> written = write_world(world, folder / name, files, {});
    ASSERT_TRUE(written.ok()) << written.status().message();
    ASSERT_TRUE(files.commit().ok());
    const Result<ViewScene> view = load_view(folder / name, {}, {});
    ASSERT_TRUE(view.ok()) << view.status().message();
    ASSERT_EQ(view->unlit, Unlit::all) << name;
    for (const Shading shading : {Shading::unlit, Shading::lambert}) {
      options.shading = shading;
      options.intensity = 0;  // the pages' own light alone
      const Camera front{.eye = {0.4, 0.3, 2}, .target = {0.4, 0.3, 0}};
      const Camera back{.eye = {0.4, 0.3, -2}, .target = {0.4, 0.3, 0}};
      EXPECT_EQ(seen(*view, front, options), (Colour{255, 0, 0})) << name;
      EXPECT_EQ(seen(*view, back, options), (Colour{0, 0, 255})) << name;
      for (const double z : {-2.0, 2.0})
        EXPECT_EQ(seen(*view, {.eye = {2.4, 0.3, z}, .target = {2.4, 0.3, 0}}, options),
                  (Colour{0, 255, 0}))
            << name << ' ' << z;
    }
    EXPECT_EQ(view->caster_indices.size(), 18u);
  }
}

}  // namespace
}  // namespace atlas::testing
