// Random arguments end in a status and a message, never in a crash.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstring>
#include <limits>
#include <random>
#include <string>
#include <vector>

#include "libatlas/c/atlas.h"

namespace atlas::test {
namespace {

class RandomArguments : public testing::Test {
 protected:
  static constexpr std::size_t kBytes = 4096;

  void SetUp() override { libatlas_set_threads(context_, 1); }
  void TearDown() override { libatlas_context_destroy(context_); }

  std::uint32_t below(std::uint32_t n) { return std::uint32_t(random_()) % n; }
  bool often() { return below(8) != 0; }

  template <class T>
  T one_of(std::initializer_list<T> values) {
    return values.begin()[below(std::uint32_t(values.size()))];
  }

  // A number near what is usual, or one that is out of any range.
  double number(double usual) {
    if (often()) return usual * (0.5 + below(1000) / 1000.0);
    const double infinity = std::numeric_limits<double>::infinity();
    return one_of({0.0, -1.0, 1e-300, 1e300, infinity, -infinity, std::nan("")});
  }
  std::int32_t integer(std::int32_t usual) {
    if (often()) return std::int32_t(below(2 * std::uint32_t(usual) + 1));
    return one_of({0, -1, 7, 1 << 20, std::numeric_limits<std::int32_t>::max(),
                   std::numeric_limits<std::int32_t>::min()});
  }
  std::int32_t flag() { return often() ? std::int32_t(below(2)) : integer(3); }

  void fill_arrays(std::uint32_t positions) {
    const auto coordinate = [&] { return below(500) ? float(below(9)) / 4 : float(number(1)); };
    for (float& f : floats_) f = coordinate();
    for (std::size_t i = 0; i < wide_.size(); ++i) {
      wide_[i] = below(positions + (below(200) == 0));
      narrow_[i] = std::uint16_t(wide_[i]);
    }
    for (auto& m : materials_) m = below(3);
    for (auto& s : seams_) s = below(20) == 0;
    for (auto& d : densities_) d = below(500) ? 0.5f + float(below(4)) : float(number(1));
  }

  // Counts are such that nothing beyond the arrays is named.
  libatlas_mesh mesh() {
    libatlas_mesh m;
    libatlas_mesh_init(&m, sizeof m);
    if (!often()) m.size = below(400);
    m.position_count = 3 + below(20);
    fill_arrays(std::uint32_t(m.position_count));
    m.positions = often() ? floats_.data() : nullptr;
    m.position_stride = often() ? one_of<std::size_t>({0, 12, 16, 13, 24}) : below(40);
    m.index_bytes = often() ? one_of<std::size_t>({2, 4}) : below(9);
    m.indices = !often()             ? nullptr
                : m.index_bytes == 2 ? static_cast<const void*>(narrow_.data())
                                     : static_cast<const void*>(wide_.data());
    m.index_count = often() ? 3 * (1 + below(30)) : below(90);
    if (!often()) {
      m.texcoords = floats_.data() + 50;
      m.texcoord_count = often() ? m.position_count : below(30);
      m.texcoord_stride = one_of<std::size_t>({0, 8, 3, 20});
      if (!often()) m.texcoord_indices = wide_.data();
    }
    if (!often()) {
      m.normals = floats_.data() + 20;
      m.normal_stride = one_of<std::size_t>({0, 12, 5, 16});
    }
    if (!often()) m.materials = materials_.data();
    if (!often()) m.seams = seams_.data();
    if (!often()) m.triangle_density = densities_.data();
    if (!often()) m.seam_weights = densities_.data();
    m.density = float(number(1));
    if (!often()) {
      // Sizes that add up to the indices, but for a while.
      m.polygon_count = 0;
      for (std::size_t left = m.index_count; left > 2;) {
        const std::uint32_t size = left < 6 ? std::uint32_t(left) : 3 + below(3);
        sizes_[m.polygon_count++] = often() ? size : below(5);
        left -= size;
      }
      m.polygon_sizes = often() ? sizes_.data() : nullptr;
      if (!often()) m.polygon_count = below(30);
    }
    return m;
  }

  libatlas_unwrap_options options() {
    libatlas_unwrap_options o;
    libatlas_unwrap_options_init(&o, sizeof o);
    o.charts = o.packing = LIBATLAS_FAST;
    if (!often()) o.size = below(400);
    if (!often()) o.max_stretch = number(1.3);
    if (!often()) o.cone_degrees = number(60);
    if (!often()) o.crease_degrees = number(60);
    if (!often()) o.min_fill = number(0.7);
    if (!often()) o.seam_weight = number(2);
    if (!often()) o.uv_aspect = number(1);
    if (!often()) o.texels_per_unit = number(10);
    if (!often()) o.pages = std::uint32_t(integer(2));
    o.page_size = often() ? 128 : integer(200);
    if (!often()) o.padding = integer(4);
    if (!often()) o.mip_levels = integer(3);
    if (!often()) o.alignment = integer(4);
    if (!often()) o.charts = integer(2);
    if (!often()) o.packing = integer(1);
    for (std::int32_t* f :
         {&o.split_at_materials, &o.keep_uvs, &o.allow_rotation, &o.square, &o.part_gaps})
      if (!often()) *f = flag();
    return o;
  }

  libatlas_earlier_uvs earlier() {
    libatlas_earlier_uvs e;
    libatlas_earlier_uvs_init(&e, sizeof e);
    const libatlas_mesh m = mesh();
    if (!often()) e.size = below(200);
    e.positions = m.positions;
    e.position_count = m.position_count;
    e.position_stride = m.position_stride;
    e.indices = m.indices;
    e.index_count = m.index_count;
    e.index_bytes = m.index_bytes;
    e.uvs = often() ? floats_.data() + 50 : nullptr;
    e.uv_count = below(30);
    e.uv_stride = m.texcoord_stride;
    if (!often()) e.uv_indices = m.indices;
    if (!often()) e.triangle_page = materials_.data();
    if (!often()) e.objects = materials_.data();
    pages_ = {libatlas_extent{64, 64}, {integer(64), integer(64)}, {64, 1 << 20}};
    if (often()) e.pages = pages_.data();
    e.page_count = often() ? 1 : below(4);
    if (!often()) e.tolerance = number(0.1);
    return e;
  }

  libatlas_island_options island_options() {
    libatlas_island_options o;
    libatlas_island_options_init(&o, sizeof o);
    o.preset = LIBATLAS_FAST;
    if (!often()) o.size = below(200);
    if (!often()) o.texels_per_uv = number(10);
    if (!often()) o.pages = std::uint32_t(integer(2));
    o.page_size = often() ? 128 : integer(200);
    if (!often()) o.padding = integer(4);
    if (!often()) o.alignment = integer(4);
    for (std::int32_t* f : {&o.allow_rotation, &o.square, &o.preset})
      if (!often()) *f = flag();
    return o;
  }

  libatlas_pack_options pack_options() {
    libatlas_pack_options o;
    libatlas_pack_options_init(&o, sizeof o);
    o.preset = LIBATLAS_FAST;
    if (!often()) o.size = below(200);
    if (!often()) o.page = {integer(200), integer(200)};
    if (!often()) o.max_pages = std::uint32_t(integer(2));
    for (std::int32_t* n : {&o.padding, &o.border, &o.alignment})
      if (!often()) *n = integer(4);
    for (std::int32_t* f : {&o.allow_rotation, &o.crop, &o.power_of_two, &o.square, &o.preset})
      if (!often()) *f = flag();
    o.effort = 10;
    return o;
  }

  // Counts a status, which must be one that arguments can cause.
  bool count(libatlas_status status) {
    const std::string message = libatlas_message(context_);
    EXPECT_EQ(status == LIBATLAS_OK, message.empty()) << status << ": " << message;
    EXPECT_TRUE(status == LIBATLAS_OK ||
                (status >= LIBATLAS_BAD_INPUT && status <= LIBATLAS_OUT_OF_MEMORY))
        << status << ": " << message;
    EXPECT_EQ(message.find('\n'), std::string::npos) << message;
    ++(status == LIBATLAS_OK ? done_ : refused_);
    return status == LIBATLAS_OK;
  }

  libatlas_context* context_ = libatlas_context_create();
  std::mt19937 random_{5};
  std::array<float, kBytes / sizeof(float)> floats_ = {};
  std::array<std::uint32_t, 100> wide_ = {};
  std::array<std::uint16_t, 100> narrow_ = {};
  std::array<std::uint32_t, 40> materials_ = {};
  std::array<std::uint32_t, 40> sizes_ = {};
  std::array<libatlas_extent, 3> pages_ = {};
  std::array<std::uint8_t, 100> seams_ = {};
  std::array<float, 40> densities_ = {};
  int done_ = 0, refused_ = 0;
};

TEST_F(RandomArguments, OfMeshesAndUnwrapping) {
  for (int i = 0; i < 300; ++i) {
    SCOPED_TRACE(i);
    libatlas_atlas* atlas = nullptr;
    ASSERT_EQ(libatlas_atlas_create(context_, &atlas), LIBATLAS_OK);
    for (std::uint32_t n = below(4); n-- > 0;) {
      const libatlas_mesh m = mesh();
      if (often())
        count(libatlas_add_mesh(context_, atlas, &m, nullptr));
      else
        count(libatlas_add_instances(context_, atlas, &m, often() ? densities_.data() : nullptr,
                                     below(5), nullptr));
    }
    libatlas_unwrap_options o = options();
    const libatlas_earlier_uvs e = earlier();
    if (below(3) == 0 && o.size == sizeof o) o.like = &e;
    libatlas_unwrapped* unwrapped = nullptr;
    const bool done = count(libatlas_unwrap(context_, atlas, &o, &unwrapped));
    EXPECT_EQ(unwrapped != nullptr, done);
    libatlas_mesh_uvs uvs = {};
    uvs.size = often() ? sizeof uvs : below(200);
    if (count(libatlas_get_mesh(context_, unwrapped, below(3), &uvs))) {
      for (std::size_t k = 0; k < 2 * uvs.vertex_count; ++k)
        EXPECT_TRUE(uvs.uvs[k] >= 0 && uvs.uvs[k] <= 1) << uvs.uvs[k];
    }
    libatlas_instances instances = {};
    instances.size = often() ? sizeof instances : below(50);
    if (count(libatlas_get_instances(context_, unwrapped, below(3), &instances))) {
      for (std::size_t k = 0; k < instances.instance_count; ++k) {
        EXPECT_TRUE(instances.instances[k].scale[0] >= 0 && instances.instances[k].scale[1] <= 1);
      }
    }
    libatlas_polygon_uvs polygons = {};
    polygons.size = often() ? sizeof polygons : below(200);
    const std::uint32_t number = below(3);
    uvs.size = sizeof uvs;
    if (count(libatlas_get_polygons(context_, unwrapped, number, &polygons)) &&
        libatlas_get_mesh(context_, unwrapped, number, &uvs) == LIBATLAS_OK) {
      for (std::size_t k = 0; k < polygons.corner_count; ++k)
        EXPECT_LT(polygons.corners[k], uvs.vertex_count);
      for (std::size_t k = 0; k < polygons.cut_count; ++k)
        EXPECT_LT(polygons.cut_polygons[k], polygons.polygon_count);
    }
    libatlas_unwrapped_destroy(unwrapped);
    libatlas_atlas_destroy(atlas);
  }
  EXPECT_GT(done_, 200);
  EXPECT_GT(refused_, 200);
}

TEST_F(RandomArguments, OfIslandsAndRectangles) {
  for (int i = 0; i < 300; ++i) {
    SCOPED_TRACE(i);
    const libatlas_mesh m = mesh();
    libatlas_islands islands;
    libatlas_islands_init(&islands, sizeof islands);
    islands.uvs = m.positions;
    islands.uv_count = m.position_count;
    islands.uv_stride = m.position_stride;
    islands.indices = m.indices;
    islands.index_count = m.index_count;
    islands.index_bytes = m.index_bytes;
    const libatlas_island_options o = island_options();
    libatlas_packed_islands* packed_islands = nullptr;
    count(libatlas_pack_islands(context_, &islands, &o, &packed_islands));
    libatlas_packed_islands_destroy(packed_islands);
    std::vector<libatlas_extent> rects;
    for (std::uint32_t n = below(20); n-- > 0;)
      rects.push_back({std::int32_t(below(40)), below(60) ? std::int32_t(below(40)) : integer(40)});
    const libatlas_pack_options p = pack_options();
    libatlas_packed* packed = nullptr;
    count(libatlas_pack_rects(context_, rects.data(), rects.size(), &p, &packed));
    libatlas_packed_destroy(packed);
  }
  EXPECT_GT(done_, 100);
  EXPECT_GT(refused_, 100);
}

}  // namespace
}  // namespace atlas::test
