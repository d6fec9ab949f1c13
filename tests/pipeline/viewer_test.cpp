// Compares what an independent viewer shows of an exported world with the original lit scene, pixel
// by pixel. A flipped texture, a wrong index or a wrong viewpoint loads without errors everywhere;
// only the pixels show it.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <glm/geometric.hpp>
#include <glm/vec3.hpp>
#include <regex>
#include <string>
#include <vector>

#include "examples/cabin/tracer.h"
#include "libatlas/exporters/viewpoint.h"
#include "libatlas/image/image_io.h"
#include "libatlas/pipeline/export_world.h"
#include "tests/pipeline/lit_scene.h"
#include "tests/support/temp_folder.h"

namespace atlas::test {
namespace {

namespace fs = std::filesystem;

constexpr int kWidth = 800, kHeight = 600;

bool installed(const char* program) {
  return std::system(fmt::format("command -v {} >/dev/null 2>&1", program).c_str()) == 0;
}

// view3dscene always exits with 0; its complaints are in its log.
std::string view(const fs::path& world, const fs::path& picture, const fs::path& home) {
  const std::string command = fmt::format(
      "HOME={0} XDG_CONFIG_HOME={0}/.config LIBGL_ALWAYS_SOFTWARE=1 timeout 100 xvfb-run -a -s "
      "'-screen 0 1280x960x24' view3dscene --no-sound -H --hide-menu --geometry {1}x{2} {3} "
      "--screenshot 0 {4} >{0}/out 2>&1",
      home.string(), kWidth, kHeight, world.string(), picture.string());
  if (std::system(command.c_str()) != 0) return "view3dscene did not end well";
  std::ifstream log(home / ".config/view3dscene/view3dscene.log");
  if (!log) return "view3dscene wrote no log";
  std::string line, warnings;
  // Start-up messages of the viewer about settings and folders, which do not concern the world.
  const std::regex own("ApplicationConfig|Config: |not be saved|^Rendering|^Path:");
  while (std::getline(log, line)) {
    if (line.starts_with("Warning") && !std::regex_search(line, own)) warnings += line + "\n";
  }
  return warnings;
}

float encode(float c) {
  c = std::min(std::max(c, 0.0f), 1.0f);
  return c <= 0.0031308f ? c * 12.92f : 1.055f * std::pow(c, 1 / 2.4f) - 0.055f;
}

// The scene's own light as a pinhole camera sees it, in display values. Row 0 is at the bottom.
class SceneView {
 public:
  SceneView(const Scene& scene, const Viewpoint& eye, double white)
      : scene_(scene),
        eye_(eye),
        white_(float(white)),
        tracer_(positions_of(scene), triangles_of(scene)) {}

  glm::vec3 pixel(int x, int y) const {
    const glm::vec3 forward =
        glm::normalize(glm::vec3(eye_.direction.x, eye_.direction.y, eye_.direction.z));
    const glm::vec3 right = glm::normalize(glm::cross(forward, glm::vec3(0, 0, 1)));
    const glm::vec3 up = glm::cross(right, forward);
    const float reach = float(std::tan(eye_.fov / 2)) / (0.5f * kHeight);  // of the smaller side
    const glm::vec3 direction = forward + reach * ((float(x) + 0.5f - 0.5f * kWidth) * right +
                                                   (float(y) + 0.5f - 0.5f * kHeight) * up);
    const glm::vec3 from(eye_.position.x, eye_.position.y, eye_.position.z);
    const cabin::Hit hit = tracer_.nearest(from, glm::normalize(direction));
    if (hit.triangle == ~0u) return glm::vec3(-1);
    glm::vec3 light(0);
    const float weight[3] = {1 - hit.u - hit.v, hit.u, hit.v};
    for (int k = 0; k < 3; ++k) {
      const Vec3f e = scene_.illumination[scene_.indices[3 * std::size_t(hit.triangle) + k]];
      light += weight[k] * glm::vec3(e.x, e.y, e.z);
    }
    const Vec3f kd = scene_.materials[0].diffuse;
    light *= glm::vec3(kd.x, kd.y, kd.z) / white_;
    return {encode(light.x), encode(light.y), encode(light.z)};
  }

 private:
  static std::vector<glm::vec3> positions_of(const Scene& scene) {
    std::vector<glm::vec3> positions;
    for (const Vec3f& p : scene.positions) positions.push_back({p.x, p.y, p.z});
    return positions;
  }
  static std::vector<std::array<std::uint32_t, 3>> triangles_of(const Scene& scene) {
    std::vector<std::array<std::uint32_t, 3>> triangles;
    for (std::size_t i = 0; i < scene.indices.size(); i += 3) {
      triangles.push_back({scene.indices[i], scene.indices[i + 1], scene.indices[i + 2]});
    }
    return triangles;
  }

  const Scene& scene_;
  Viewpoint eye_;
  float white_;
  cabin::Tracer tracer_;
};

// Returns the mean squared difference between picture and view over all channels, for every
// `step`th pixel.
double mean_square(const Image8& picture, const SceneView& scene, int step) {
  double sum = 0;
  std::size_t n = 0;
  for (int y = 0; y < kHeight; y += step) {
    for (int x = 0; x < kWidth; x += step) {
      const glm::vec3 expected = scene.pixel(x, y);
      if (expected.x < 0) continue;
      for (int k = 0; k < 3; ++k, ++n) {
        const double d = picture.at(x, y)[k] / 255.0 - double(expected[k]);
        sum += d * d;
      }
    }
  }
  return n > 0 ? sum / double(n) : 1;
}

Image8 upside_down(const Image8& image) {
  Image8 turned = image;
  for (int y = 0; y < image.height; ++y) {
    std::copy_n(image.at(0, image.height - 1 - y), image.width * image.channels, turned.at(0, y));
  }
  return turned;
}

TEST(Viewer, View3dsceneShowsTheLightOfTheScene) {
  for (const char* program : {"view3dscene", "xvfb-run"}) {
    if (!installed(program)) GTEST_SKIP() << program << " is not installed";
  }
  const TempFolder folder;
  const LoadedScene room = lit_room(24);
  ExportOptions options;
  options.target = folder / "room.wrl";
  options.atlases = 2;
  options.atlas_size = 1024;
  options.up = Up::z;
  const auto report = export_world(room, options, {}, {});
  ASSERT_TRUE(report.ok()) << report.status().message();
  EXPECT_EQ(view(options.target, folder / "shot.png", folder.path()), "");
  const auto picture = read_image8(folder / "shot.png");
  ASSERT_TRUE(picture.ok()) << picture.status().message();
  ASSERT_EQ(picture->width, kWidth);
  ASSERT_EQ(picture->height, kHeight);

  ViewpointOptions eye;
  eye.up = Up::z;
  const Viewpoint viewpoint = choose_viewpoint(room.scene.positions, room.scene.indices, eye, {});
  const SceneView scene(room.scene, viewpoint, report->exposure_white);
  const double psnr = -10 * std::log10(mean_square(*picture, scene, 3));
  EXPECT_GT(psnr, 48);
  // The measure must be sensitive: the flipped picture differs clearly from the scene.
  EXPECT_LT(-10 * std::log10(mean_square(upside_down(*picture), scene, 3)), 25);
}

}  // namespace
}  // namespace atlas::test
