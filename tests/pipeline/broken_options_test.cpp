// Breaks each field of the structs of options, one at a time. Public calls must refuse them.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <set>
#include <string>
#include <vector>

#include "libatlas/bake/bake.h"
#include "libatlas/pack/fit.h"
#include "libatlas/pack/grouping.h"
#include "libatlas/pack/outline.h"
#include "libatlas/param/parameterize.h"
#include "libatlas/pipeline/export_options.h"
#include "libatlas/simplify/simplify.h"
#include "libatlas/texture/chart_textures.h"
#include "libatlas/texture/tone.h"
#include "libatlas/unwrap/page_layout.h"
#include "libatlas/unwrap/unwrap.h"
#include "tests/support/field_count.h"
#include "tests/support/lit_shapes.h"

namespace atlas {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr double kInfinity = std::numeric_limits<double>::infinity();

template <class Options>
struct Break {
  const char* field;
  void (*damage)(Options&);
};

// A call that takes options, and how they can be broken. `any` lists the fields that no value
// breaks. `base` counts those fields that a base class brings, and names among `breaks`.
template <class Options>
struct Walk {
  std::vector<Break<Options>> breaks;
  std::vector<std::string> any;
  std::size_t base = 0;
};

template <class Options, class Call>
void expect_each_is_refused(const Walk<Options>& walk, const Call& call, Options good = {}) {
  const Status fine = call(good);
  EXPECT_TRUE(fine.ok()) << fine.message();
  std::set<std::string> fields(walk.any.begin(), walk.any.end());
  for (const Break<Options>& b : walk.breaks) {
    Options broken = good;
    b.damage(broken);
    const Status status = call(broken);
    EXPECT_FALSE(status.ok()) << b.field;
    EXPECT_EQ(status.code(), ErrorCode::bad_option) << b.field << ": " << status.message();
    EXPECT_FALSE(status.message().empty()) << b.field;
    fields.insert(b.field);
  }
  const std::size_t bases = walk.base > 0 ? 1 : 0;
  EXPECT_EQ(fields.size() - walk.base + bases, test::field_count<Options>())
      << "the test walks over all fields of the struct";
}

// Values that no enumerator has come from casts.
template <class Enum>
void beyond(Enum& value) {
  value = Enum(77);
}

template <class Made>
Status status_of(const Result<Made>& made) {
  return made.ok() ? Status() : made.status();
}

Walk<ChartOptions> of_charts() {
  using O = ChartOptions;
  return {{{"cone_degrees", [](O& o) { o.cone_degrees = kNan; }},
           {"max_stretch", [](O& o) { o.max_stretch = 1; }},
           {"max_stretch", [](O& o) { o.max_stretch = kInfinity; }},
           {"crease_degrees", [](O& o) { o.crease_degrees = -1; }},
           {"uv_aspect", [](O& o) { o.uv_aspect = kNan; }},
           {"material_uv_aspects",
            [](O& o) {
              o.material_uv_aspects = {1, 0};
            }},
           {"preset", [](O& o) { beyond(o.preset); }},
           {"preset", [](O& o) { o.preset = ChartPreset(-1); }},
           {"min_fill", [](O& o) { o.min_fill = kNan; }},
           {"seam_weight", [](O& o) { o.seam_weight = 0; }}},
          {"split_at_materials", "keep_uv_charts"}};
}

struct Triangle {
  std::vector<Vec3f> positions{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  std::vector<std::uint32_t> indices{0, 1, 2};
  MeshView view() const { return {.positions = positions, .indices = indices}; }
};

TEST(BrokenOptions, OfChartsAreRefused) {
  const Triangle mesh;
  expect_each_is_refused(of_charts(), [&](const ChartOptions& o) {
    return status_of(make_charts(mesh.view(), o, {}));
  });
}

// The fields of PageOptions, for the structs that are made from it.
template <class O>
Walk<O> of_pages() {
  return {{{"pages", [](O& o) { o.pages = 0; }},
           {"page_size", [](O& o) { o.page_size = -64; }},
           {"page_size", [](O& o) { o.page_size = 1 << 30; }},
           {"padding", [](O& o) { o.padding = -1; }},
           {"padding", [](O& o) { o.padding = std::numeric_limits<std::int32_t>::max(); }},
           {"alignment", [](O& o) { o.alignment = 0; }},
           {"preset", [](O& o) { beyond(o.preset); }}},
          {"square", "allow_rotation"},
          test::field_count<PageOptions>()};
}

template <class O>
Walk<O> operator+(Walk<O> a, const Walk<O>& b) {
  a.breaks.insert(a.breaks.end(), b.breaks.begin(), b.breaks.end());
  a.any.insert(a.any.end(), b.any.begin(), b.any.end());
  return a;
}

TEST(BrokenOptions, OfUnwrappingAreRefused) {
  using O = UnwrapOptions;
  const Triangle mesh;
  Walk<O> walk =
      of_pages<O>() +
      Walk<O>{{{"mip_levels", [](O& o) { o.mip_levels = -1; }},
               {"texels_per_unit", [](O& o) { o.texels_per_unit = kNan; }},
               {"charts", [](O& o) { o.charts.max_stretch = kNan; }},
               {"like",
                [](O& o) {
                  static const Extent page{64, 64};
                  static const EarlierUvs earlier{.pages = {&page, 1}, .tolerance = kNan};
                  o.like = &earlier;
                }}},
              {"part_gaps"}};
  expect_each_is_refused(walk,
                         [&](const O& o) { return status_of(unwrap_mesh(mesh.view(), o, {})); });
}

TEST(BrokenOptions, OfPageLayoutsAreRefused) {
  using O = LayoutOptions;
  const Triangle mesh;
  const ChartSet charts = *make_charts(mesh.view(), {}, {});
  const std::vector<Vec2d> densities(charts.charts.size(), Vec2d{10, 10});
  const Walk<O> walk =
      of_pages<O>() + Walk<O>{{{"minimum_side", [](O& o) { o.minimum_side = -1; }},
                               {"time_budget", [](O& o) { o.time_budget = kNan; }}},
                              {"outlines", "free_aspect", "remedy"}};
  expect_each_is_refused(
      walk, [&](const O& o) { return status_of(lay_out_pages(charts, densities, o, {})); });
}

TEST(BrokenOptions, OfFittingAreRefused) {
  using O = FitOptions;
  static const std::vector<Vec2d> corners{{0, 0}, {kNan, 0}, {0, 1}};
  static const std::vector<ChartShape> shapes{{corners}}, none{{}};
  const Walk<O> walk = of_pages<O>() + Walk<O>{{{"minimum_side", [](O& o) { o.minimum_side = -1; }},
                                                {"max_scale", [](O& o) { o.max_scale = kNan; }},
                                                {"max_packings", [](O& o) { o.max_packings = 1; }},
                                                {"time_budget", [](O& o) { o.time_budget = kNan; }},
                                                {"shapes_area", [](O& o) { o.shapes_area = kNan; }},
                                                {"rotations",
                                                 [](O& o) {
                                                   o.shapes = none;
                                                   o.rotations = 3;
                                                 }}},
                                               {"power_of_two", "shapes", "any_angle",
                                                "press_pages", "free_aspect", "effort", "seed"}};
  const std::vector<FitItem> items{{10, 20}};
  expect_each_is_refused(walk, [&](const O& o) { return status_of(fit_pages(items, o, {})); });
  O broken;
  broken.shapes = shapes;
  EXPECT_EQ(status_of(fit_pages(items, broken, {})).code(), ErrorCode::bad_input);
  broken.shapes = std::span(shapes).first(0);
  EXPECT_FALSE(fit_pages(std::vector<FitItem>{{kNan, 1}}, {}, {}).ok());
}

TEST(BrokenOptions, OfPackingRectanglesAreRefused) {
  using O = PackOptions;
  const Walk<O> walk{{{"page", [](O& o) { o.page.width = -1; }},
                      {"page",
                       [](O& o) {
                         o.page = {0, 5};
                       }},
                      {"padding", [](O& o) { o.padding = -1; }},
                      {"border", [](O& o) { o.border = std::numeric_limits<std::int32_t>::max(); }},
                      {"alignment", [](O& o) { o.alignment = 0; }},
                      {"power_of_two",
                       [](O& o) {
                         o.power_of_two = true;
                         o.page = {100, 64};
                       }},
                      {"square",
                       [](O& o) {
                         o.square = true;
                         o.page = {128, 64};
                       }},
                      {"preset", [](O& o) { beyond(o.preset); }},
                      {"engine", [](O& o) { beyond(o.engine); }},
                      {"time_budget", [](O& o) { o.time_budget = kNan; }}},
                     {"max_pages", "allow_rotation", "crop", "effort", "seed", "pinned"}};
  const std::vector<Extent> items{{3, 4}};
  expect_each_is_refused(walk, [&](const O& o) { return status_of(pack_rects(items, o, {})); });
  EXPECT_FALSE(pack_rects(std::vector<Extent>{{-1, 2}}, {}, {}).ok());
}

TEST(BrokenOptions, OfPackingOutlinesAreRefused) {
  using O = OutlineOptions;
  const Walk<O> walk{{{"page", [](O& o) { o.page.width = 0; }},
                      {"scale", [](O& o) { o.scale = kNan; }},
                      {"padding", [](O& o) { o.padding = -1; }},
                      {"border", [](O& o) { o.border = -1; }},
                      {"alignment", [](O& o) { o.alignment = 0; }},
                      {"rotations", [](O& o) { o.rotations = 0; }},
                      {"preset", [](O& o) { beyond(o.preset); }},
                      {"time_budget", [](O& o) { o.time_budget = -1; }}},
                     {"max_pages", "effort", "seed"}};
  const std::vector<Vec2d> corners{{0, 0}, {8, 0}, {0, 8}};
  const std::vector<ChartShape> shapes{{corners}};
  expect_each_is_refused(walk, [&](const O& o) { return status_of(pack_outlines(shapes, o, {})); });
}

TEST(BrokenOptions, OfGroupingAreRefused) {
  using O = GroupingOptions;
  const Walk<O> walk{{{"groups", [](O& o) { o.groups = 0; }}}, {"page_capacity", "refine_work"}};
  const std::vector<std::uint64_t> sizes{3, 4};
  expect_each_is_refused(walk, [&](const O& o) { return status_of(group_sizes(sizes, o, {})); });
}

TEST(BrokenOptions, OfParameterisationAreRefused) {
  using O = ParamOptions;
  static const std::vector<Vec2d> uvs{{0, 0}};
  const std::vector<Vec3d> positions{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  const std::vector<std::array<std::uint32_t, 3>> triangles{{0, 1, 2}};
  const Walk<O> walk{{{"max_stretch", [](O& o) { o.max_stretch = kNan; }},
                      {"method", [](O& o) { beyond(o.method); }},
                      {"iterations", [](O& o) { o.iterations = -1; }},
                      {"squeeze_iterations", [](O& o) { o.squeeze_iterations = -1; }},
                      {"min_altitude", [](O& o) { o.min_altitude = kInfinity; }}},
                     {"axis", "start"}};
  ParamWorkspace workspace;
  expect_each_is_refused(walk, [&](const O& o) {
    return status_of(parameterize({.positions = positions, .triangles = triangles}, o, workspace));
  });
}

TEST(BrokenOptions, OfTheLightsStagesAreRefused) {
  const LitShape sheet = make_sheet({}, [](double u, double) {
    return Vec3f{float(u), 0.5f, 0.5f};
  });
  const LuminanceSampler sampler(sheet.scene, Quantity::illuminance);
  const ToneMapping tone;
  const ChartLight light{sampler, sheet.charts, tone};
  {
    using O = TextureOptions;
    expect_each_is_refused(
        Walk<O>{{{"texel", [](O& o) { o.texel = kNan; }},
                 {"texture_sampling", [](O& o) { o.texture_sampling = 0; }},
                 {"threshold", [](O& o) { o.threshold = kNan; }},
                 {"min_side", [](O& o) { o.min_side = 0; }},
                 {"max_side", [](O& o) { o.max_side = 1; }},
                 {"brightest", [](O& o) { o.brightest = kNan; }}},
                {"follow_textures"}},
        [&](const O& o) { return status_of(size_chart_textures(light, o, {})); });
  }
  {
    using O = BakeOptions;
    expect_each_is_refused(Walk<O>{{{"page_width", [](O& o) { o.page_width = 0; }},
                                    {"page_height", [](O& o) { o.page_height = 1 << 30; }},
                                    {"shifts", [](O& o) { o.shifts = 0; }},
                                    {"mip_levels", [](O& o) { o.mip_levels = 11; }},
                                    {"method", [](O& o) { beyond(o.method); }}},
                                   {"linear"}},
                           [&](const O& o) { return status_of(bake_page(light, {}, o, {})); });
  }
  {
    using O = SimplifyOptions;
    const std::vector<double> density(sheet.charts.charts.size(), 10);
    const SimplifyInput input{{.positions = sheet.scene.positions, .indices = sheet.scene.indices},
                              sheet.charts,
                              density};
    expect_each_is_refused(
        Walk<O>{{{"max_slip_texels", [](O& o) { o.max_slip_texels = kNan; }},
                 {"max_border_slip_texels", [](O& o) { o.max_border_slip_texels = -1; }},
                 {"max_turn_degrees", [](O& o) { o.max_turn_degrees = 90; }}},
                {}},
        [&](const O& o) { return status_of(simplify_charts(input, o, {})); });
  }
  ToneMapping no_operator;
  beyond(no_operator.op);
  EXPECT_EQ(status_of(size_chart_textures({sampler, sheet.charts, no_operator}, {}, {})).code(),
            ErrorCode::bad_input);
}

TEST(BrokenOptions, OfToneCurvesAreRefused) {
  using O = ToneOptions;
  const Walk<O> walk{{{"op", [](O& o) { beyond(o.op); }},
                      {"white", [](O& o) { o.white = kNan; }},
                      {"exposure_stops", [](O& o) { o.exposure_stops = 65; }},
                      {"key", [](O& o) { o.key = 0; }},
                      {"bias", [](O& o) { o.bias = kNan; }},
                      {"contrast", [](O& o) { o.contrast = 2; }},
                      {"chromatic_adaptation", [](O& o) { o.chromatic_adaptation = -1; }},
                      {"light_adaptation", [](O& o) { o.light_adaptation = kNan; }}},
                     {}};
  expect_each_is_refused(walk, [](const O& o) { return check_options(o); });
}

// Good options with which only uvs of each place are refused.
void meshes_once(ExportOptions& options) {
  options.target = "a.glb";
  options.keep_scene = options.charts_only = true;
  options.mesh_uvs = MeshUvs::meshes;
}

TEST(BrokenOptions, OfExportsAreRefused) {
  ExportOptions once;
  meshes_once(once);
  EXPECT_TRUE(check_options(once).ok()) << check_options(once).message();
  using O = ExportOptions;
  const Walk<O> walk{
      {{"target", [](O& o) { o.target = "a.txt"; }},
       {"atlases", [](O& o) { o.atlases = 0; }},
       {"atlas_size", [](O& o) { o.atlas_size = -1; }},
       {"plain_pages", [](O& o) { o.plain_pages = 0; }},
       {"udim", [](O& o) { o.udim = true; }},
       {"polygons", [](O& o) { o.polygons = true; }},
       {"plain_mip_levels", [](O& o) { o.plain_mip_levels = -1; }},
       {"plain_padding", [](O& o) { o.plain_padding = 65; }},
       {"texel_metres", [](O& o) { o.texel_metres = kNan; }},
       {"threshold", [](O& o) { o.threshold = kNan; }},
       {"min_side", [](O& o) { o.min_side = 0; }},
       {"quantity", [](O& o) { beyond(o.quantity); }},
       {"charts", [](O& o) { beyond(o.charts.preset); }},
       {"tone", [](O& o) { beyond(o.tone.op); }},
       {"mip_levels", [](O& o) { o.mip_levels = 6; }},
       {"shifts", [](O& o) { o.shifts = 65; }},
       {"bake_method", [](O& o) { beyond(o.bake_method); }},
       {"packing", [](O& o) { beyond(o.packing); }},
       {"time_budget", [](O& o) { o.time_budget = 1; }},
       {"time_budget",
        [](O& o) {
          o.packing = PackPreset::best;
          o.time_budget = kNan;
        }},
       {"time_budget",
        [](O& o) {
          meshes_once(o);
          o.packing = PackPreset::best;
          o.time_budget = 1;
        }},
       {"simplify_slip", [](O& o) { o.simplify_slip = kNan; }},
       {"up", [](O& o) { beyond(o.up); }},
       {"linear", [](O& o) { o.linear = true; }},
       {"texture_format", [](O& o) { beyond(o.texture_format); }},
       {"webp_quality", [](O& o) { o.webp_quality = 101; }},
       {"compress", [](O& o) { o.compress = true; }},
       {"png_compression", [](O& o) { o.png_compression = 10; }},
       {"keep_scene", [](O& o) { o.keep_scene = true; }},
       {"lightmap_pages", [](O& o) { o.lightmap_pages = 0; }},
       {"mesh_uvs", [](O& o) { beyond(o.mesh_uvs); }},
       {"uv_set", [](O& o) { o.uv_set = 8; }},
       {"false_colour", [](O& o) { o.false_colour = "a.jpg"; }},
       {"seams",
        [](O& o) {
          meshes_once(o);
          o.seams = {1, 0, 0};
        }},
       {"like",
        [](O& o) {
          static const LoadedScene earlier;
          meshes_once(o);
          o.like = &earlier;
        }}},
      {"larger_plain_page", "square_plain_page", "plain_part_gaps", "follow_textures",
       "split_at_light", "more_mip_levels", "outlines", "simplify", "exr", "charts_only",
       "colours_are_light", "extra_files", "durable", "report_pictures", "measure_error"}};
  O good;
  good.target = "a.wrl";
  expect_each_is_refused(
      walk, [](const O& o) { return check_options(o); }, good);
}

// Arrays of a mesh and of a disc, likewise.
TEST(BrokenOptions, BrokenMeshesAreRefused) {
  const auto refused = [](const auto& damage) {
    const Triangle mesh;
    std::vector<Vec3f> positions = mesh.positions;
    std::vector<std::uint32_t> indices = mesh.indices, materials{0};
    std::vector<float> density{1};
    damage(positions, indices, materials, density);
    const MeshView view{
        .positions = positions, .indices = indices, .materials = materials, .density = density};
    return make_charts(view, {}, {}).ok() + unwrap_mesh(view, {}, {}).ok();
  };
  EXPECT_EQ(refused([](auto&, auto&, auto&, auto&) {}), 2) << "none of them refuses the mesh";
  EXPECT_EQ(refused([](auto& p, auto&, auto&, auto&) { p[1].y = float(kNan); }), 0);
  EXPECT_EQ(refused([](auto&, auto& i, auto&, auto&) { i[2] = 3; }), 0);
  EXPECT_EQ(refused([](auto&, auto& i, auto&, auto&) { i.pop_back(); }), 0);
  EXPECT_EQ(refused([](auto&, auto& i, auto&, auto&) { i.clear(); }), 0);
  EXPECT_EQ(refused([](auto&, auto&, auto& m, auto&) { m.push_back(1); }), 0);
  EXPECT_EQ(refused([](auto&, auto&, auto&, auto& d) { d[0] = float(kNan); }), 0);
}

TEST(BrokenOptions, BrokenDiscsAreRefused) {
  struct Disc {
    std::vector<Vec3d> positions{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
    std::vector<std::array<std::uint32_t, 3>> triangles{{0, 1, 2}};
    std::vector<double> density{1};
    std::vector<std::uint32_t> opposite{0xffffffff, 0xffffffff, 0xffffffff};
    std::vector<Vec2d> start{{0, 0}, {1, 0}, {0, 1}};
  };
  const auto accepted = [](void (*damage)(Disc&)) {
    Disc d;
    damage(d);
    ParamWorkspace workspace;
    ParamOptions options;
    options.start.uvs = d.start;
    const Result<ParamResult> made = parameterize({.positions = d.positions,
                                                   .triangles = d.triangles,
                                                   .density = d.density,
                                                   .opposite = d.opposite},
                                                  options, workspace);
    return made.ok() || made.status().code() != ErrorCode::bad_input;
  };
  EXPECT_TRUE(accepted([](Disc&) {}));
  EXPECT_FALSE(accepted([](Disc& d) { d.positions[0].z = kNan; }));
  EXPECT_FALSE(accepted([](Disc& d) { d.triangles[0][1] = 3; }));
  EXPECT_FALSE(accepted([](Disc& d) { d.triangles[0][1] = 0; }));
  EXPECT_FALSE(accepted([](Disc& d) { d.density[0] = -1; }));
  EXPECT_FALSE(accepted([](Disc& d) { d.density.push_back(1); }));
  EXPECT_FALSE(accepted([](Disc& d) { d.opposite[1] = 3; }));
  EXPECT_FALSE(accepted([](Disc& d) { d.opposite.pop_back(); }));
  EXPECT_FALSE(accepted([](Disc& d) { d.start[2].x = kNan; }));
  EXPECT_FALSE(accepted([](Disc& d) { d.start.pop_back(); }));
}

}  // namespace
}  // namespace atlas
