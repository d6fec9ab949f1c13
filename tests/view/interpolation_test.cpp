// Tests how well the methods that interpolate between keys replace the classic map.
#include <gtest/gtest.h>
#include <cstdio>

#include "libatlas/shadow/light_path.h"
#include "libatlas/view/bench.h"
#include "tests/view/shapes.h"

namespace atlas::testing {
namespace {

using Errors = std::vector<BenchError>;

BenchOptions options_for(const View& view) {
  BenchOptions o;
  o.render.width = 320;
  o.render.height = 200;
  o.render.map_resolution = 1024;
  o.camera = view.camera;
  o.methods = {ShadowMethod::hold, ShadowMethod::linear, ShadowMethod::march};
  o.error_intervals = {8};
  o.error_frames = 16;
  return o;
}

LightPath sun() {
  LightPathOptions o;
  o.sun.start_hour = 9;
  return *LightPath::make(o);
}

const BenchError& of(const Errors& r, ShadowMethod method) {
  for (const BenchError& e : r)
    if (e.method == method) return e;
  ADD_FAILURE() << "not measured";
  return r.front();
}

LightPath through_the_window() {
  LightPathOptions o;
  o.kind = PathKind::arc;
  o.directions = {{1, 0.7, -0.1}, {1, 0.7, 0.5}};
  return *LightPath::make(o);
}

void print(const Errors& r) {
  for (const BenchError& e : r)
    std::printf("k %2d %-8s mean %.5f wrong %.5f, off edges %.5f %.5f, psnr %.2f ssim %.4f\n",
                e.interval, name_of(e.method), e.visibility.mean, e.visibility.wrong,
                e.visibility.mean_off_edges, e.visibility.wrong_off_edges, e.psnr, e.ssim);
}

void expect_a_quarter(const View& view, const LightPath& path) {
  const BenchOptions o = options_for(view);
  const Renderer first = must_render(view.scene, o.render);
  const Errors r = bench_errors(first, path, o).value();
  print(r);
  const BenchError &march = of(r, ShadowMethod::march), &linear = of(r, ShadowMethod::linear);
  EXPECT_LE(march.visibility.mean, linear.visibility.mean / 4);
  EXPECT_LE(march.visibility.wrong, linear.visibility.wrong / 4);
  EXPECT_GT(march.psnr, linear.psnr);
  EXPECT_LT(linear.visibility.mean, of(r, ShadowMethod::hold).visibility.mean);
}

TEST(Interpolation, TheMarchHasAtMostAQuarterOfTheLinearError) {
  expect_a_quarter(courtyard_view(), sun());
  expect_a_quarter(pavilion_view(), sun());
}

// Light from a window moves over furniture: each key's map hides what the other sees.
TEST(Interpolation, TheMarchLeavesNoOutlinesBesideWindows) {
  expect_a_quarter(room_view(), through_the_window());
}

TEST(Interpolation, TheMarchWinsAtEveryInterval) {
  const View view = pavilion_view();
  BenchOptions o = options_for(view);
  o.methods = {ShadowMethod::linear, ShadowMethod::march};
  o.error_frames = 8;
  o.error_intervals = {2, 4, 32};
  const Renderer first = must_render(view.scene, o.render);
  const Errors r = bench_errors(first, sun(), o).value();
  print(r);
  ASSERT_EQ(r.size(), 6u);
  for (std::size_t i = 0; i + 1 < r.size(); i += 2) {
    const VisibilityError &linear = r[i].visibility, &march = r[i + 1].visibility;
    EXPECT_LT(march.mean, linear.mean);
    EXPECT_LE(march.wrong, linear.wrong / 4);
    // Edges are left out, since two classic maps with other texels differ there by as much. 2e-5 is
    // also the noise of such texels.
    EXPECT_LE(march.mean_off_edges, linear.mean_off_edges / 4 + 2e-5);
  }
}

TEST(Interpolation, AtAKeyEveryMethodShowsTheClassicPicture) {
  const View view = courtyard_view();
  RenderOptions o = options_for(view).render;
  o.show_visibility = true;
  o.shadows = ShadowMethod::classic;
  Renderer classic = must_render(view.scene, o);
  const LightPath path = sun();
  for (ShadowMethod method : {ShadowMethod::hold, ShadowMethod::linear, ShadowMethod::slerp,
                              ShadowMethod::slerp_normalised, ShadowMethod::march}) {
    o.shadows = method;
    Result<Renderer> other = classic.share(o);
    ASSERT_TRUE(other.ok());
    for (int f = 0; f <= 16; ++f) {
      const FrameLight light{path.direction(f * 0.5),
                             [&](int n) { return path.direction((f + n) * 0.5); }};
      ASSERT_TRUE(other->draw(view.camera, light).ok());
      if (f % 8 != 0) continue;
      ASSERT_TRUE(classic.draw(view.camera, light).ok());
      EXPECT_EQ(other->read_image().texels, classic.read_image().texels)
          << name_of(method) << " " << f;
    }
  }
}

TEST(Interpolation, TheMarchLooksOftenerWhereKeysAreFarApart) {
  EXPECT_EQ(march_samples(4, 0), 4);
  EXPECT_EQ(march_samples(4, 4), 4);
  EXPECT_EQ(march_samples(4, 16), 16);
  EXPECT_EQ(march_samples(4, 90), kMostMarchSamples);
  EXPECT_EQ(march_samples(40, 90), 40);
  // An adaptive number of samples is nearly as good as always taking the most.
  const View view = room_view();
  BenchOptions o = options_for(view);
  o.methods = {ShadowMethod::march};
  o.error_intervals = {32};
  o.render.width = 200;
  o.render.height = 125;
  const Renderer first = must_render(view.scene, o.render);
  const Errors adapted = bench_errors(first, through_the_window(), o).value();
  o.render.march_steps = kMostMarchSamples;
  const Errors plain = bench_errors(first, through_the_window(), o).value();
  print(adapted);
  print(plain);
  EXPECT_LT(adapted[0].visibility.mean, 1.2 * plain[0].visibility.mean);
}

// A pole's shadow falls on one place at a time. The cross-fade shows two half shadows, the march
// one whole shadow.
TEST(Interpolation, TheMarchMovesAShadowInsteadOfShowingTwo) {
  View view;
  add_quad(view.scene, {{-4, 0, 4}, {4, 0, 4}, {4, 0, -4}, {-4, 0, -4}}, 2);
  add_box(view.scene, {-2, 2, -0.1f}, {2, 2.1f, 0.1f});
  view.camera.eye = {0.1, 7, 6};
  view.camera.near_plane = 0.5;
  RenderOptions o = options_for(view).render;
  o.show_visibility = true;
  LightPathOptions arc;
  arc.kind = PathKind::arc;
  arc.directions = {{0, 1, 0.5}, {0, 1, -0.5}};
  const LightPath path = *LightPath::make(arc);
  const auto shadowed = [&](ShadowMethod method, int low, int high) {
    o.shadows = method;
    Renderer r = must_render(view.scene, o);
    for (int f = 0; f <= 12; ++f) {
      const FrameLight light{path.direction(f), [&](int n) { return path.direction(f + n); }};
      EXPECT_TRUE(r.draw(view.camera, light).ok());
    }
    const Image8 image = r.read_image();
    int count = 0;
    for (std::size_t i = 0; i < image.texels.size(); i += 3)
      count += image.texels[i] >= low && image.texels[i] <= high;
    return count;
  };
  const int grey_linear = shadowed(ShadowMethod::linear, 64, 192);
  const int grey_march = shadowed(ShadowMethod::march, 64, 192);
  const int grey_classic = shadowed(ShadowMethod::classic, 64, 192);
  const int dark_march = shadowed(ShadowMethod::march, 0, 63);
  const int dark_classic = shadowed(ShadowMethod::classic, 0, 63);
  EXPECT_GT(grey_linear, 2 * grey_classic);
  EXPECT_LT(grey_march, 1.3 * grey_classic + 20);
  EXPECT_NEAR(dark_march, dark_classic, 0.12 * dark_classic);
}

}  // namespace
}  // namespace atlas::testing
