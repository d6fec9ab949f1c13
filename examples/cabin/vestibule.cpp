// The door with its frame, and the galley opposite.
#include <algorithm>
#include <cmath>

#include "examples/cabin/layout.h"
#include "examples/cabin/primitives.h"

namespace cabin {
namespace {

constexpr double kDoorMiddle = 1.38;
// Of its centre, as arc length.
const double kDoorHeight = (wall_height(0.07) + wall_height(1.86)) / 2;
const glm::dvec2 kDoorHalf{0.37, (wall_height(1.86) - wall_height(0.07)) / 2};

// Converts (along the wall, arc height, depth) relative to the door's centre to space, on the side
// y > 0.
glm::dvec3 on_wall(glm::dvec3 p) {
  return wall_point(1, kDoorMiddle + p.x, kDoorHeight + p.y, p.z);
}

void add_door_window(Builder& builder) {
  const double up = wall_height(1.35) - kDoorHeight;
  Ring ring;
  ring.path_half = {0.09, 0.12};
  ring.path_radius = 0.085;
  ring.half = {0.022, 0.012};
  ring.warp = [up](glm::dvec3 p) { return on_wall({p.x, p.y + up, p.z + 0.03}); };
  builder.begin("door_window_trim", "trim");
  add_ring(builder, ring);
  builder.begin("door_window", "glass");
  RoundedBox glass;
  glass.centre = {0, up, 0.028};
  glass.half = {0.085, 0.115, 0.004};
  glass.radius = 0.0035;
  glass.warp = on_wall;
  add_rounded_box(builder, glass);
}

// Adds a body of revolution for the galley's counter: a pot with belly, neck and a lid with a knob.
void add_pot(Builder& builder, glm::dvec3 at) {
  builder.begin("pots", "metal");
  Revolved pot;
  pot.centre = at;
  pot.largest_radius = 0.075;
  pot.height = 0.26;
  pot.profile = [](double t) {
    const double z = 0.26 * t;
    const double belly = 0.062 + 0.014 * std::sin(3.0 * t), neck = 1 - 0.35 * std::pow(t, 6);
    const double lid = t < 0.9 ? 1.0 : std::sqrt(std::max(0.0, 1 - std::pow((t - 0.9) / 0.1, 2)));
    return glm::dvec2(belly * neck * lid, z);
  };
  add_revolved(builder, pot);
  RoundedBox handle;
  handle.least = glm::ivec3(0);
  handle.centre = at + glm::dvec3(-0.095, 0, 0.13);
  handle.half = {0.012, 0.012, 0.08};
  handle.radius = 0.01;
  add_rounded_box(builder, handle);
  for (double z : {0.06, 0.2}) {
    RoundedBox arm;
    arm.centre = at + glm::dvec3(-0.075, 0, z);
    arm.half = {0.03, 0.009, 0.009};
    arm.radius = 0.008;
    arm.least = glm::ivec3(0);
    add_rounded_box(builder, arm);
  }
}

struct Cupboards {
  double x0, x1, z0, z1;
  int columns, rows;
};

// Adds cupboards whose doors stand 8 mm apart. The front of the galley is the plane y = front.
void add_cupboards(Builder& builder, const std::string& name, const Cupboards& c, double front) {
  const double width = (c.x1 - c.x0) / c.columns, height = (c.z1 - c.z0) / c.rows;
  for (int i = 0; i < c.columns; ++i)
    for (int j = 0; j < c.rows; ++j) {
      builder.begin(name, "wood");
      RoundedBox door;
      door.centre = {c.x0 + (i + 0.5) * width, front, c.z0 + (j + 0.5) * height};
      door.half = {width / 2 - 0.004, 0.012, height / 2 - 0.004};
      door.radius = 0.006;
      door.tiles_per_metre = 1.4;
      add_rounded_box(builder, door);
      builder.begin(name + "_handles", "metal");
      RoundedBox handle;
      const bool wide = width > height;
      const double dx = wide ? 0 : (i % 2 == 0 ? 1 : -1) * (width / 2 - 0.035);
      handle.centre = {door.centre.x + dx, front + 0.024,
                       door.centre.z + (wide ? height * 0.3 : 0)};
      handle.half = wide ? glm::dvec3(0.06, 0.012, 0.007) : glm::dvec3(0.007, 0.012, 0.06);
      handle.radius = 0.006;
      handle.least = glm::ivec3(0);
      add_rounded_box(builder, handle);
    }
}

void add_block(Builder& builder, glm::dvec3 low, glm::dvec3 high, double radius) {
  RoundedBox block;
  block.centre = (low + high) / 2.0;
  block.half = (high - low) / 2.0;
  block.radius = radius;
  block.tiles_per_metre = 1.4;
  add_rounded_box(builder, block);
}

}  // namespace

void add_door(Builder& builder) {
  builder.begin("door", "door_panel");
  RoundedBox panel;
  panel.centre = {0, 0, 0.016};
  panel.half = {kDoorHalf.x - 0.02, kDoorHalf.y - 0.02, 0.01};
  panel.radius = 0.009;
  panel.least = {1, 9, 1};
  panel.warp = on_wall;
  add_rounded_box(builder, panel);
  builder.begin("door_frame", "trim");
  Ring frame;
  frame.path_half = kDoorHalf + 0.035;
  frame.path_radius = 0.13;
  frame.least = 9;
  frame.half = {0.038, 0.016};
  // There are 8 mm of air behind the frame. Its shadow on the wall is sharp, which is the case that
  // leaks light into coarse texels.
  frame.warp = [](glm::dvec3 p) { return on_wall(p + glm::dvec3(0, 0, 0.024)); };
  add_ring(builder, frame);
  add_door_window(builder);
  builder.begin("door_handle", "metal");
  RoundedBox handle;
  handle.centre = {-0.2, wall_height(0.98) - kDoorHeight, 0.055};
  handle.half = {0.10, 0.016, 0.012};
  handle.radius = 0.011;
  handle.warp = on_wall;
  add_rounded_box(builder, handle);
  handle.centre += glm::dvec3(0.075, 0, -0.018);
  handle.half = {0.018, 0.018, 0.018};
  handle.radius = 0.008;
  add_rounded_box(builder, handle);
  builder.begin("exit_sign", "sign");
  RoundedBox sign;
  sign.centre = {0, wall_height(1.965) - kDoorHeight, 0.035};
  sign.half = {0.12, 0.035, 0.014};
  sign.radius = 0.01;
  sign.warp = on_wall;
  add_rounded_box(builder, sign);
}

void add_galley(Builder& builder) {
  constexpr double kX0 = 1.1, kX1 = 1.92, kFront = -0.66, kBack = -1.45;
  builder.begin("galley_sides", "wood");
  add_block(builder, {kX0, kBack, 0}, {kX0 + 0.03, kFront, 2.10}, 0.008);
  add_block(builder, {kX1 - 0.03, kBack, 0}, {kX1, kFront, 2.10}, 0.008);
  builder.begin("galley_body", "dado");
  add_block(builder, {kX0 + 0.032, kBack, 0.08}, {kX1 - 0.032, kFront - 0.03, 0.878}, 0.005);
  add_block(builder, {kX0 + 0.032, kBack, 1.36}, {kX1 - 0.032, kFront - 0.03, 2.098}, 0.005);
  builder.begin("galley_back", "metal");
  add_block(builder, {kX0 + 0.032, kBack + 0.125, 0.92}, {kX1 - 0.032, kBack + 0.145, 1.362},
            0.004);
  builder.begin("galley_counter", "counter");
  add_block(builder, {kX0 + 0.031, kBack + 0.12, 0.88}, {kX1 - 0.031, kFront + 0.02, 0.92}, 0.015);
  const double x0 = kX0 + 0.035, x1 = kX1 - 0.035;
  add_cupboards(builder, "galley_low", {x0, x1, 0.10, 0.87, 2, 2}, kFront - 0.02);
  add_cupboards(builder, "galley_high", {x0, x1, 1.38, 2.09, 3, 1}, kFront - 0.02);
  add_pot(builder, {kX0 + 0.25, kFront - 0.2, 0.92});
  add_pot(builder, {kX0 + 0.5, kFront - 0.28, 0.92});
}

}  // namespace cabin
