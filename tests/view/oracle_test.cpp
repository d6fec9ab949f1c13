// Compares classic shadow maps with rays: Embree traces what each pixel sees, and from there to the
// light.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <glm/geometric.hpp>
#include <glm/trigonometric.hpp>
#include <limits>

#include "examples/cabin/embree.h"
#include "libatlas/core/glm_bridge.h"
#include "libatlas/shadow/fit.h"
#include "tests/view/shapes.h"

namespace atlas::testing {
namespace {

class Rays {
 public:
  explicit Rays(const Scene& scene)
      : device_(rtcNewDevice("threads=1")), scene_(rtcNewScene(device_)) {
    RTCGeometry g = rtcNewGeometry(device_, RTC_GEOMETRY_TYPE_TRIANGLE);
    auto* v = static_cast<Vec3f*>(rtcSetNewGeometryBuffer(
        g, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, sizeof(Vec3f), scene.positions.size()));
    std::copy(scene.positions.begin(), scene.positions.end(), v);
    auto* i = static_cast<std::uint32_t*>(rtcSetNewGeometryBuffer(
        g, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, 12, scene.triangle_count()));
    std::copy(scene.indices.begin(), scene.indices.end(), i);
    rtcCommitGeometry(g);
    rtcAttachGeometry(scene_, g);
    rtcReleaseGeometry(g);
    rtcSetSceneFlags(scene_, RTC_SCENE_FLAG_ROBUST);
    rtcCommitScene(scene_);
  }
  ~Rays() {
    rtcReleaseScene(scene_);
    rtcReleaseDevice(device_);
  }
  Rays(const Rays&) = delete;
  Rays& operator=(const Rays&) = delete;

  struct Hit {
    bool found = false;
    glm::dvec3 point{0}, normal{0};
  };
  Hit first(const glm::dvec3& from, const glm::dvec3& along) const {
    RTCRayHit r{};
    set(r.ray, from, along, 0);
    r.hit.geomID = RTC_INVALID_GEOMETRY_ID;
    cabin::intersect(scene_, r);
    if (r.hit.geomID == RTC_INVALID_GEOMETRY_ID) return {};
    glm::dvec3 n = glm::normalize(glm::dvec3(r.hit.Ng_x, r.hit.Ng_y, r.hit.Ng_z));
    if (glm::dot(n, along) > 0) n = -n;
    return {true, from + along * double(r.ray.tfar), n};
  }
  bool blocked(const glm::dvec3& from, const glm::dvec3& along) const {
    RTCRay r{};
    set(r, from, along, 1e-4f);
    return cabin::occluded(scene_, r);
  }

 private:
  static void set(RTCRay& r, const glm::dvec3& o, const glm::dvec3& d, float near) {
    r.org_x = float(o.x), r.org_y = float(o.y), r.org_z = float(o.z);
    r.dir_x = float(d.x), r.dir_y = float(d.y), r.dir_z = float(d.z);
    r.tnear = near;
    r.tfar = std::numeric_limits<float>::infinity();
    r.mask = 0xffffffffu;
  }
  RTCDevice device_;
  RTCScene scene_;
};

struct Agreement {
  int compared = 0, agreed = 0, edge = 0, lit = 0, shadowed = 0;
  int all = 0, leaked = 0;  // edges included; `leaked` are lit where the ray is blocked
};

// Returns the direction of the ray through a pixel's centre.
glm::dvec3 pixel_ray(const Camera& c, const Image8& image, int x, int y) {
  const glm::dvec3 f = glm::normalize(to_glm(c.target) - to_glm(c.eye));
  const glm::dvec3 r = glm::normalize(glm::cross(f, to_glm(c.up))), u = glm::cross(r, f);
  const double t = std::tan(glm::radians(c.fov_degrees) / 2);
  return glm::normalize(f +
                        r * (t * image.width / image.height * (2 * (x + 0.5) / image.width - 1)) +
                        u * (t * (2 * (y + 0.5) / image.height - 1)));
}

Agreement compare(const View& view, const Vec3d& light, const RenderOptions& options) {
  Renderer renderer = must_render(view.scene, options);
  EXPECT_TRUE(renderer.draw(view.camera, still(light)).ok());
  const Image8 image = renderer.read_image();
  LightFitOptions f;
  f.resolution = options.map_resolution;
  f.border_texels = options.map_resolution / 128.0;
  const LightFit fit = *fit_light(light, renderer.bounds(), f);
  const glm::dvec3 l = to_glm(fit.direction);
  const glm::dvec3 side = glm::normalize(glm::cross(l, glm::dvec3(0.3, 0.9, 0.2)));
  const glm::dvec3 other = glm::cross(l, side);
  const Rays rays(view.scene);
  Agreement a;
  for (int y = 0; y < image.height; ++y)
    for (int x = 0; x < image.width; ++x) {
      const Rays::Hit hit =
          rays.first(to_glm(view.camera.eye), pixel_ray(view.camera, image, x, y));
      if (!hit.found) continue;
      const double nl = glm::dot(hit.normal, l);
      const auto truth = [&](const glm::dvec3& p) {
        return nl > 0 && !rays.blocked(p + hit.normal * 1e-4, l);
      };
      const bool lit = truth(hit.point);
      ++a.all;
      a.leaked += !lit && *image.at(x, y) > 127;
      // A point is within 2 texels of an edge if a ray from 2 texels beside it, on the same plane,
      // gives another result.
      bool edge = false;
      for (int i = 0; i < 8 && nl > 0 && !edge; ++i) {
        const double angle = i * 0.7853981633974483;
        const glm::dvec3 o = (side * std::cos(angle) + other * std::sin(angle)) * (2 * fit.texel);
        // The ray starts slightly above, since a neighbouring face may bend up into the plane.
        const glm::dvec3 lift = hit.normal * (0.5 * fit.texel);
        edge = truth(hit.point + o - l * (glm::dot(o, hit.normal) / nl) + lift) != lit;
      }
      if (edge) {
        ++a.edge;
        continue;
      }
      ++a.compared;
      (lit ? a.lit : a.shadowed)++;
      a.agreed += lit == (*image.at(x, y) > 127);
    }
  return a;
}

struct OracleCase {
  const char* name;
  View (*view)();
  Vec3d light;
};

RenderOptions classic_visibility(int pcf) {
  RenderOptions o;
  o.width = 320;
  o.height = 200;
  o.map_resolution = 1024;
  o.pcf = pcf;
  o.shadows = ShadowMethod::classic;
  o.show_visibility = true;
  return o;
}

TEST(Oracle, ClassicShadowsAgreeWithRaysAwayFromEdges) {
  const OracleCase cases[] = {{"courtyard", courtyard_view, {0.6, 1, 0.35}},
                              {"courtyard, low sun", courtyard_view, {1, 0.35, -0.2}},
                              {"room", room_view, {1, 0.7, 0.15}},
                              {"pavilion", pavilion_view, {0.3, 0.8, 0.7}}};
  for (int pcf : {0, 3})
    for (const OracleCase& c : cases) {
      const Agreement a = compare(c.view(), c.light, classic_visibility(pcf));
      const double share = double(a.agreed) / a.compared;
      RecordProperty("agreement", std::to_string(share));
      std::printf("%-20s pcf %d: %.3f %% of %d pixels (%d lit, %d shadowed), %d near edges\n",
                  c.name, pcf, share * 100, a.compared, a.lit, a.shadowed, a.edge);
      EXPECT_GE(share, 0.99) << c.name << " pcf " << pcf;
      EXPECT_GT(a.lit, 1000) << "the case shows light";
      EXPECT_GT(a.shadowed, 1000) << "the case shows shadow";
    }
}

// Walls and a roof about as thick as a texel, open to one side.
View thin_room_view() {
  constexpr float t = 0.02f;
  View v;
  add_quad(v.scene, {{-6, 0, 6}, {6, 0, 6}, {6, 0, -6}, {-6, 0, -6}}, 8);
  add_box(v.scene, {2, 0, -2}, {2 + t, 2.4f, 2});
  add_box(v.scene, {-2 - t, 0, -2}, {-2, 2.4f, 2});
  add_box(v.scene, {-2 - t, 0, -2 - t}, {2 + t, 2.4f, -2});
  add_box(v.scene, {-2 - t, 2.4f, -2 - t}, {2 + t, 2.4f + t, 2});
  add_box(v.scene, {-0.4f, 0.7f, -1}, {0.6f, 0.7f + t, 0.2f});
  v.camera.eye = {-1.2, 1.5, 1.9};
  v.camera.target = {1.2, 0.6, -1.2};
  v.camera.near_plane = 0.05;
  v.camera.far_plane = 40;
  return v;
}

TEST(Oracle, WallsAsThinAsATexelKeepTheSunOut) {
  const View view = thin_room_view();
  for (const Vec3d& light : {Vec3d{0.05, 1, 0.03}, Vec3d{1, 0.7, 0.15}, Vec3d{1, 0.3, -0.4}})
    for (int pcf : {1, 3}) {
      const Agreement a = compare(view, light, classic_visibility(pcf));
      EXPECT_LT(double(a.leaked) / a.all, 1e-4) << light.x << " " << light.y << " pcf " << pcf;
    }
}

TEST(Oracle, PlanesOfAnyLeanDoNotShadowThemselves) {
  for (double turn : {0.0, 0.4, 0.785398, 1.3})
    for (double height : {0.1, 0.3, 1.0, 4.0})
      for (int pcf : {1, 3, 5}) {
        View view;
        add_quad(view.scene, {{-1, 0, 1}, {1, 0, 1}, {1, 0, -1}, {-1, 0, -1}});
        view.camera.eye = {0, 1, 0.01};
        view.camera.fov_degrees = 80;
        RenderOptions o = classic_visibility(pcf);
        o.map_resolution = 256;
        o.up = {0.3, 0.1, 1};  // so that the map's axes are oblique
        Renderer renderer = must_render(view.scene, o);
        ASSERT_TRUE(
            renderer.draw(view.camera, still({std::cos(turn), height, std::sin(turn)})).ok());
        const Image8 image = renderer.read_image();
        const auto darkest = *std::min_element(image.texels.begin(), image.texels.end());
        EXPECT_GE(darkest, 254) << "turned " << turn << ", height " << height << ", pcf " << pcf;
      }
}

// The second pass must reconstruct every point of the floor from its depth, half a metre below the
// eye and at the horizon.
TEST(Oracle, AFloorIsLitFromTheFeetToTheHorizon) {
  View view;
  add_quad(view.scene, {{-1000, 0, 1000}, {1000, 0, 1000}, {1000, 0, -1000}, {-1000, 0, -1000}});
  view.camera.eye = {3, 0.5, 900};
  view.camera.target = {0, 0, 899};
  view.camera.fov_degrees = 110;
  fit_planes(view.camera, {{-1000, 0, -1000}, {1000, 0, 1000}});
  EXPECT_LT(view.camera.near_plane, 0.25);
  for (const Vec3d& light : {Vec3d{0.3, 1, 0.2}, Vec3d{1, 0.3, 0.5}, Vec3d{0.4, 0.1, -1}}) {
    RenderOptions o = classic_visibility(3);
    o.map_resolution = 2048;
    Renderer renderer = must_render(view.scene, o);
    ASSERT_TRUE(renderer.draw(view.camera, still(light)).ok());
    const Image8 image = renderer.read_image();
    EXPECT_GE(*std::min_element(image.texels.begin(), image.texels.end()), 254) << light.y;
    RenderOptions colours = o;
    colours.show_visibility = false;
    colours.background = {1, 0, 0};
    ASSERT_TRUE(renderer.set_options(colours).ok());
    ASSERT_TRUE(renderer.draw(view.camera, still(light)).ok());
    const Image8 shown = renderer.read_image();
    const std::uint8_t* feet = shown.at(shown.width / 2, 0);
    EXPECT_EQ(feet[0], feet[1]) << "the floor is there, not the background";
  }
}

}  // namespace
}  // namespace atlas::testing
