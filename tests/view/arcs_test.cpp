// Compares the march with classic maps on arcs of all kinds, picture by picture.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <utility>

#include "libatlas/shadow/light_path.h"
#include "tests/view/shapes.h"

namespace atlas::testing {
namespace {

struct Arc {
  const char* name;
  Vec3d from, to;
  double step = 1;  // degrees a frame
};

// Of one picture: pixels beyond two texels of an edge of a shadow, and those of them that are off.
struct Compared {
  int clear = 0, off = 0;
};

// The visibility that classic maps show lies strictly between 0 and 255 within the reach of a 3x3
// filter of an edge, which is two texels.
Compared compare(const Image8& march, const Image8& classic, const Image8& visibility) {
  Compared c;
  for (std::size_t i = 0; i < march.texels.size(); i += 3) {
    if (visibility.texels[i] > 0 && visibility.texels[i] < 255) continue;
    int most = 0;
    for (std::size_t k = i; k < i + 3; ++k)
      most = std::max(most, std::abs(march.texels[k] - classic.texels[k]));
    ++c.clear;
    c.off += most > 10;
  }
  return c;
}

RenderOptions options_of(ShadowMethod method, const Vec3d& up) {
  RenderOptions o;
  o.width = 320;
  o.height = 200;
  o.map_resolution = 1024;
  o.shadows = method;
  o.up = up;
  return o;
}

// Draws every frame of the arc with both methods. Expects that march shows what classic does.
void expect_like_classic(const View& view, const Vec3d& up, const Arc& arc) {
  LightPathOptions path_options;
  path_options.kind = PathKind::arc;
  path_options.directions = {arc.from, arc.to};
  const LightPath path = *LightPath::make(path_options);
  Renderer march = must_render(view.scene, options_of(ShadowMethod::march, up));
  RenderOptions o = options_of(ShadowMethod::classic, up);
  Renderer classic = std::move(march.share(o).value());
  o.show_visibility = true;
  Renderer seen = std::move(march.share(o).value());
  double worst = 0;
  int worst_frame = 0;
  for (int f = 0; f * arc.step <= path.length(); ++f) {
    const FrameLight light{path.direction(f * arc.step),
                           [&](int n) { return path.direction((f + n) * arc.step); }};
    for (Renderer* r : {&march, &classic, &seen}) ASSERT_TRUE(r->draw(view.camera, light).ok());
    const Compared c = compare(march.read_image(), classic.read_image(), seen.read_image());
    ASSERT_GT(c.clear, 320 * 200 / 2) << arc.name << " frame " << f;
    const double share = double(c.off) / c.clear;
    if (share > worst) {
      worst = share;
      worst_frame = f;
    }
  }
  std::printf("%-24s worst frame %2d: %.3f %% off\n", arc.name, worst_frame, worst * 100);
  EXPECT_LE(worst, 0.005) << arc.name << " frame " << worst_frame;
}

// Their keys are 1 to 16 degrees apart, and 8 on most.
const Arc kArcs[] = {
    {"overhead", {-0.3, 1, 0}, {0.3, 1, 0}},
    {"overhead, oblique", {-0.2, 1, -0.2}, {0.2, 1, 0.2}},
    {"short", {0, 1, 0.03}, {0.03, 1, 0}, 0.1},
    {"through the horizon", {1, -0.2, 0.3}, {1, 0.3, 0.2}},
    {"along x", {1, 0, 0.3}, {1, 0, -0.3}},
    {"from z to the zenith", {0, 0, 1}, {0, 1, 0}, 2},
};

TEST(Arcs, TheMarchShowsWhatClassicMapsShow) {
  for (const Arc& arc : kArcs) expect_like_classic(courtyard_view(), {0, 1, 0}, arc);
}

// Slopes of rolling ground face away from one of two keys.
TEST(Arcs, RollingGroundIsLitAsByClassicMaps) {
  for (const Arc& arc : {kArcs[0], kArcs[3], kArcs[5]})
    expect_like_classic(pavilion_view(), {0, 1, 0}, arc);
}

// Turns what is y into z.
Vec3d upright(const Vec3d& v) {
  return {v.x, -v.z, v.y};
}

TEST(Arcs, TheyMayStandOnAnotherAxis) {
  View view = courtyard_view();
  for (Vec3f& p : view.scene.positions) p = {p.x, -p.z, p.y};
  for (Vec3d* v : {&view.camera.eye, &view.camera.target, &view.camera.up}) *v = upright(*v);
  for (Arc arc : {kArcs[0], kArcs[3]}) {
    arc.from = upright(arc.from);
    arc.to = upright(arc.to);
    expect_like_classic(view, {0, 0, 1}, arc);
  }
}

}  // namespace
}  // namespace atlas::testing
