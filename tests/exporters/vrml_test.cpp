#include <gtest/gtest.h>
#include <zlib.h>

#include <glm/gtc/quaternion.hpp>
#include <memory>
#include <set>

#include "libatlas/core/glm_bridge.h"
#include "libatlas/scene/reader.h"
#include "tests/exporters/vrml_parser.h"
#include "tests/exporters/worlds.h"
#include "tests/support/temp_folder.h"

namespace atlas {
namespace {

using test::parse_vrml;
using test::TempFolder;
using test::vrml_number;
using test::VrmlNode;
using test::wavy_world;

std::string written_vrml(const World& world, const std::filesystem::path& path) {
  AtomicFiles files;
  const auto result = write_vrml(world, path, files, {});
  EXPECT_TRUE(result.ok()) << result.status().message();
  EXPECT_TRUE(files.commit().ok());
  return TempFolder::read(path);
}

std::vector<double> numbers(const std::vector<std::string>& tokens) {
  std::vector<double> result;
  for (const std::string& token : tokens) result.push_back(vrml_number(token));
  return result;
}

using Nodes = std::vector<std::shared_ptr<VrmlNode>>;

std::vector<const VrmlNode*> of_type(const Nodes& nodes, const std::string& type) {
  std::vector<const VrmlNode*> result;
  for (const auto& node : nodes) {
    if (node->type == type) result.push_back(node.get());
  }
  return result;
}

// Expects three indices in range and a -1 for each triangle, and returns the indices.
std::vector<int> triangle_list(const VrmlNode& faces, const std::string& field, std::size_t limit) {
  std::vector<int> corners;
  const auto list = numbers(faces.field(field));
  EXPECT_EQ(list.size() % 4, 0u);
  for (std::size_t i = 0; i < list.size(); ++i) {
    if (i % 4 == 3) {
      EXPECT_EQ(list[i], -1);
      continue;
    }
    EXPECT_GE(list[i], 0);
    EXPECT_LT(list[i], double(limit));
    corners.push_back(int(list[i]));
  }
  return corners;
}

void expect_shape(const VrmlNode& shape, const World& world, std::size_t number) {
  const Page& page = world.pages[number];
  EXPECT_FALSE(shape.child("appearance").has("material"));
  const VrmlNode& texture = shape.child("appearance").child("texture");
  EXPECT_EQ(texture.type, "ImageTexture");
  EXPECT_EQ(texture.field("url"), std::vector<std::string>{'"' + page.image + '"'});
  EXPECT_EQ(texture.field("repeatS"), std::vector<std::string>{"FALSE"});
  EXPECT_EQ(texture.field("repeatT"), std::vector<std::string>{"FALSE"});
  const VrmlNode& faces = shape.child("geometry");
  EXPECT_EQ(faces.type, "IndexedFaceSet");
  EXPECT_EQ(faces.field("solid"), std::vector<std::string>{"FALSE"});
  const auto points = numbers(faces.child("coord").field("point"));
  const auto uvs = numbers(faces.child("texCoord").field("point"));
  const auto corners = triangle_list(faces, "coordIndex", points.size() / 3);
  const auto uv_corners = triangle_list(faces, "texCoordIndex", uvs.size() / 2);
  ASSERT_EQ(corners.size(), page.indices.size());
  ASSERT_EQ(uv_corners.size(), page.indices.size());
  for (std::size_t k = 0; k < corners.size(); ++k) {
    const Vec3f& p = world.positions[page.indices[k]];
    const double* q = &points[3 * corners[k]];
    const double origin[3] = {world.origin.x, world.origin.y, world.origin.z};
    const float offset[3] = {p.x, p.y, p.z};
    for (int i = 0; i < 3; ++i) {  // without an origin along an axis, floats are kept
      if (origin[i] == 0) {
        ASSERT_EQ(float(q[i]), offset[i]);
      } else {
        ASSERT_EQ(q[i], origin[i] + double(offset[i]));
      }
    }
    const double* t = &uvs[2 * uv_corners[k]];
    ASSERT_EQ((Vec2f{float(t[0]), float(t[1])}), world.uvs[page.uv_indices[k]]);
  }
  // Only what is used is written, each value once.
  EXPECT_EQ(std::set<int>(corners.begin(), corners.end()).size(), points.size() / 3);
  EXPECT_EQ(std::set<int>(uv_corners.begin(), uv_corners.end()).size(), uvs.size() / 2);
}

TEST(Vrml, ReadsBackExactly) {
  const TempFolder folder;
  for (const bool far : {false, true}) {
    World world = wavy_world(40, 3);
    if (far) world.origin = {1048576, -65536, 0};
    const Nodes nodes = parse_vrml(written_vrml(world, folder / "w.wrl"));
    const auto shapes = of_type(nodes, "Shape");
    ASSERT_EQ(shapes.size(), 3u);
    for (std::size_t i = 0; i < shapes.size(); ++i) expect_shape(*shapes[i], world, i);
  }
  EXPECT_EQ(folder.count(), 1u);  // no temporary file is left
}

// Viewers use floats, which would tear apart a room in national grid coordinates.
TEST(Vrml, AnOriginTooFarForFloatsIsNotedAndNotAdded) {
  const TempFolder folder;
  World world = wavy_world(40, 2);
  const Vec3d origin = world.origin = {4468000.5, 5332000, -520};
  for (Vec3f& p : world.positions) p = {p.x / 100, p.y / 100, p.z / 1e4f};
  world.viewpoint.position = {1, 2, 3};
  AtomicFiles files;
  const auto written = write_vrml(world, folder / "w.wrl", files, {});
  ASSERT_TRUE(written.ok() && files.commit().ok());
  EXPECT_EQ(written->origin_left_out, origin);
  const Nodes nodes = parse_vrml(TempFolder::read(folder / "w.wrl"));
  EXPECT_EQ(of_type(nodes, "WorldInfo")[0]->field("info").back(),
            "\"origin 4468000.5 5332000 -520: to be added to every coordinate\"");
  const VrmlNode& view = of_type(nodes, "Transform").at(0)->child("children");
  EXPECT_EQ(numbers(view.field("position")), (std::vector<double>{1, 2, 3}));
  const auto shapes = of_type(nodes, "Shape");
  world.origin = {};
  for (std::size_t i = 0; i < shapes.size(); ++i) expect_shape(*shapes[i], world, i);

  const auto loaded = read_scene(folder / "w.wrl", {}, {});
  ASSERT_TRUE(loaded.ok()) << loaded.status().message();
  const Scene& s = loaded->scene;
  std::size_t k = 0;
  for (const Page& page : world.pages) {
    for (const std::uint32_t i : page.indices) {
      const Vec3f &p = s.positions[s.indices[k++]], &q = world.positions[i];
      ASSERT_NEAR(s.origin.x + p.x, origin.x + q.x, 1e-6);
      ASSERT_NEAR(s.origin.y + p.y, origin.y + q.y, 1e-6);
      ASSERT_NEAR(s.origin.z + p.z, origin.z + q.z, 1e-6);
    }
  }
  EXPECT_EQ(k, s.indices.size());
}

// The limit is 128 times the diagonal of the world's box.
TEST(Vrml, OriginsWithinTheLimitAreAdded) {
  const TempFolder folder;
  World world = wavy_world(4, 1);
  for (Vec3f& p : world.positions) p = {};
  world.positions[1] = {3, 4, 0};
  for (const bool far : {false, true}) {
    world.origin = {0, far ? 641.0 : 639.0, 0};  // 128 * 5 is 640
    AtomicFiles files;
    const auto written = write_vrml(world, folder / "w.wrl", files, {});
    ASSERT_TRUE(written.ok());
    EXPECT_EQ(written->origin_left_out, far ? world.origin : Vec3d{});
  }
}

TEST(Vrml, InfoAndNavigation) {
  const TempFolder folder;
  World world = wavy_world(4, 1);
  world.metres_per_unit = 0.01;
  world.viewpoint.inside = true;
  const Nodes nodes = parse_vrml(written_vrml(world, folder / "w.wrl"));
  const auto info = of_type(nodes, "WorldInfo");
  ASSERT_EQ(info.size(), 1u);
  EXPECT_EQ(info[0]->field("title"), std::vector<std::string>{R"("a \"wavy\" \\ sheet")"});
  EXPECT_EQ(info[0]->field("info").size(), 2u);
  const auto navigation = of_type(nodes, "NavigationInfo");
  ASSERT_EQ(navigation.size(), 1u);
  EXPECT_EQ(navigation[0]->field("headlight"), std::vector<std::string>{"FALSE"});
  EXPECT_EQ(navigation[0]->field("type")[0], "\"WALK\"");
  world.viewpoint.inside = false;
  world.viewpoint.fov = 0.5;
  world.up = Up::z;
  world.title = "~";
  const Nodes outside = parse_vrml(written_vrml(world, folder / "o.wrl"));
  EXPECT_EQ(of_type(outside, "NavigationInfo")[0]->field("type")[0], "\"EXAMINE\"");
  EXPECT_EQ(of_type(outside, "WorldInfo")[0]->field("title")[0], "\"~\"");
  EXPECT_EQ(of_type(outside, "WorldInfo")[0]->field("info").back(),
            '"' + std::string(kZUpNote) + '"');
  const VrmlNode& view = of_type(outside, "Transform").at(0)->child("children");
  EXPECT_EQ(numbers(view.field("fieldOfView")), std::vector<double>{0.5});
}

// In units of an atom or a galaxy, the avatar's lengths were once written as "inf" and 0, which no
// viewer reads.
TEST(Vrml, AvatarsStayFloatsInAnyUnit) {
  const TempFolder folder;
  World world = wavy_world(4, 1);
  for (const double unit : {1e-300, 1e-40, 1e45, 1e300}) {
    world.metres_per_unit = unit;
    const Nodes nodes = parse_vrml(written_vrml(world, folder / "w.wrl"));
    const auto navigation = of_type(nodes, "NavigationInfo");
    ASSERT_EQ(navigation.size(), 1u);
    for (const double v : numbers(navigation[0]->field("avatarSize"))) {
      EXPECT_TRUE(std::isfinite(v) && v > 0) << unit << " " << v;
    }
  }
}

glm::dmat3 rotation_of(const std::vector<double>& r) {
  return glm::mat3_cast(glm::angleAxis(r[3], glm::normalize(glm::dvec3(r[0], r[1], r[2]))));
}

// Follows the nodes as a viewer does, and checks where the camera ends up.
TEST(Vrml, ViewpointLooksWhereItShould) {
  const TempFolder folder;
  const glm::dvec3 directions[] = {{0, 0, -1},     {0, 0, 1},      {1, 0, 0},
                                   {-1, 0.3, 0.2}, {0.1, -0.9, 1}, {0, 0.5, 1}};
  for (const Up up : {Up::y, Up::z}) {
    for (glm::dvec3 d : directions) {
      World world = wavy_world(3, 1);
      if (up == Up::z) d = {d.x, -d.z, d.y};
      world.up = up;
      world.origin = {100, 0, 0};
      world.viewpoint.position = {1, 2, 3};
      world.viewpoint.direction = from_glm(d);
      const Nodes nodes = parse_vrml(written_vrml(world, folder / "v.wrl"));
      const VrmlNode& transform = *of_type(nodes, "Transform").at(0);
      const VrmlNode& view = transform.child("children");
      glm::dmat3 outer(1);
      if (transform.has("rotation")) outer = rotation_of(numbers(transform.field("rotation")));
      const glm::dmat3 camera = outer * rotation_of(numbers(view.field("orientation")));
      const auto p = numbers(view.field("position"));
      EXPECT_LT(glm::distance(outer * glm::dvec3(p[0], p[1], p[2]), glm::dvec3(101, 2, 3)), 1e-4);
      EXPECT_LT(glm::distance(camera * glm::dvec3(0, 0, -1), glm::normalize(d)), 1e-5);
      const glm::dvec3 up_axis = up == Up::z ? glm::dvec3(0, 0, 1) : glm::dvec3(0, 1, 0);
      EXPECT_LT(glm::distance(outer * glm::dvec3(0, 1, 0), up_axis), 1e-6);
      EXPECT_NEAR(glm::dot(camera * glm::dvec3(1, 0, 0), up_axis), 0, 1e-6) << "the view is tilted";
      EXPECT_GT(glm::dot(camera * glm::dvec3(0, 1, 0), up_axis), 0) << "upside down";
    }
  }
}

TEST(Vrml, NamesAreEncodedAndPagesMayBeEmptyOrBare) {
  const TempFolder folder;
  World world = wavy_world(6, 2);
  world.pages[0].image = "my:caf\xc3\xa9 #1.png";
  world.pages[1].image.clear();
  world.pages.push_back({"empty.png", {}, {}, {}});
  const Nodes nodes = parse_vrml(written_vrml(world, folder / "n.wrl"));
  const auto shapes = of_type(nodes, "Shape");
  ASSERT_EQ(shapes.size(), 2u);
  EXPECT_EQ(shapes[0]->child("appearance").child("texture").field("url")[0],
            "\"my%3Acaf%C3%A9%20%231.png\"");
  EXPECT_FALSE(shapes[1]->child("appearance").has("texture"));
  const std::string safe = safe_file_name("my caf\xc3\xa9 #1");
  EXPECT_EQ(safe.substr(0, 12), "my_caf____1-");
  EXPECT_NE(safe, safe_file_name("my caf\xc3\xa8 #1"));
  EXPECT_EQ(safe_file_name("world-2_b.v3"), "world-2_b.v3");
  EXPECT_EQ(safe_file_name(".hidden")[0], '_');
}

TEST(Vrml, AWorldWithoutLightIsLitByTheViewer) {
  const TempFolder folder;
  World world = wavy_world(6, 2);
  for (Page& page : world.pages) page.image.clear();
  const Nodes nodes = parse_vrml(written_vrml(world, folder / "n.wrl"));
  EXPECT_EQ(of_type(nodes, "NavigationInfo")[0]->field("headlight"),
            std::vector<std::string>{"TRUE"});
  for (const VrmlNode* shape : of_type(nodes, "Shape")) {
    EXPECT_EQ(shape->child("appearance").child("material").type, "Material");
    EXPECT_TRUE(shape->child("geometry").has("creaseAngle"));
  }
}

// Viewers cull the back faces of a face set that is solid.
TEST(Vrml, OneSidedTrianglesAreASolidShape) {
  const TempFolder folder;
  World world = wavy_world(6, 2);
  const std::string plain = written_vrml(world, folder / "w.wrl");
  const std::size_t triangles = world.pages[1].indices.size() / 3;
  world.pages[1].one_sided.assign(triangles, false);
  EXPECT_EQ(written_vrml(world, folder / "w.wrl"), plain);

  std::vector<std::uint32_t>
      corners[2];  // of the triangles seen from both sides, and of the others
  for (std::size_t t = 0; t < triangles; ++t) {
    world.pages[1].one_sided[t] = t % 3 == 1;
    for (std::size_t k = 3 * t; k < 3 * t + 3; ++k)
      corners[t % 3 == 1].push_back(world.pages[1].indices[k]);
  }
  const Nodes nodes = parse_vrml(written_vrml(world, folder / "w.wrl"));
  const auto shapes = of_type(nodes, "Shape");
  ASSERT_EQ(shapes.size(), 3u);
  expect_shape(*shapes[0], world, 0);
  for (const int one_sided : {0, 1}) {
    const VrmlNode& shape = *shapes[1 + std::size_t(one_sided)];
    const VrmlNode& faces = shape.child("geometry");
    EXPECT_EQ(shape.child("appearance").child("texture").field("url")[0],
              '"' + world.pages[1].image + '"');
    EXPECT_EQ(faces.field("solid")[0], one_sided ? "TRUE" : "FALSE");
    EXPECT_FALSE(faces.has("ccw"));  // counter-clockwise, by default
    const auto points = numbers(faces.child("coord").field("point"));
    const auto list = triangle_list(faces, "coordIndex", points.size() / 3);
    ASSERT_EQ(list.size(), corners[one_sided].size());
    for (std::size_t k = 0; k < list.size(); ++k) {
      const Vec3f& p = world.positions[corners[one_sided][k]];
      const double* q = &points[3 * std::size_t(list[k])];
      ASSERT_EQ((Vec3f{float(q[0]), float(q[1]), float(q[2])}), p);
    }
  }
  world.pages[1].one_sided.assign(triangles, true);
  const Nodes solid = parse_vrml(written_vrml(world, folder / "w.wrl"));
  ASSERT_EQ(of_type(solid, "Shape").size(), 2u);
  EXPECT_EQ(of_type(solid, "Shape")[1]->child("geometry").field("solid")[0], "TRUE");
}

TEST(Vrml, GzipHoldsTheSameText) {
  const TempFolder folder;
  const World world = wavy_world(50, 2);
  const std::string plain = written_vrml(world, folder / "w.wrl");
  const std::string zipped = written_vrml(world, folder / "w.wrz");
  EXPECT_LT(zipped.size(), plain.size());
  EXPECT_EQ(zipped.substr(0, 2), "\x1f\x8b");
  gzFile file = gzopen((folder / "w.wrz").c_str(), "rb");
  std::string text(plain.size() + 1, '\0');
  const int size = gzread(file, text.data(), unsigned(text.size()));
  gzclose(file);
  ASSERT_EQ(size, int(plain.size()));
  text.resize(plain.size());
  EXPECT_EQ(text, plain);
}

TEST(Vrml, ThreadsDoNotChangeABit) {
  const TempFolder folder;
  const World world = wavy_world(250, 2);
  std::string first;
  for (const int threads : {1, 2, 5}) {
    Context context;
    context.threads = threads;
    AtomicFiles files;
    ASSERT_TRUE(write_vrml(world, folder / "t.wrl", files, context).ok());
    ASSERT_TRUE(files.commit().ok());
    const std::string text = TempFolder::read(folder / "t.wrl");
    if (first.empty()) first = text;
    EXPECT_TRUE(text == first);
  }
}

TEST(Vrml, FailuresLeaveNothingBehind) {
  const TempFolder folder;
  const auto status = [&](const World& world, const std::filesystem::path& path,
                          const Context& context) {
    AtomicFiles files;
    return write_vrml(world, path, files, context).status();
  };
  World bad = wavy_world(5, 1);
  bad.positions[3].x = NAN;
  EXPECT_EQ(status(bad, folder / "a.wrl", {}).code(), ErrorCode::bad_input);
  bad = wavy_world(5, 1);
  bad.origin.x = 3.4e38;
  bad.positions[1].x = 3.4e38f;
  EXPECT_EQ(status(bad, folder / "a.wrl", {}).code(), ErrorCode::bad_input);
  bad = wavy_world(5, 1);
  bad.pages[0].uv_indices[2] = 1000000;
  EXPECT_EQ(status(bad, folder / "a.wrl", {}).code(), ErrorCode::bad_input);
  bad = wavy_world(5, 1);
  bad.pages[0].indices.pop_back();
  EXPECT_EQ(status(bad, folder / "a.wrl", {}).code(), ErrorCode::bad_input);
  bad = wavy_world(5, 1);
  bad.pages[0].uv_indices.resize(3);
  EXPECT_EQ(status(bad, folder / "a.wrl", {}).code(), ErrorCode::bad_input);
  bad = wavy_world(5, 1);
  bad.uvs[7].y = INFINITY;
  EXPECT_NE(status(bad, folder / "a.wrl", {}).message().find("texture coordinate 7"),
            std::string::npos);
  for (const double fov : {0.0, -1.0, 3.2, double(NAN)}) {
    bad = wavy_world(5, 1);
    bad.viewpoint.fov = fov;
    EXPECT_EQ(status(bad, folder / "a.wrl", {}).code(), ErrorCode::bad_input) << fov;
  }
  for (const Vec3d direction : {Vec3d{}, Vec3d{NAN, 0, 0}}) {
    bad = wavy_world(5, 1);
    bad.viewpoint.direction = direction;
    EXPECT_EQ(status(bad, folder / "a.wrl", {}).code(), ErrorCode::bad_input);
  }
  const World good = wavy_world(5, 1);
  const Status io = status(good, folder / "no/such/folder/a.wrl", {});
  EXPECT_EQ(io.code(), ErrorCode::io);
  EXPECT_NE(io.message().find("a.wrl"), std::string::npos);
  EXPECT_EQ(io.message().find(".part"), std::string::npos) << "names the temporary file";
  EXPECT_EQ(status(good, "/dev/full/a.wrl", {}).code(), ErrorCode::io);
  const std::atomic<bool> raised{true};
  Context context;
  context.cancel = &raised;
  EXPECT_EQ(status(good, folder / "a.wrl", context).code(), ErrorCode::cancelled);
  EXPECT_EQ(folder.count(), 0u);
}

}  // namespace
}  // namespace atlas
