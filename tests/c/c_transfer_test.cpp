// Values at vertices into textures, by the C interface.
#include <gtest/gtest.h>

#include <memory>
#include <string>
#include <vector>

#include "libatlas/c/atlas.h"
#include "libatlas/unwrap/transfer.h"
#include "tests/c/c_fixture.h"
#include "tests/support/shape_view.h"

namespace atlas::test {
namespace {

class CTransfer : public testing::Test {
 protected:
  void SetUp() override {
    ASSERT_EQ(libatlas_atlas_create(context_, &atlas_), LIBATLAS_OK);
    for (const Shape& shape : shapes_) {
      const libatlas_mesh mesh = mesh_of(shape);
      ASSERT_EQ(libatlas_add_mesh(context_, atlas_, &mesh, nullptr), LIBATLAS_OK);
    }
    libatlas_unwrap_options options;
    libatlas_unwrap_options_init(&options, sizeof options);
    options.page_size = 128;
    ASSERT_EQ(libatlas_unwrap(context_, atlas_, &options, &unwrapped_), LIBATLAS_OK);
  }
  void TearDown() override {
    libatlas_unwrapped_destroy(unwrapped_);
    libatlas_atlas_destroy(atlas_);
    libatlas_context_destroy(context_);
  }

  UnwrappedAtlas by_library() const {
    Atlas atlas;
    for (const Shape& shape : shapes_) EXPECT_TRUE(atlas.add(view_of(shape)).ok());
    return *atlas.unwrap({{.page_size = 128}}, {});
  }
  libatlas_status run(const float* values, std::size_t count, float* texels, std::size_t room,
                      const libatlas_transfer_options* options = nullptr) {
    return libatlas_transfer(context_, unwrapped_, values, count, options, texels, room);
  }
  std::string message() const { return libatlas_message(context_); }

  const std::vector<Shape> shapes_{torus(20, 10), box(3)};
  libatlas_context* context_ = libatlas_context_create();
  libatlas_atlas* atlas_ = nullptr;
  libatlas_unwrapped* unwrapped_ = nullptr;
};

TEST_F(CTransfer, GivesWhatTheLibraryGivesToTheBit) {
  const UnwrappedAtlas atlas = by_library();
  std::vector<Vec3f> values;
  for (const std::uint32_t v : atlas.all().vertices)
    values.push_back({float(v % 7), float(v % 5), float(v % 3)});
  const auto expected = transfer(atlas, values, {}, {});
  ASSERT_TRUE(expected.ok()) << expected.status().message();
  std::vector<float> texels(expected->texels.size(), -1);
  ASSERT_EQ(run(&values[0].x, values.size(), texels.data(), texels.size() / 3), LIBATLAS_OK);
  EXPECT_EQ(texels, expected->texels);
}

TEST_F(CTransfer, RefusesWhatDoesNotFit) {
  const UnwrappedAtlas atlas = by_library();
  const std::size_t count = atlas.all().vertices.size();
  const Extent page = atlas.all().pages[0];
  const std::size_t room = std::size_t(page.width) * std::size_t(page.height);
  std::vector<float> values(3 * count), texels(3 * room);
  EXPECT_EQ(run(nullptr, count, texels.data(), room), LIBATLAS_BAD_INPUT);
  EXPECT_EQ(message(), "values is null");
  EXPECT_EQ(run(values.data(), count, nullptr, room), LIBATLAS_BAD_INPUT);
  EXPECT_EQ(run(values.data(), count - 1, texels.data(), room), LIBATLAS_BAD_INPUT);
  EXPECT_NE(message().find("vertices in all"), std::string::npos) << message();
  EXPECT_EQ(run(values.data(), count, texels.data(), room - 1), LIBATLAS_BAD_INPUT);
  EXPECT_NE(message().find("room for"), std::string::npos) << message();
  libatlas_transfer_options options;
  ASSERT_EQ(libatlas_transfer_options_init(&options, sizeof options), LIBATLAS_OK);
  EXPECT_EQ(options.shifts, 4);
  options.page = 1;
  EXPECT_EQ(run(values.data(), count, texels.data(), room, &options), LIBATLAS_BAD_OPTION);
  EXPECT_EQ(message(), "transfer: page is 1; there are 1 (counted from 0)");
  options.page = 0, options.size = 3;
  EXPECT_EQ(run(values.data(), count, texels.data(), room, &options), LIBATLAS_BAD_OPTION);
  EXPECT_EQ(libatlas_transfer_options_init(nullptr, sizeof options), LIBATLAS_BAD_INPUT);
}

}  // namespace
}  // namespace atlas::test
