// What stays of an earlier result, by the C interface.
#include <gtest/gtest.h>

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <string>
#include <vector>

#include "libatlas/c/atlas.h"
#include "tests/c/c_fixture.h"

namespace atlas::test {
namespace {

class CLike : public C {
 protected:
  libatlas_mesh_uvs uvs_of(const libatlas_unwrapped* unwrapped, std::uint32_t mesh) {
    auto uvs = sized<libatlas_mesh_uvs>();
    EXPECT_EQ(libatlas_get_mesh(context(), unwrapped, mesh, &uvs), LIBATLAS_OK) << message();
    return uvs;
  }
  libatlas_charts charts_of(const libatlas_unwrapped* unwrapped) {
    auto charts = sized<libatlas_charts>();
    EXPECT_EQ(libatlas_get_charts(context(), unwrapped, &charts), LIBATLAS_OK) << message();
    return charts;
  }
  libatlas_unwrap_options like(const libatlas_earlier_uvs& earlier) {
    libatlas_unwrap_options options;
    libatlas_unwrap_options_init(&options, sizeof options);
    options.like = &earlier;
    return options;
  }

  // All meshes as one, by what was handed out.
  struct Earlier {
    std::vector<Vec3f> positions = {};
    std::vector<std::uint32_t> indices = {}, triangle_page = {}, objects = {};
    std::vector<Vec2f> uvs = {};
    libatlas_atlas_info info = sized<libatlas_atlas_info>();

    libatlas_earlier_uvs view() const {
      libatlas_earlier_uvs earlier;
      libatlas_earlier_uvs_init(&earlier, sizeof earlier);
      earlier.positions = positions.data();
      earlier.position_count = positions.size();
      earlier.indices = indices.data();
      earlier.index_count = indices.size();
      earlier.uvs = uvs.data();
      earlier.uv_count = uvs.size();
      earlier.triangle_page = triangle_page.data();
      earlier.pages = info.pages;
      earlier.page_count = info.page_count;
      earlier.objects = objects.data();
      return earlier;
    }
  };
  Earlier earlier_of(const std::vector<Shape>& shapes, const libatlas_unwrapped* unwrapped) {
    Earlier earlier;
    EXPECT_EQ(libatlas_get_info(context(), unwrapped, &earlier.info), LIBATLAS_OK);
    for (std::uint32_t i = 0; i < shapes.size(); ++i) {
      const libatlas_mesh_uvs own = uvs_of(unwrapped, i);
      const auto base = std::uint32_t(earlier.positions.size());
      for (std::size_t v = 0; v < own.vertex_count; ++v) {
        earlier.positions.push_back(shapes[i].positions[own.vertices[v]]);
        earlier.uvs.push_back({own.uvs[2 * v], own.uvs[2 * v + 1]});
        earlier.objects.push_back(i);
      }
      for (std::size_t k = 0; k < 3 * own.triangle_count; ++k)
        earlier.indices.push_back(base + own.indices[k]);
      earlier.triangle_page.insert(earlier.triangle_page.end(), own.triangle_page,
                                   own.triangle_page + own.triangle_count);
    }
    return earlier;
  }

  // Whether two corners have the same uv, to the bit.
  static bool same_uv(const libatlas_mesh_uvs& a, std::size_t i, const libatlas_mesh_uvs& b,
                      std::size_t j) {
    return std::memcmp(&a.uvs[2 * a.indices[i]], &b.uvs[2 * b.indices[j]], 2 * sizeof(float)) == 0;
  }
};

// Meshes touch: the plate is a side of the box.
TEST_F(CLike, ChartsStayAndTheEditIsNamed) {
  const auto before = unwrap(atlas_of(shapes_).get());
  const Earlier earlier = earlier_of(shapes_, before.get());
  constexpr std::uint32_t kRemoved = 100;
  std::vector<Shape> edited = shapes_;
  edited[0].indices.erase(edited[0].indices.begin() + 3 * kRemoved,
                          edited[0].indices.begin() + 3 * kRemoved + 3);
  const libatlas_earlier_uvs view = earlier.view();
  const libatlas_unwrap_options options = like(view);
  const auto now = unwrap(atlas_of(edited).get(), &options);
  for (std::uint32_t i = 0; i < edited.size(); ++i) {
    const libatlas_mesh_uvs was = uvs_of(before.get(), i), is = uvs_of(now.get(), i);
    for (std::size_t c = 0; c < 3 * is.triangle_count; ++c)
      ASSERT_TRUE(same_uv(is, c, was, i == 0 && c >= 3 * kRemoved ? c + 3 : c)) << i << ", " << c;
  }
  const libatlas_charts charts = charts_of(now.get());
  ASSERT_NE(charts.origins, nullptr);
  const std::uint32_t touched = uvs_of(now.get(), 0).triangle_chart[kRemoved];
  for (std::size_t c = 0; c < charts.chart_count; ++c)
    EXPECT_EQ(charts.origins[c], c == touched ? LIBATLAS_REPAIRED : LIBATLAS_KEPT) << c;
  EXPECT_EQ(charts_of(before.get()).origins, nullptr);
}

TEST_F(CLike, ArraysMayHaveGapsAndIndicesOfTheirOwn) {
  const Shape& shape = shapes_[0];
  const auto before = unwrap(atlas_of({shape}).get());
  const libatlas_mesh_uvs was = uvs_of(before.get(), 0);
  struct Wide {
    Vec3f position;
    float other;
  };
  std::vector<Wide> positions;
  for (const Vec3f p : shape.positions) positions.push_back({p, 7});
  const std::vector<std::uint16_t> indices(shape.indices.begin(), shape.indices.end()),
      uv_indices(was.indices, was.indices + 3 * was.triangle_count);
  libatlas_earlier_uvs earlier = earlier_of({shape}, before.get()).view();
  earlier.positions = positions.data();
  earlier.position_count = positions.size();
  earlier.position_stride = sizeof(Wide);
  earlier.indices = indices.data();
  earlier.uv_indices = uv_indices.data();
  earlier.index_bytes = 2;
  earlier.uvs = was.uvs;
  earlier.uv_count = was.vertex_count;
  earlier.triangle_page = earlier.objects = nullptr;
  auto info = sized<libatlas_atlas_info>();
  ASSERT_EQ(libatlas_get_info(context(), before.get(), &info), LIBATLAS_OK);
  earlier.pages = info.pages;
  const libatlas_unwrap_options options = like(earlier);
  const auto now = unwrap(atlas_of({shape}).get(), &options);
  const libatlas_mesh_uvs is = uvs_of(now.get(), 0);
  for (std::size_t c = 0; c < 3 * is.triangle_count; ++c) ASSERT_TRUE(same_uv(is, c, was, c)) << c;
}

TEST_F(CLike, WhatIsNotUsableIsNamed) {
  const auto atlas = atlas_of({shapes_[0]});
  const auto before = unwrap(atlas.get());
  const Earlier earlier = earlier_of({shapes_[0]}, before.get());
  const auto refused = [&](libatlas_status status, const char* text, auto change) {
    Earlier own = earlier;
    libatlas_earlier_uvs view = own.view();
    libatlas_unwrap_options options = like(view);
    change(own, view, options);
    libatlas_unwrapped* unwrapped = nullptr;
    EXPECT_EQ(libatlas_unwrap(context(), atlas.get(), &options, &unwrapped), status) << text;
    EXPECT_EQ(unwrapped, nullptr);
    EXPECT_NE(message().find(text), std::string::npos) << message();
  };
  using Uvs = libatlas_earlier_uvs;
  using Options = libatlas_unwrap_options;
  const auto bad = LIBATLAS_BAD_INPUT;
  refused(bad, "position 5 is not finite",
          [](Earlier& e, Uvs&, Options&) { e.positions[5].y = NAN; });
  refused(bad, "triangle 3: index 100000 names none of the",
          [](Earlier& e, Uvs&, Options&) { e.indices[10] = 100000; });
  refused(bad, "indices are not whole triangles",
          [](Earlier&, Uvs& u, Options&) { --u.index_count; });
  refused(bad, "positions are null", [](Earlier&, Uvs& u, Options&) { u.positions = nullptr; });
  refused(bad, "uvs are null", [](Earlier&, Uvs& u, Options&) { u.uvs = nullptr; });
  refused(bad, "uvs lie 7 bytes apart", [](Earlier&, Uvs& u, Options&) { u.uv_stride = 7; });
  refused(bad, "indices have 3 bytes each", [](Earlier&, Uvs& u, Options&) { u.index_bytes = 3; });
  refused(bad, "pages is null", [](Earlier&, Uvs& u, Options&) { u.pages = nullptr; });
  refused(bad, "no page", [](Earlier&, Uvs& u, Options&) { u.page_count = 0; });
  refused(LIBATLAS_BAD_OPTION, "tolerance", [](Earlier&, Uvs& u, Options&) { u.tolerance = NAN; });
  refused(LIBATLAS_BAD_OPTION, "libatlas_earlier_uvs: size",
          [](Earlier&, Uvs& u, Options&) { u.size = 8; });
  refused(LIBATLAS_BAD_OPTION, "like and keep_uv_charts",
          [](Earlier&, Uvs&, Options& o) { o.keep_uvs = 1; });
}

// As a program does that was compiled before there was `like`.
TEST_F(CLike, OptionsOfEarlierHeadersAreTaken) {
  const auto atlas = atlas_of(shapes_);
  libatlas_unwrap_options options;
  libatlas_unwrap_options_init(&options, sizeof options);
  options.size = offsetof(libatlas_unwrap_options, like);
  options.like = reinterpret_cast<const libatlas_earlier_uvs*>(1);  // beyond what it has
  const auto unwrapped = unwrap(atlas.get(), &options);
  auto charts = sized<libatlas_charts>();
  charts.size = offsetof(libatlas_charts, origins);
  const auto* const beyond = reinterpret_cast<const std::uint8_t*>(1);
  charts.origins = beyond;
  ASSERT_EQ(libatlas_get_charts(context(), unwrapped.get(), &charts), LIBATLAS_OK) << message();
  EXPECT_EQ(charts.origins, beyond);  // not touched
}

}  // namespace
}  // namespace atlas::test
