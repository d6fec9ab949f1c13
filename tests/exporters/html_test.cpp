// Pages of HTML, read by an oracle of their own (html_page.h).
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <regex>

#include "libatlas/core/luma.h"
#include "libatlas/exporters/html/light_page.h"
#include "libatlas/scene/scene.h"
#include "tests/exporters/worlds.h"
#include "tests/support/html_page.h"
#include "tests/support/temp_folder.h"

namespace atlas {
namespace {

using test::HtmlPage;
using test::TempFolder;

// The images of wavy_world(), which the writer embeds as they are.
World with_images(const TempFolder& folder, World world) {
  for (Page& page : world.pages)
    page.image_source = folder.write(page.image, "the bytes of " + page.image + '\0' + "\xff");
  return world;
}

Result<WorldFile> write_page(const World& world, const std::filesystem::path& path) {
  AtomicFiles files;
  auto written = write_html(world, path, files, {});
  if (written.ok()) {
    EXPECT_TRUE(files.commit().ok());
  }
  return written;
}

// What the page should say of a corner.
void expect_corner(const World& world, const HtmlPage::Corner& corner, std::uint32_t position,
                   std::uint32_t uv, double step) {
  const Vec3f& p = world.positions[position];
  const double m = world.metres_per_unit;
  const double want[3] = {m * p.x, m * (world.up == Up::z ? p.z : p.y),
                          m * (world.up == Up::z ? -p.y : p.z)};
  for (std::size_t k = 0; k < 3; ++k) EXPECT_NEAR(corner.position[k], want[k], 0.5001 * step);
  EXPECT_NEAR(corner.uv[0], world.uvs[uv].x, 0.5001 / 65535);
  EXPECT_NEAR(corner.uv[1], world.uvs[uv].y, 0.5001 / 65535);
}

TEST(Html, HoldsEveryTriangleWithinItsStep) {
  const TempFolder folder;
  for (const Up up : {Up::y, Up::z}) {
    World world = with_images(folder, test::wavy_world(40, 3));
    world.up = up;
    world.metres_per_unit = 0.25;
    const auto written = write_page(world, folder / "w.html");
    ASSERT_TRUE(written.ok()) << written.status().message();
    const HtmlPage page(TempFolder::read(folder / "w.html"));
    EXPECT_EQ(std::int64_t(page.text().size()), written->bytes);
    ASSERT_EQ(page.parts.size(), 3u);
    std::size_t triangles = 0;
    for (std::size_t i = 0; i < 3; ++i) {
      const Page& from = world.pages[i];
      EXPECT_EQ(page.parts[i].page, i);
      ASSERT_EQ(page.parts[i].triangles.size(), from.indices.size() / 3);
      triangles += page.parts[i].triangles.size();
      for (std::size_t k = 0; k < from.indices.size(); ++k) {
        expect_corner(world, page.parts[i].triangles[k / 3][k % 3], from.indices[k],
                      from.uv_indices[k], page.world["mesh"]["step"]);
      }
      const std::string image = TempFolder::read(from.image_source);
      EXPECT_EQ(page.data("page" + std::to_string(i)), image);
    }
    EXPECT_EQ(triangles, written->triangles);
  }
}

// From inside, a 65535th of a long box would be seen.
TEST(Html, InsideTheStepIsA64thOfAMillimetre) {
  const TempFolder folder;
  World world = with_images(folder, test::wavy_world(10, 1));  // 20 km long
  const auto step = [&] {
    EXPECT_TRUE(write_page(world, folder / "w.html").ok());
    return HtmlPage(TempFolder::read(folder / "w.html")).world["mesh"]["step"].get<double>();
  };
  EXPECT_GT(step(), 0.1);
  world.viewpoint.inside = true;
  EXPECT_LT(step(), 0.002);  // what 24 bits hold
  world.metres_per_unit = 4e-3;
  EXPECT_DOUBLE_EQ(step(), 1.0 / 65536);
}

TEST(Html, SidesArePartsOfTheirOwn) {
  const TempFolder folder;
  World world = with_images(folder, test::wavy_world(3, 1));
  Page& page = world.pages[0];
  page.one_sided = {false, true, false, false, true, false, false, false};
  page.charts = {0, 1, 2, 3, 4, 5, 6, 7};
  for (std::size_t k = 0; k < page.uv_indices.size(); ++k) {
    world.uvs.push_back(world.uvs[page.uv_indices[k]]);
    page.uv_indices[k] = std::uint32_t(world.uvs.size() - 1);  // charts share no uv
  }
  ASSERT_TRUE(write_page(world, folder / "w.html").ok());
  const HtmlPage read(TempFolder::read(folder / "w.html"));
  ASSERT_EQ(read.parts.size(), 2u);
  const auto charts = [](const HtmlPage::Part& part) {
    std::vector<std::uint32_t> result;
    for (const auto& t : part.triangles) {
      EXPECT_TRUE(t[0].chart == t[1].chart && t[1].chart == t[2].chart);
      result.push_back(t[0].chart);
    }
    return result;
  };
  EXPECT_FALSE(read.parts[0].one_sided);
  EXPECT_EQ(charts(read.parts[0]), (std::vector<std::uint32_t>{0, 2, 3, 5, 6, 7}));
  EXPECT_TRUE(read.parts[1].one_sided);
  EXPECT_EQ(charts(read.parts[1]), (std::vector<std::uint32_t>{1, 4}));
}

// Nothing is loaded, and no text of the world becomes markup.
TEST(Html, IsOneFileThatLoadsNothing) {
  const TempFolder folder;
  World world = with_images(folder, test::wavy_world(3, 1));
  world.title = "a <b>bold</b> & \"quoted\" title";
  world.info = {"</script><script>alert(1)</script>", "not UTF-8: \xff"};
  ASSERT_TRUE(write_page(world, folder / "w.html").ok());
  const HtmlPage page(TempFolder::read(folder / "w.html"));
  EXPECT_NE(page.text().find("<title>a &lt;b>bold&lt;/b> &amp; \"quoted\" title</title>"),
            std::string::npos);
  EXPECT_EQ(page.world["title"], world.title);
  EXPECT_EQ(page.world["info"][0], world.info[0]);
  EXPECT_EQ(page.text().find("<script>alert"), std::string::npos);
  EXPECT_EQ(page.text().find("://"), std::string::npos);
  const std::regex reference(R"(\b(src|href)\s*=\s*"([^"]*)\")");
  for (std::sregex_iterator at(page.text().begin(), page.text().end(), reference), end; at != end;
       ++at)
    EXPECT_EQ((*at)[2].str().substr(0, 5), "data:");
}

TEST(Html, RefusesWhatItCannotShow) {
  const TempFolder folder;
  const auto refusal = [&](const World& world) {
    const auto written = write_page(world, folder / "w.html");
    EXPECT_FALSE(std::filesystem::exists(folder / "w.html"));
    return written.ok() ? std::string("written") : written.status().message();
  };
  const World world = with_images(folder, test::wavy_world(3, 1));
  World wrong = world;
  wrong.pages[0].charts = {1, 2};
  EXPECT_NE(refusal(wrong).find("2 values charts for 8 triangles"), std::string::npos);
  wrong = world;
  wrong.pages[0].error = {0, 0, 0};
  wrong.pages[0].error_columns = 2;
  EXPECT_NE(refusal(wrong).find("3 cells of its error in rows of 2"), std::string::npos);
  wrong = world;
  wrong.light.emplace();
  EXPECT_NE(refusal(wrong).find("no curve"), std::string::npos);
  wrong = world;
  wrong.pages[0].image_source = folder / "nowhere.png";
  EXPECT_NE(refusal(wrong).find("nowhere.png"), std::string::npos);
  wrong = world;
  wrong.pages[0].indices.clear();
  wrong.pages[0].uv_indices.clear();
  EXPECT_NE(refusal(wrong).find("at least one triangle"), std::string::npos);
  Scene scene;
  scene.positions = world.positions;
  scene.indices = world.pages[0].indices;
  scene.triangle_material.assign(scene.triangle_count(), 0);
  scene.materials.resize(1);
  wrong = world;
  wrong.pages[0].image.clear();
  wrong.scene = &scene;
  EXPECT_NE(refusal(wrong).find("cannot keep a scene"), std::string::npos);
}

// Takes back what light_page.h describes.
std::vector<float> decoded(const std::vector<std::uint8_t>& bytes, int width, int height) {
  std::uint32_t head[2];
  float top;
  std::memcpy(head, bytes.data(), 8);
  std::memcpy(&top, bytes.data() + 8, 4);
  EXPECT_EQ(head[0], std::uint32_t(width));
  EXPECT_EQ(head[1], std::uint32_t(height));
  const auto count = std::size_t(width) * std::size_t(height);
  EXPECT_EQ(bytes.size(), 12 + 4 * count);
  const auto plane = [&](std::size_t p, std::size_t i) { return int(bytes[12 + p * count + i]); };
  const auto restore = [&](auto difference, int modulus) {
    std::vector<int> values(count);
    for (std::size_t i = 0; i < count; ++i) {
      const bool left = i % std::size_t(width) != 0, lower = i >= std::size_t(width);
      const int a = left ? values[i - 1] : 0, b = lower ? values[i - std::size_t(width)] : 0;
      const int c = left && lower ? values[i - std::size_t(width) - 1] : 0, p = a + b - c;
      const int nearest = std::min({std::abs(p - a), std::abs(p - b), std::abs(p - c)});
      const int guess = std::abs(p - a) == nearest ? a : std::abs(p - b) == nearest ? b : c;
      values[i] = ((guess + difference(i)) % modulus + modulus) % modulus;
    }
    return values;
  };
  const auto codes = restore(
      [&](std::size_t i) {
        const int folded = plane(0, i) + 256 * plane(1, i);
        return folded % 2 == 0 ? folded / 2 : -(folded / 2) - 1;
      },
      65536);
  const auto red = restore([&](std::size_t i) { return plane(2, i); }, 256);
  const auto blue = restore([&](std::size_t i) { return plane(3, i); }, 256);
  std::vector<float> rgb(3 * count, 0);
  for (std::size_t i = 0; i < count; ++i) {
    if (codes[i] == 0) continue;
    const double y = std::exp2(top + (codes[i] - 65535) / 256.0);
    const double r = red[i] / 255.0, b = blue[i] / 255.0, g = std::max(0.0, 1 - r - b);
    const double sum = y / (0.2126 * r + 0.7152 * g + 0.0722 * b);
    rgb[3 * i] = float(r * sum);
    rgb[3 * i + 1] = float(g * sum);
    rgb[3 * i + 2] = float(b * sum);
  }
  return rgb;
}

TEST(Html, PagesOfLightKeepFortyOctaves) {
  const TempFolder folder;
  constexpr int kWidth = 61, kHeight = 47;
  ImageF light(kWidth, kHeight, 3);
  std::mt19937 random(3);
  std::uniform_real_distribution<float> octave(-20, 20), share(0, 1);
  for (std::size_t i = 0; i < light.texels.size(); i += 3) {
    const float scale = std::exp2(octave(random));
    for (std::size_t k = 0; k < 3; ++k) light.texels[i + k] = scale * share(random);
  }
  for (std::size_t k = 0; k < 3; ++k) light.texels[300 + k] = 0;
  light.texels[0] = -1;  // counts as 0
  ASSERT_TRUE(write_light_page(folder / "p.light", light).ok());
  const auto rgb = decoded(test::unzipped(TempFolder::read(folder / "p.light")), kWidth, kHeight);
  for (std::size_t i = 0; i < rgb.size(); i += 3) {
    const float want[3] = {std::max(0.f, light.texels[i]), light.texels[i + 1],
                           light.texels[i + 2]};
    const float y = luma(want[0], want[1], want[2]), sum = want[0] + want[1] + want[2];
    EXPECT_NEAR(luma(rgb[i], rgb[i + 1], rgb[i + 2]), y, 0.0015f * y) << i / 3;
    // Shares are off by half a 255th, and the sum follows from the luma: most where blue prevails.
    for (std::size_t k = 0; k < 3; ++k) EXPECT_NEAR(rgb[i + k], want[k], 0.03f * sum) << i / 3;
  }
  EXPECT_EQ(rgb[300], 0);
}

}  // namespace
}  // namespace atlas
