// Textures show the values at vertices, and charts do not mix.
#include "libatlas/unwrap/transfer.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <limits>
#include <vector>

#include "tests/support/shape_view.h"

namespace atlas::test {
namespace {

UnwrappedAtlas unwrapped_of(const std::vector<Shape>& shapes, const UnwrapOptions& options) {
  Atlas atlas;
  for (const Shape& shape : shapes) EXPECT_TRUE(atlas.add(view_of(shape)).ok());
  auto result = atlas.unwrap(options, {});
  EXPECT_TRUE(result.ok()) << result.status().message();
  return std::move(*result);
}

// The value of each vertex of the result, from its position.
template <class Value>
std::vector<Vec3f> values_of(const std::vector<Shape>& shapes, const UnwrappedAtlas& atlas,
                             const Value& value) {
  std::vector<Vec3f> values;
  for (std::size_t i = 0; i < shapes.size(); ++i)
    for (const std::uint32_t v : atlas.mesh(i).vertices)
      values.push_back(value(i, shapes[i].positions[v]));
  return values;
}

float bilinear(const ImageF& image, Vec2d at, int channel) {
  const double x = at.x * image.width - 0.5, y = at.y * image.height - 0.5;
  const int i = int(std::floor(x)), j = int(std::floor(y));
  const auto texel = [&](int dx, int dy) {
    return image.at(std::clamp(i + dx, 0, image.width - 1),
                    std::clamp(j + dy, 0, image.height - 1))[channel];
  };
  const double s = x - i, t = y - j;
  return float((1 - t) * ((1 - s) * texel(0, 0) + s * texel(1, 0)) +
               t * ((1 - s) * texel(0, 1) + s * texel(1, 1)));
}

TEST(Transfer, LookupsReproduceWhatIsSmooth) {
  const std::vector<Shape> shapes{torus(60, 30)};
  const UnwrappedAtlas atlas = unwrapped_of(shapes, {{.page_size = 256}});
  const auto values = values_of(shapes, atlas, [](std::size_t, Vec3f p) {
    return Vec3f{std::sin(2 * p.x), std::cos(2 * p.y), p.z};
  });
  const auto image = transfer(atlas, values, {}, {});
  ASSERT_TRUE(image.ok()) << image.status().message();
  const UnwrappedAtlas::Mesh mesh = atlas.mesh(0);
  double worst = 0;
  for (std::size_t t = 0; t < mesh.indices.size(); t += 3) {
    Vec2d uv{};
    Vec3f expected{};
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint32_t v = mesh.indices[t + k];
      uv = {uv.x + mesh.uvs[v].x / 3, uv.y + mesh.uvs[v].y / 3};
      expected = {expected.x + values[v].x / 3, expected.y + values[v].y / 3,
                  expected.z + values[v].z / 3};
    }
    worst = std::max({worst, std::abs(double(bilinear(*image, uv, 0) - expected.x)),
                      std::abs(double(bilinear(*image, uv, 1) - expected.y)),
                      std::abs(double(bilinear(*image, uv, 2) - expected.z))});
  }
  EXPECT_LT(worst, 0.02);
}

// Each mesh has one value; at each vertex that is what lookups see, and nothing else is on the
// pages.
TEST(Transfer, ChartsDoNotMix) {
  const std::vector<Shape> shapes{torus(24, 12), box(4), needles(40, 200)};
  const UnwrappedAtlas atlas =
      unwrapped_of(shapes, {{.pages = 8, .page_size = 128, .padding = 1}, {}, 0, 60});
  const auto values = values_of(shapes, atlas, [](std::size_t mesh, Vec3f) {
    return Vec3f{float(mesh), float(mesh), 5};
  });
  ASSERT_GT(atlas.all().pages.size(), 1u);
  for (std::uint32_t page = 0; page < atlas.all().pages.size(); ++page) {
    const auto image = transfer(atlas, values, {.page = page}, {});
    ASSERT_TRUE(image.ok()) << image.status().message();
    for (std::size_t i = 0; i < shapes.size(); ++i) {
      const UnwrappedAtlas::Mesh mesh = atlas.mesh(i);
      for (std::size_t c = 0; c < mesh.indices.size(); ++c) {
        if (mesh.triangle_page[c / 3] != page) continue;
        const Vec2f uv = mesh.uvs[mesh.indices[c]];
        ASSERT_NEAR(bilinear(*image, {uv.x, uv.y}, 0), float(i), 1e-4) << "page " << page;
      }
    }
    for (std::size_t i = 2; i < image->texels.size(); i += 3)
      ASSERT_NEAR(image->texels[i], 5, 1e-4);
  }
}

TEST(Transfer, SameForAnyNumberOfThreads) {
  const std::vector<Shape> shapes{noisy(torus(50, 30), 0.02, 3)};
  const UnwrappedAtlas atlas = unwrapped_of(shapes, {{.page_size = 256}});
  const auto values = values_of(shapes, atlas, [](std::size_t, Vec3f p) { return p; });
  Context one, four;
  one.threads = 1;
  four.threads = 4;
  EXPECT_EQ(transfer(atlas, values, {}, one)->texels, transfer(atlas, values, {}, four)->texels);
}

TEST(Transfer, RefusesWhatItCannotUse) {
  const std::vector<Shape> shapes{box(2)};
  const UnwrappedAtlas atlas = unwrapped_of(shapes, {{.page_size = 64}});
  auto values = values_of(shapes, atlas, [](std::size_t, Vec3f p) { return p; });
  const auto code = [&](const TransferOptions& options, const Context& context = {}) {
    return transfer(atlas, values, options, context).status().code();
  };
  EXPECT_EQ(code({.page = 1}), ErrorCode::bad_option);
  EXPECT_EQ(code({.shifts = 0}), ErrorCode::bad_option);
  EXPECT_EQ(code({.shifts = 65}), ErrorCode::bad_option);
  const std::atomic<bool> cancel = true;
  Context cancelled;
  cancelled.cancel = &cancel;
  EXPECT_EQ(code({}, cancelled), ErrorCode::cancelled);
  values.back().y = std::numeric_limits<float>::infinity();
  EXPECT_EQ(code({}), ErrorCode::bad_input);
  values.pop_back();
  EXPECT_EQ(code({}), ErrorCode::bad_input);
}

}  // namespace
}  // namespace atlas::test
