// Tests the renderer's promises: counted passes, even work, errors of one line, no OpenGL errors.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "libatlas/shadow/light_path.h"
#include "libatlas/view/gl_objects.h"
#include "tests/view/shapes.h"

namespace atlas::testing {
namespace {

RenderOptions small() {
  RenderOptions o;
  o.width = 160;
  o.height = 100;
  o.map_resolution = 256;
  return o;
}

FrameLight sun_at(const LightPath& path, int frame) {
  return {path.direction(frame * 0.5),
          [&path, frame](int n) { return path.direction((frame + n) * 0.5); }};
}

TEST(Render, AStaticLightCostsExactlyOneShadowPass) {
  const View view = courtyard_view();
  RenderOptions o = small();
  for (ShadowMethod method : kAllMethods) {
    o.shadows = method;
    Renderer r = must_render(view.scene, o);
    std::uint64_t triangles = 0;
    for (int f = 0; f < 40; ++f) {
      const Result<FrameStats> s = r.draw(view.camera, still({1, 2, 0.5}));
      ASSERT_TRUE(s.ok());
      triangles += s->triangles_shadow;
    }
    const bool none = method == ShadowMethod::none;
    EXPECT_EQ(r.shadow_passes(), none ? 0 : 1) << name_of(method);
    EXPECT_EQ(triangles, none ? 0 : view.scene.triangle_count()) << name_of(method);
  }
}

TEST(Render, SlicedWorkIsEven) {
  const View view = pavilion_view();
  const LightPath path = *LightPath::make({});
  RenderOptions o = small();
  o.shadows = ShadowMethod::linear;
  Renderer r = must_render(view.scene, o);
  double sum = 0, most = 0;
  for (int f = 0; f < 65; ++f) {
    const FrameStats s = *r.draw(view.camera, sun_at(path, f));
    if (f == 0) continue;
    const double work = s.triangles_shadow + s.triangles_lit;
    sum += work / 64;
    most = std::max(most, work);
  }
  EXPECT_LE(most, 1.1 * sum);
}

// A map that is drawn in slices over eight frames equals the map drawn in one.
TEST(Render, SlicesMakeTheSameMap) {
  const View view = courtyard_view();
  const LightPath path = *LightPath::make({});
  RenderOptions o = small();
  o.shadows = ShadowMethod::linear;
  o.show_visibility = true;
  Renderer sliced = must_render(view.scene, o);
  o.schedule.sliced = false;
  Renderer whole = must_render(view.scene, o);
  for (int f = 0; f < 30; ++f) {
    ASSERT_TRUE(sliced.draw(view.camera, sun_at(path, f)).ok());
    ASSERT_TRUE(whole.draw(view.camera, sun_at(path, f)).ok());
    ASSERT_EQ(sliced.read_image().texels, whole.read_image().texels) << f;
  }
}

TEST(Render, SixHundredFramesOfEverythingWithoutAnError) {
  const View view = courtyard_view();
  const LightPath path = *LightPath::make({});
  GlContext& gl = test_context();
  RenderOptions o = small();
  o.width = 64;
  o.height = 40;
  Renderer r = must_render(view.scene, o);
  Camera camera = view.camera;
  int frame = 0;
  for (int round = 0; frame < 600; ++round) {
    o.shading = Shading(round % 4);
    o.shadows = kAllMethods[round % 7];
    o.pcf = std::array{0, 1, 3, 5}[round / 2 % 4];
    o.fit_view = round % 5 == 0;
    o.show_visibility = round % 3 == 0;
    o.map_resolution = round % 11 == 0 ? 512 : 256;
    o.map_bits = std::array{32, 24, 16}[round / 3 % 3];
    o.width = 64 + round % 3;
    ASSERT_TRUE(r.set_options(o).ok());
    for (int i = 0; i < 12; ++i, ++frame) {
      fly(camera, {0.02, 0.01, 0}, 0.5, 0.1);
      fit_planes(camera, r.bounds());
      const Result<FrameStats> s = r.draw(camera, sun_at(path, frame));
      ASSERT_TRUE(s.ok()) << s.status().message();
    }
  }
  EXPECT_EQ(gl.debug_errors(), 0) << gl.first_debug_error();
}

// Returns the share of pixels whose visibility differs by more than a half from a map's that is as
// fine as the picture.
double wrong_shadows(const Scene& scene, const Camera& camera, double view_distance) {
  RenderOptions o = small();
  o.shadows = ShadowMethod::classic;
  o.show_visibility = true;
  o.map_resolution = 1024;
  o.fit_view = true;
  o.view_distance = view_distance;
  Renderer r = must_render(scene, o);
  EXPECT_TRUE(r.draw(camera, still({-1, 1, 1})).ok());
  const Image8 image = r.read_image();
  o.fit_view = false;
  Renderer truth = must_render(courtyard(), o);
  EXPECT_TRUE(truth.draw(camera, still({-1, 1, 1})).ok());
  const Image8 wanted = truth.read_image();
  int wrong = 0;
  for (std::size_t i = 0; i < image.texels.size(); i += 3)
    wrong += std::abs(image.texels[i] - wanted.texels[i]) > 127;
  return wrong / (double(image.width) * image.height);
}

// In the yard alone a quarter of the diagonal cut off what is in view, and on big ground, it was
// kilometres.
TEST(Render, ShadowsReachWhereTheDetailIs) {
  Scene yard = courtyard();
  Camera camera = courtyard_view().camera;
  EXPECT_LT(wrong_shadows(yard, camera, 0), 0.01);
  EXPECT_GT(wrong_shadows(yard, camera, 1), 0.02) << "the test sees shadows that are cut off";
  const float g = 5000;
  add_quad(yard, {{-g, -0.01f, g}, {g, -0.01f, g}, {g, -0.01f, -g}, {-g, -0.01f, -g}});
  EXPECT_LT(wrong_shadows(yard, camera, 0), 0.02);
  RenderOptions o = small();
  Renderer r = must_render(yard, o);
  const MapReach all = *r.map_reach(camera, {-1, 1, 1});
  EXPECT_EQ(all.distance, 0);
  EXPECT_GT(all.texel, 2 * g / o.map_resolution);
  o.fit_view = true;
  ASSERT_TRUE(r.set_options(o).ok());
  const MapReach near = *r.map_reach(camera, {-1, 1, 1});
  EXPECT_GT(near.distance, 10);
  EXPECT_LT(near.distance, 25);
  EXPECT_LT(near.texel, 0.3);
  o.shadows = ShadowMethod::none;
  ASSERT_TRUE(r.set_options(o).ok());
  EXPECT_EQ(r.map_reach(camera, {-1, 1, 1})->texel, 0);
}

// A visitor stands near the corner of 20 km of ground, two metres before a pillar.
TEST(Render, NearThingsAreSeenOnBigGround) {
  Scene s;
  const float g = 10000;
  add_quad(s, {{-g, 0, g}, {g, 0, g}, {g, 0, -g}, {-g, 0, -g}});
  add_box(s, {9899.9f, 0, 9897.9f}, {9900.1f, 3, 9898.1f});
  s.materials.push_back({"pillar", {1, 0, 0}});
  std::fill(s.triangle_material.begin() + 2, s.triangle_material.end(), 1u);
  Camera camera;
  camera.eye = {9902, 1.6, 9899.8};
  camera.target = {9900, 1.4, 9898};
  RenderOptions o = small();
  o.background = {0, 0, 1};
  for (const Shading shading : {Shading::unlit, Shading::lambert}) {
    o.shading = shading;
    Renderer r = must_render(s, o);
    fit_planes(camera, r.bounds());
    ASSERT_TRUE(r.draw(camera, still({1, 1, 0.9})).ok());
    const Image8 image = r.read_image();
    const std::uint8_t* pillar = image.at(image.width / 2, image.height / 2);
    EXPECT_GT(pillar[0], 100);
    EXPECT_EQ(pillar[1], 0) << "the ground behind the pillar";
    for (int x = 0; x < image.width; ++x)
      EXPECT_GT(*image.at(x, 0), 100) << "the ground at the feet, " << x;
  }
}

// What a pass has not finished writing must not be read by the next one.
TEST(Render, FramesOfOneViewAreTheSame) {
  const View view = courtyard_view();
  RenderOptions o = small();
  o.shadows = ShadowMethod::classic;
  o.show_visibility = true;
  Renderer r = must_render(view.scene, o);
  Image8 first;
  for (int frame = 0; frame < 200; ++frame) {
    // The light moves to and fro, so that each frame draws its map.
    const bool back = frame % 2 == 1;
    ASSERT_TRUE(r.draw(view.camera, still({0.6, 1, back ? 0.1 : 0.35})).ok());
    if (back) continue;
    if (frame == 0) first = r.read_image();
    ASSERT_EQ(r.read_image().texels, first.texels) << frame;
  }
}

TEST(Render, FittingToTheViewShowsTheSameShadowsFiner) {
  const View view = courtyard_view();
  RenderOptions o = small();
  o.shadows = ShadowMethod::classic;
  o.show_visibility = true;
  Renderer whole = must_render(view.scene, o);
  o.fit_view = true;
  o.view_distance = 12;
  Renderer fitted = must_render(view.scene, o);
  const FrameLight light = still({0.6, 1, 0.35});
  ASSERT_TRUE(whole.draw(view.camera, light).ok());
  ASSERT_TRUE(fitted.draw(view.camera, light).ok());
  const Image8 a = whole.read_image(), b = fitted.read_image();
  int differ = 0;
  for (std::size_t i = 0; i < a.texels.size(); i += 3)
    differ += std::abs(a.texels[i] - b.texels[i]) > 127;
  EXPECT_LT(differ, 0.02 * 160 * 100);
}

TEST(Render, ACameraThatLeavesTheFittedPartRefreshesTheKeys) {
  const View view = pavilion_view();
  RenderOptions o = small();
  o.fit_view = true;
  o.view_distance = 1.5;
  Renderer r = must_render(view.scene, o);
  Camera camera = view.camera;
  ASSERT_TRUE(r.draw(camera, still({0, 1, 0})).ok());
  EXPECT_FALSE(r.draw(camera, still({0, 1, 0}))->refreshed);
  fly(camera, {5, 0, 0}, 0, 0);
  EXPECT_TRUE(r.draw(camera, still({0, 1, 0}))->refreshed);
}

// Keys are sampled for up to three intervals after they were fitted.
TEST(Render, AMovingCameraSeesFittedShadowsAtAnySpeed) {
  Scene scene;  // a floor that is wholly in the shadow of a roof
  add_quad(scene, {{-30, 0, 30}, {30, 0, 30}, {30, 0, -30}, {-30, 0, -30}});
  add_quad(scene, {{-60, 5, 60}, {60, 5, 60}, {60, 5, -60}, {-60, 5, -60}});
  RenderOptions o = small();
  o.width = 64;
  o.height = 40;
  o.fit_view = o.show_visibility = true;
  o.view_distance = 2;
  o.schedule.interval_frames = 16;
  for (ShadowMethod method : {ShadowMethod::hold, ShadowMethod::linear, ShadowMethod::march})
    for (double speed : {0.01, 0.02, 0.04, 0.08, 0.2}) {
      o.shadows = method;
      Renderer r = must_render(scene, o);
      int lit = 0;
      for (int f = 0; f < 100; ++f) {
        const auto at = [&](int n) { return Vec3d{0.002 * (f + n), 1, 0.1}; };
        Camera camera;
        camera.eye = {-10 + speed * f, 1.9, 0};
        camera.target = {-10 + speed * f, 0, 0.01};
        camera.near_plane = 0.1;
        ASSERT_TRUE(r.draw(camera, {at(0), at}).ok());
        const Image8 image = r.read_image();
        lit += int(std::count(image.texels.begin(), image.texels.end(), std::uint8_t{255})) / 3;
      }
      EXPECT_EQ(lit, 0) << name_of(method) << " at " << speed;
    }
}

TEST(Render, ThePlanSaysWhatIsMissingAndWhy) {
  RenderOptions o = small();
  o.shading = Shading::unlit;
  const std::vector<std::string> plan = must_render(courtyard(), o).plan();
  ASSERT_EQ(plan.size(), 5u);
  EXPECT_EQ(plan[0], "compiled: unlit");
  EXPECT_NE(plan[1].find("one pass"), std::string::npos);
  EXPECT_NE(plan[2].find("no shadow maps"), std::string::npos);
  EXPECT_NE(plan[3].find("no texture"), std::string::npos);
  EXPECT_NE(plan[4].find("no baked light"), std::string::npos);
}

// Floats hold every position of the moved scene exactly; what is computed from them must not round.
TEST(Render, AFarSceneLooksLikeANearOne) {
  View near;
  add_quad(near.scene, {{-4, 0, 4}, {4, 0, 4}, {4, 0, -4}, {-4, 0, -4}}, 8);
  add_box(near.scene, {-2, 0.25f, -1}, {-1.5f, 2, 1});
  add_box(near.scene, {0.5f, 1, -2}, {2, 1.125f, 2});
  near.camera.eye = {1, 6, 5.5};
  near.camera.near_plane = 0.5;
  View far = near;
  const Vec3f by{0x1p17f, 0x1p18f, -0x1p18f};
  for (Vec3f& p : far.scene.positions) p = {p.x + by.x, p.y + by.y, p.z + by.z};
  for (Vec3d* p : {&far.camera.eye, &far.camera.target})
    *p = {p->x + by.x, p->y + by.y, p->z + by.z};
  RenderOptions o = small();
  o.shading = Shading::ward;
  for (ShadowMethod method : {ShadowMethod::classic, ShadowMethod::linear, ShadowMethod::march}) {
    o.shadows = method;
    Renderer a = must_render(near.scene, o), b = must_render(far.scene, o);
    const LightPath path = *LightPath::make({});
    for (int f = 0; f < 4; ++f) {
      ASSERT_TRUE(a.draw(near.camera, sun_at(path, f)).ok());
      ASSERT_TRUE(b.draw(far.camera, sun_at(path, f)).ok());
    }
    const Image8 x = a.read_image(), y = b.read_image();
    int different = 0;
    for (std::size_t i = 0; i < x.texels.size(); ++i)
      different += std::abs(int(x.texels[i]) - int(y.texels[i])) > 2;
    EXPECT_LE(different, int(x.texels.size()) / 2000) << name_of(method);
  }
}

TEST(Render, WrongOptionsAreSaidAndChangeNothing) {
  const View view = courtyard_view();
  RenderOptions o = small();
  Renderer r = must_render(view.scene, o);
  for (int i = 0; i < 12; ++i) {
    RenderOptions bad = o;
    if (i == 0) bad.pcf = 2;
    if (i == 1) bad.width = 0;
    if (i == 2) bad.height = 1 << 20;
    if (i == 3) bad.map_resolution = 1 << 20;
    if (i == 4) bad.march_steps = 0;
    if (i == 6) bad.map_bits = 8;
    if (i == 5) bad.schedule.interval_frames = 0;
    if (i == 7) bad.roughness = 0;
    if (i == 8) bad.ambient = -1;
    if (i == 9) bad.exposure = std::nan("");
    if (i == 10) bad.shininess = 1e300;
    if (i == 11) bad.up = {0, 0, 0};
    const Status s = r.set_options(bad);
    EXPECT_EQ(s.code(), ErrorCode::bad_option) << i;
    EXPECT_EQ(s.message().find('\n'), std::string::npos);
    EXPECT_TRUE(r.draw(view.camera, still({0, 1, 0})).ok()) << i;
  }
}

// This includes settings that only the driver refuses, after some have been applied.
TEST(Render, SettingsThatCannotBeHadLeaveTheFormerPicture) {
  const View view = courtyard_view();
  const RenderOptions o = small();
  Renderer r = must_render(view.scene, o);
  const FrameLight light = still({0.6, 1, 0.35});
  ASSERT_TRUE(r.draw(view.camera, light).ok());
  const Image8 before = r.read_image();
  for (int i = 0; i < 3; ++i) {
    RenderOptions bad = o;
    if (i == 0) bad.map_resolution = 1 << 20;
    if (i == 1) bad.show_visibility = true, bad.map_resolution = 8;
    // Three gigabytes, more than llvmpipe allows for a texture. GPUs may have as much.
    if (i == 2) bad.map_resolution = test_context().info().software ? 16384 : 1 << 17;
    const Status s = r.set_options(bad);
    EXPECT_FALSE(s.ok()) << i;
    EXPECT_EQ(s.message().find("does not draw"), std::string::npos) << s.message();
    EXPECT_EQ(s.message().find('\n'), std::string::npos);
    const Result<FrameStats> drawn = r.draw(view.camera, light);
    ASSERT_TRUE(drawn.ok()) << i << ": " << drawn.status().message();
    EXPECT_EQ(r.read_image().texels, before.texels) << i;
  }
}

TEST(Render, AShaderThatDoesNotCompileGivesOneLine) {
  test_context();
  const Result<GlProgram> p =
      link_program("test", "#version 450 core\nvoid main() { gl_Position = vec4(0); }\n",
                   "#version 450 core\nvoid main() { undefined_thing(); }\n");
  ASSERT_FALSE(p.ok());
  EXPECT_NE(p.status().message().find("test (fragment) does not compile"), std::string::npos);
  EXPECT_EQ(p.status().message().find('\n'), std::string::npos);
}

TEST(Render, ALightOfNoDirectionGivesOneLine) {
  const View view = courtyard_view();
  Renderer r = must_render(view.scene, small());
  EXPECT_FALSE(r.draw(view.camera, still({0, 0, 0})).ok());
  const FrameLight light = still({0.6, 1, 0.35});
  EXPECT_TRUE(r.draw(view.camera, light).ok());
  Renderer fresh = must_render(view.scene, small());
  ASSERT_TRUE(fresh.draw(view.camera, light).ok());
  EXPECT_EQ(r.read_image().texels, fresh.read_image().texels) << "its shadows come with the next";
}

}  // namespace
}  // namespace atlas::testing
