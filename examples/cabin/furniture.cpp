// Overhead bins and seats, with the closed cavities inside them that no light reaches.
#include <algorithm>
#include <cmath>

#include "examples/cabin/layout.h"
#include "examples/cabin/primitives.h"

namespace cabin {
namespace {

// Adds a closed cavity inside a body. Real models have such cavities, and in a lit mesh all of
// their surface is black.
void add_hollow(Builder& builder, const RoundedBox& body, double wall) {
  RoundedBox hollow = body;
  hollow.half -= wall;
  hollow.radius = std::max(0.004, body.radius - wall);
  hollow.least = glm::ivec3(0);
  hollow.inward = true;
  add_rounded_box(builder, hollow);
}

void add_bin(Builder& builder, int side, int index, double length) {
  const std::string name = "bin_" + std::string(side > 0 ? "s" : "p") + std::to_string(index + 1);
  builder.begin(name, "bin");
  RoundedBox bin;
  bin.centre = {kBinStart + (index + 0.5) * length, side * 0.985, 1.735};
  bin.half = {length / 2 - 0.004, 0.365, 0.225};
  bin.least = {1, 1, 2};
  bin.radius = 0.055;
  // The front leans, as on bins that swing up: it is lower at the nose and bulges a little.
  bin.warp = [side](glm::dvec3 p) {
    const double across = (p.y * side - 0.62) / 0.73;  // 0 at the front, 1 at the lining
    const double up = (p.z - 1.735) / 0.225;
    p.y += side * (0.05 * up + 0.035 * up * up - 0.02);
    p.z += 0.02 * across * (1 - up);
    return p;
  };
  add_rounded_box(builder, bin);
  builder.begin(name + "_inside", "dado");
  add_hollow(builder, bin, 0.04);
  builder.begin(name + "_latch", "metal");
  RoundedBox latch;
  latch.centre = {bin.centre.x, side * 0.607, 1.60};
  latch.half = {0.06, 0.009, 0.014};
  latch.radius = 0.008;
  latch.least = glm::ivec3(0);
  add_rounded_box(builder, latch);
}

// Rotates a point of a seat's back about the axis y through `pivot` by `angle`.
glm::dvec3 lean(glm::dvec3 p, glm::dvec3 pivot, double angle) {
  const double x = p.x - pivot.x, z = p.z - pivot.z;
  return {pivot.x + x * std::cos(angle) + z * std::sin(angle), p.y,
          pivot.z - x * std::sin(angle) + z * std::cos(angle)};
}

void add_cushion(Builder& builder, const std::string& name, glm::dvec3 at) {
  builder.begin(name, "seat_fabric");
  RoundedBox cushion;
  cushion.centre = at + glm::dvec3(0, 0, 0.40);
  cushion.half = {0.245, 0.235, 0.075};
  cushion.radius = 0.055;
  cushion.least = {2, 2, 1};
  cushion.tiles_per_metre = 4;
  cushion.warp = [at](glm::dvec3 p) {
    const double x = (p.x - at.x) / 0.245, y = (p.y - at.y) / 0.235;
    // Shapes a crown in the middle, a raised front edge that rolls over, and bolsters at the sides.
    const double top = std::max(0.0, (p.z - 0.36) / 0.115);
    p.z += top * (0.022 * (1 - y * y) + 0.02 * y * y * y * y - 0.03 * std::max(0.0, -x - 0.55));
    p.z += 0.02 * (1 - x) * 0.5;
    return p;
  };
  add_rounded_box(builder, cushion);
  builder.begin(name + "_frame", "dado");
  add_hollow(builder, cushion, 0.03);
}

void add_back(Builder& builder, const std::string& name, glm::dvec3 at) {
  const glm::dvec3 pivot = at + glm::dvec3(0.2, 0, 0.42);
  builder.begin(name, "seat_fabric");
  RoundedBox back;
  back.centre = at + glm::dvec3(0.255, 0, 0.745);
  back.half = {0.062, 0.232, 0.365};
  back.least = {1, 2, 3};
  back.radius = 0.05;
  back.tiles_per_metre = 4;
  back.warp = [at, pivot](glm::dvec3 p) {
    const double y = (p.y - at.y) / 0.232, z = (p.z - 0.745) / 0.365;
    const double front = std::max(0.0, (at.x + 0.255 - p.x) / 0.062 + 0.2);
    // Shapes bolsters at the sides and a lumbar swell; the back is narrower at the top.
    p.x -= front * (0.026 * y * y * y * y + 0.02 * std::exp(-8 * (z + 0.45) * (z + 0.45)) - 0.008);
    p.y = at.y + (p.y - at.y) * (1 - 0.10 * std::max(0.0, z) * std::max(0.0, z));
    return lean(p, pivot, 0.2);
  };
  add_rounded_box(builder, back);
  builder.begin(name + "_frame", "dado");
  add_hollow(builder, back, 0.025);
  builder.begin(name + "_head", "head_fabric");
  RoundedBox head;
  head.centre = at + glm::dvec3(0.232, 0, 1.03);
  head.half = {0.06, 0.155, 0.105};
  head.radius = 0.045;
  head.tiles_per_metre = 3;
  head.warp = [at, pivot](glm::dvec3 p) {
    const double y = (p.y - at.y) / 0.155;
    p.x -= 0.03 * y * y;  // wings
    return lean(p, pivot, 0.2);
  };
  add_rounded_box(builder, head);
}

void add_armrest(Builder& builder, const std::string& name, glm::dvec3 at) {
  builder.begin(name, "armrest");
  RoundedBox pad;
  pad.centre = at + glm::dvec3(0.0, 0, 0.62);
  pad.half = {0.21, 0.026, 0.022};
  pad.radius = 0.018;
  add_rounded_box(builder, pad);
  RoundedBox post;
  post.centre = at + glm::dvec3(0.15, 0, 0.47);
  post.half = {0.04, 0.018, 0.135};
  post.radius = 0.014;
  post.least = glm::ivec3(0);
  add_rounded_box(builder, post);
}

void add_legs(Builder& builder, const std::string& name, glm::dvec3 at) {
  builder.begin(name, "metal");
  for (double y : {-0.26, 0.26}) {
    RoundedBox leg;
    leg.centre = at + glm::dvec3(0.02, y, 0.165);
    leg.half = {0.15, 0.02, 0.16};
    leg.radius = 0.012;
    leg.least = {0, 0, 1};
    const double middle = at.x + 0.02;
    leg.warp = [middle](glm::dvec3 p) {
      p.x = middle + (p.x - middle) * (0.55 + 0.45 * std::abs(p.z - 0.16) / 0.16) -
            0.3 * (p.z - 0.165);
      return p;
    };
    add_rounded_box(builder, leg);
  }
  RoundedBox beam;
  beam.centre = at + glm::dvec3(0.0, 0, 0.315);
  beam.half = {0.2, 0.46, 0.02};
  beam.radius = 0.015;
  beam.least = {0, 1, 0};
  add_rounded_box(builder, beam);
}

}  // namespace

void add_bins(Builder& builder) {
  const double length = (kLength - 0.02 - kBinStart) / 5;
  for (int side : {-1, 1}) {
    for (int i = 0; i < 5; ++i) add_bin(builder, side, i, length);
    // Adds the rails that carry the strips above the bins, and the panel that closes their front
    // end.
    builder.begin("bin_rails", "trim");
    RoundedBox rail;
    rail.centre = {(kBinStart + kLength) / 2, side * 0.637, 1.952};
    rail.half = {(kLength - kBinStart) / 2, 0.02, 0.042};
    rail.radius = 0.008;
    add_rounded_box(builder, rail);
    builder.begin("bin_ends", "trim");
    RoundedBox end;
    end.centre = {kBinStart - 0.022, side * 0.98, 1.80};
    end.half = {0.018, 0.385, 0.325};
    end.radius = 0.016;
    add_rounded_box(builder, end);
  }
}

void add_seats(Builder& builder) {
  for (int row = 0; row < kRows; ++row) {
    for (int side : {-1, 1}) {
      const double x = kFirstRow + 0.35 + row * kRowPitch;
      const std::string pair = "seat_" + std::to_string(row + 1) + (side > 0 ? "s" : "p");
      for (int seat = 0; seat < 2; ++seat) {
        const glm::dvec3 at(x, side * (0.575 + 0.51 * seat), 0);
        const std::string name = pair + (seat == 0 ? "_aisle" : "_window");
        add_cushion(builder, name + "_cushion", at);
        add_back(builder, name + "_back", at);
      }
      for (int arm = 0; arm < 3; ++arm)
        add_armrest(builder, pair + "_armrests", {x, side * (0.32 + 0.51 * arm), 0});
      add_legs(builder, pair + "_legs", {x, side * 0.83, 0});
    }
  }
}

}  // namespace cabin
