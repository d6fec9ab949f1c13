// Tests where a visitor of an exported world starts.
#include "libatlas/exporters/viewpoint.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <fstream>
#include <iterator>
#include <numbers>
#include <string>
#include <vector>

#include "libatlas/scene/reader.h"
#include "tests/exporters/worlds.h"
#include "tests/support/boxes.h"
#include "tests/support/shared_data.h"
#include "tests/support/temp_folder.h"

namespace atlas {
namespace {

using test::add_box;
using test::TempFolder;
using test::Triangles;
using test::wavy_world;

TEST(ViewpointChoice, StandsInTheRoomAndLooksAlongIt) {
  for (const double metres : {1.0, 0.01, 1000.0}) {  // units of a metre, a centimetre, a kilometre
    Triangles room;
    add_box(room, {0, 0, 0}, {20, 6, 3}, true);
    add_box(room, {4, 1, 0}, {6, 3, 1}, false);  // a table
    for (Vec3f& p : room.positions) {
      const float s = float(1 / metres);
      p = {p.x * s, p.y * s, p.z * s};
    }
    for (const Up up : {Up::z, Up::y}) {
      std::vector<Vec3f> turned = room.positions;
      if (up == Up::y) {
        for (Vec3f& p : turned) p = {p.y, p.z, p.x};
      }
      ViewpointOptions options;
      options.up = up;
      options.metres_per_unit = metres;
      const Viewpoint view = choose_viewpoint(turned, room.indices, options, {});
      EXPECT_TRUE(view.inside);
      Vec3d p = view.position, d = view.direction;
      if (up == Up::y) p = {p.z, p.x, p.y}, d = {d.z, d.x, d.y};
      EXPECT_NEAR(p.z * metres, 1.6, 0.3);
      EXPECT_TRUE(p.x * metres > 0 && p.x * metres < 20 && p.y * metres > 0 && p.y * metres < 6);
      EXPECT_FALSE(p.x * metres > 4 && p.x * metres < 6 && p.y * metres > 1 && p.y * metres < 3);
      EXPECT_GT(std::abs(d.x), 0.8) << "should look along the room";
      EXPECT_EQ(d.z, 0);
      // Most of the room lies in front.
      EXPECT_GT(d.x > 0 ? 20 - p.x * metres : p.x * metres, 8);
    }
  }
}

TEST(ViewpointChoice, MovesWithTheScene) {
  Triangles room;
  add_box(room, {0, 0, 0}, {20, 6, 3}, true);
  add_box(room, {4, 1, 0}, {6, 3, 1}, false);
  const Viewpoint here = choose_viewpoint(room.positions, room.indices, {}, {});
  for (Vec3f& p : room.positions) p = {p.x - 512, p.y + 256, p.z + 64};
  const Viewpoint there = choose_viewpoint(room.positions, room.indices, {}, {});
  EXPECT_TRUE(there.inside);
  EXPECT_NEAR(there.position.x, here.position.x - 512, 1e-3);
  EXPECT_NEAR(there.position.y, here.position.y + 256, 1e-3);
  EXPECT_NEAR(there.position.z, here.position.z + 64, 1e-3);
  EXPECT_EQ(there.direction, here.direction);
}

TEST(ViewpointChoice, StaysOutOfSingleObjects) {
  Triangles box;
  add_box(box, {-1, -2, -3}, {1, 2, 3}, false);
  const Viewpoint view = choose_viewpoint(box.positions, box.indices, {}, {});
  EXPECT_FALSE(view.inside);
  const Vec3d &p = view.position, &d = view.direction;
  const double distance = std::sqrt(p.x * p.x + p.y * p.y + p.z * p.z);
  EXPECT_GT(distance, std::sqrt(14.0));
  EXPECT_NEAR((p.x * d.x + p.y * d.y + p.z * d.z) / distance, -1, 1e-6) << "looks at the centre";
}

// The narrow objects reach almost to the sphere around them, on both sides of the view.
TEST(ViewpointChoice, SeesAllOfAnObject) {
  for (const Vec3f reach : {Vec3f{9, 1, 1}, Vec3f{1, 9, 1}, Vec3f{1, 1, 9}, Vec3f{3, 3, 3}}) {
    Triangles box;
    add_box(box, {-reach.x, -reach.y, -reach.z}, reach, false);
    const Viewpoint view = choose_viewpoint(box.positions, box.indices, {}, {});
    const Vec3d &eye = view.position, &d = view.direction;
    for (const Vec3f& p : box.positions) {
      const double x = p.x - eye.x, y = p.y - eye.y, z = p.z - eye.z;
      const double length = std::hypot(x, y, z) * std::hypot(d.x, d.y, d.z);
      EXPECT_LE(std::acos((x * d.x + y * d.y + z * d.z) / length), view.fov / 2);
    }
  }
}

// Every room is small beside the building, and a partition faces both ways.
TEST(ViewpointChoice, StandsInARoomOfABuildingOfManyRooms) {
  for (const float half_partition : {0.0f, 0.0005f, 0.05f}) {
    Triangles office;
    for (int i = 0; i < 10; ++i)
      for (int j = 0; j < 6; ++j)
        add_box(office, {4.0f * i + half_partition, 5.0f * j + half_partition, 0},
                {4.0f * i + 4 - half_partition, 5.0f * j + 5 - half_partition, 2.8f}, true);
    ViewpointOptions options;
    options.up = Up::z;
    const Viewpoint view = choose_viewpoint(office.positions, office.indices, options, {});
    EXPECT_TRUE(view.inside) << half_partition;
    EXPECT_NEAR(view.position.z, 1.6, 0.5);
    EXPECT_LT(std::abs(std::remainder(view.position.x - 2, 4)), 1.5);
    EXPECT_LT(std::abs(std::remainder(view.position.y - 2.5, 5)), 2);
  }
}

// Rooms that are small beside the building, which is far longer than they are high.
TEST(ViewpointChoice, StandsInARoomOfALongBuilding) {
  Triangles office;
  for (int i = 0; i < 40; ++i)
    for (int j = 0; j < 12; ++j)
      add_box(office, {3.75f * i, 5.0f * j, 0}, {3.75f * i + 3.7f, 5.0f * j + 4.95f, 2.8f}, true);
  ViewpointOptions options;
  options.up = Up::z;
  const Viewpoint view = choose_viewpoint(office.positions, office.indices, options, {});
  EXPECT_TRUE(view.inside);
  EXPECT_NEAR(view.position.z, 1.6, 0.3);
  EXPECT_LT(std::abs(std::remainder(view.position.x - 1.85, 3.75)), 1.6);
  EXPECT_LT(std::abs(std::remainder(view.position.y - 2.475, 5)), 2.2);
}

// A person of 0.25 m keeps half a metre from the walls, and has still most of the room ahead.
TEST(ViewpointChoice, KeepsAwayFromWalls) {
  for (const double metres : {1.0, 0.001, 1000.0}) {
    Triangles room;
    add_box(room, {0, 0, 0}, {4, 4, 3}, true);
    for (Vec3f& p : room.positions)
      p = {float(p.x / metres), float(p.y / metres), float(p.z / metres)};
    ViewpointOptions options;
    options.up = Up::z;
    options.metres_per_unit = metres;
    const Viewpoint view = choose_viewpoint(room.positions, room.indices, options, {});
    const double x = view.position.x * metres, y = view.position.y * metres;
    EXPECT_GT(std::min({x, y, 4 - x, 4 - y}), 0.45);
    EXPECT_GT(std::max(std::abs(x - 2), std::abs(y - 2)), 0.9);
    EXPECT_LT((x - 2) * view.direction.x + (y - 2) * view.direction.y, 0) << "looks at a wall";
  }
}

// The largest rooms are dark. The walls between the rooms face both ways.
TEST(ViewpointChoice, StandsInALitRoom) {
  Triangles office;
  ViewpointOptions options;
  options.up = Up::z;
  std::vector<std::uint8_t> light;
  const std::array<float, 6> walls{0, 9, 13, 17, 21, 30};
  for (int i = 0; i < 5; ++i) {
    add_box(office, {walls[i], 0, 0}, {walls[i + 1], 5, 2.8f}, true);
    light.resize(office.indices.size() / 3, i == 2 ? 150 : 0);
  }
  const Viewpoint unknown = choose_viewpoint(office.positions, office.indices, options, {});
  EXPECT_TRUE(unknown.position.x < 9 || unknown.position.x > 21);
  options.light = light;
  const Viewpoint view = choose_viewpoint(office.positions, office.indices, options, {});
  EXPECT_TRUE(view.inside);
  EXPECT_GT(view.position.x, 13);
  EXPECT_LT(view.position.x, 17);
}

TEST(ViewpointChoice, LooksAtTheLitEndOfARoom) {
  for (const bool turned : {false, true}) {
    Triangles hall;
    ViewpointOptions options;
    options.up = Up::z;
    std::vector<std::uint8_t> light;
    // Two halves without a wall between them.
    for (const float x : {0.0f, 10.0f}) {
      Triangles half;
      add_box(half, {x, 0, 0}, {x + 10, 6, 3}, true);
      for (std::size_t t = 0; t < half.indices.size(); t += 3) {
        const auto at_middle = [&](std::size_t k) {
          return half.positions[half.indices[t + k]].x == 10;
        };
        if (at_middle(0) && at_middle(1) && at_middle(2)) continue;
        for (std::size_t k = 0; k < 3; ++k)
          hall.indices.push_back(std::uint32_t(hall.positions.size()) + half.indices[t + k]);
        light.push_back((x > 0) != turned ? 128 : 0);
      }
      hall.positions.insert(hall.positions.end(), half.positions.begin(), half.positions.end());
    }
    options.light = light;
    const Viewpoint view = choose_viewpoint(hall.positions, hall.indices, options, {});
    EXPECT_TRUE(view.inside);
    EXPECT_GT(turned ? -view.direction.x : view.direction.x, 0.8);
  }
}

// The floor that most places share is dark, the other one is not.
TEST(ViewpointChoice, StandsOnALitFloor) {
  Triangles house;
  add_box(house, {0, 0, 0}, {20, 12, 2.8f}, true);
  std::vector<std::uint8_t> light(house.indices.size() / 3, 0);
  add_box(house, {0, 0, 3}, {15, 12, 5.8f}, true);
  light.resize(house.indices.size() / 3, 150);
  ViewpointOptions options;
  options.up = Up::z;
  options.light = light;
  const Viewpoint view = choose_viewpoint(house.positions, house.indices, options, {});
  EXPECT_TRUE(view.inside);
  EXPECT_NEAR(view.position.z, 4.6, 0.3);
}

// A large part with a bore that people could walk through.
TEST(ViewpointChoice, StaysOutOfABoreInAnObject) {
  Triangles part;
  add_box(part, {0, 0, 0}, {60, 60, 40}, false);
  add_box(part, {4, 28, 10}, {56, 32, 14}, true);
  add_box(part, {60, 20, 0}, {90, 40, 40}, false);
  ViewpointOptions options;
  options.up = Up::z;
  EXPECT_FALSE(choose_viewpoint(part.positions, part.indices, options, {}).inside);
}

// A ring of any size that stands on the ground, such as a wheel in millimetres: people could stand
// in the hole of a large one, and a third of what they see there is open.
TEST(ViewpointChoice, StaysOutOfTheHoleOfARing) {
  constexpr int kAround = 96, kAcross = 48;
  for (const double radius : {0.1, 1.0, 10.0, 100.0, 1000.0}) {
    for (const double thickness : {0.5, 0.7}) {
      Triangles ring;
      for (int i = 0; i < kAround; ++i) {
        for (int j = 0; j < kAcross; ++j) {
          const double a = 2 * std::numbers::pi * i / kAround,
                       b = 2 * std::numbers::pi * j / kAcross;
          const double from_axis = radius * (1 + thickness * std::cos(b));
          ring.positions.push_back({float(radius * thickness * std::sin(b)),
                                    float(from_axis * std::cos(a)),
                                    float(from_axis * std::sin(a))});
          const auto at = [&](int k, int l) {
            return std::uint32_t((i + k) % kAround * kAcross + (j + l) % kAcross);
          };
          for (const std::uint32_t v : {at(0, 0), at(1, 0), at(1, 1), at(0, 0), at(1, 1), at(0, 1)})
            ring.indices.push_back(v);
        }
      }
      ViewpointOptions options;
      options.up = Up::z;
      EXPECT_FALSE(choose_viewpoint(ring.positions, ring.indices, options, {}).inside)
          << radius << ", " << thickness;
    }
  }
}

// Scans and parts often come without a unit. Objects are seen from outside in any unit. A gazebo
// is a small building.
TEST(ViewpointChoice, StaysOutOfModelsInAnyUnit) {
  const auto models = test::shared_models();
  if (models.empty()) GTEST_SKIP() << test::lacks("models");
  for (const auto& path : models) {
    const auto loaded = read_scene(path, {}, {});
    ASSERT_TRUE(loaded.ok()) << loaded.status().message();
    for (const double metres : {0.001, 0.01, 0.1, 1.0, 10.0, 100.0, 1000.0}) {
      ViewpointOptions options;
      options.metres_per_unit = metres;
      const Viewpoint view =
          choose_viewpoint(loaded->scene.positions, loaded->scene.indices, options, {});
      EXPECT_EQ(view.inside, path.stem() == "gazebo" && metres == 1) << path << ", " << metres;
    }
  }
}

TEST(ViewpointChoice, EntersTheSharedRoomInAnyUnit) {
  const auto folder = test::shared_data("room");
  if (!folder) GTEST_SKIP() << test::lacks("room");
  const auto loaded = read_scene(*folder / "scene.obj", {}, {});
  ASSERT_TRUE(loaded.ok()) << loaded.status().message();
  for (const double metres : {0.001, 0.01, 0.1, 1.0, 10.0, 100.0, 1000.0}) {
    ViewpointOptions options;
    options.metres_per_unit = metres;
    EXPECT_TRUE(
        choose_viewpoint(loaded->scene.positions, loaded->scene.indices, options, {}).inside)
        << metres;
  }
}

// In a space where nobody can stand, the eye is in the middle third of the height.
TEST(ViewpointChoice, CrawlsWhereNobodyCanStand) {
  Triangles duct;
  add_box(duct, {0, 0, 0}, {20, 6, 1.2f}, true);
  ViewpointOptions options;
  options.up = Up::z;
  const Viewpoint view = choose_viewpoint(duct.positions, duct.indices, options, {});
  EXPECT_TRUE(view.inside);
  EXPECT_GT(view.position.z, 0.4);
  EXPECT_LT(view.position.z, 0.8);
}

// People could stand on the ground, but no walls are around them.
TEST(ViewpointChoice, SeesAnObjectOnAGroundFromOutside) {
  Triangles yard;
  add_box(yard, {0, 0, -0.2f}, {20, 20, 0}, false);
  add_box(yard, {8, 8, 0}, {12, 12, 4}, false);
  const Viewpoint view = choose_viewpoint(yard.positions, yard.indices, {}, {});
  EXPECT_FALSE(view.inside);
  EXPECT_TRUE(view.position.x > 20 || view.position.y > 20 || view.position.z > 4);
}

TEST(ViewpointChoice, DegenerateScenes) {
  EXPECT_FALSE(choose_viewpoint({}, {}, {}, {}).inside);
  const std::vector<Vec3f> point(3, {1, 2, 3});
  const std::vector<std::uint32_t> one{0, 1, 2};
  const Viewpoint view = choose_viewpoint(point, one, {}, {});
  EXPECT_TRUE(std::isfinite(view.position.x) && std::isfinite(view.direction.x));
  World world;
  world.positions = point;
  world.viewpoint = view;
  EXPECT_TRUE(check_world(world).ok());
}

// Formats that are said to ignore the viewpoint do so, and no others do.
TEST(ViewpointChoice, IsHeldByFormatsThatSaySo) {
  World world = wavy_world(4, 1);
  world.pages[0].image.clear();
  for (const char* name : {"w.wrl", "w.wrz", "w.obj", "w.gltf", "w.glb"}) {
    const TempFolder folder;
    std::array<std::string, 2> bytes;
    for (const int k : {0, 1}) {
      world.viewpoint.position = {1.0 + k, 2, 3};
      AtomicFiles files;
      ASSERT_TRUE(write_world(world, folder / name, files, {}).ok());
      ASSERT_TRUE(files.commit().ok());
      std::ifstream file(folder / name, std::ios::binary);
      bytes[k] = {std::istreambuf_iterator<char>(file), {}};
      ASSERT_FALSE(bytes[k].empty());
    }
    EXPECT_EQ(bytes[0] != bytes[1], holds_viewpoint(name)) << name;
  }
  EXPECT_FALSE(holds_viewpoint("w.stl"));
}

}  // namespace
}  // namespace atlas
