// The lining with its windows, the floor, the bulkheads, the ceiling and the light strips.
#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <numbers>

#include "examples/cabin/layout.h"
#include "examples/cabin/primitives.h"

namespace cabin {
namespace {

constexpr double kBandHalf = 0.25;    // half the height of the wall band that holds the windows
constexpr double kCrownAngle = 0.66;  // where the lining ends and the crown begins, from the axis

// How many rows of quads each part of the wall has, from the floor up. A bay has as many columns as
// the band has rows.
struct WallRows {
  int dado, band, lining, crown;
};

WallRows wall_rows(const Builder& builder) {
  const bool coarse = builder.coarse();
  const double middle = wall_height(kWindowHeight);
  const double dado = middle - kBandHalf - wall_height(0),
               lining = kRadius * kCrownAngle - middle - kBandHalf;
  return {builder.segments(dado, coarse ? 3 : 6), builder.segments(kBay, coarse ? 2 : 4),
          builder.segments(lining, coarse ? 2 : 3), builder.segments(kRadius * 1.8) / 2 + 2};
}

// Returns a height of the crown, for v in [0, 1] from one side over the top to the other.
double crown_height(double v) {
  return kRadius * (kCrownAngle + (std::numbers::pi - 2 * kCrownAngle) * v);
}

// Returns the heights along the wall of all rows' borders, from the floor to the top of the crown.
std::vector<double> row_heights(const WallRows& rows) {
  const double floor = wall_height(0), middle = wall_height(kWindowHeight);
  std::vector<double> heights;
  const auto add = [&](double from, double to, int count) {
    for (int i = 0; i < count; ++i) heights.push_back(from + (to - from) * i / count);
  };
  add(floor, middle - kBandHalf, rows.dado);
  add(middle - kBandHalf, middle + kBandHalf, rows.band);
  add(middle + kBandHalf, kRadius * kCrownAngle, rows.lining);
  for (int i = 0; i <= rows.crown / 2; ++i) heights.push_back(crown_height(double(i) / rows.crown));
  return heights;
}

// A piece of wall between two positions along the cabin and two heights.
struct WallPiece {
  int side;
  glm::dvec2 x, height;
};

void add_wall(Builder& builder, const WallPiece& piece, glm::ivec2 cells) {
  const glm::dvec2 x = piece.x, height = piece.height;
  GridShape grid;
  grid.surface = [=, side = piece.side](double u, double v) {
    return wall_point(side, x.x + (x.y - x.x) * u, height.x + (height.y - height.x) * v, 0);
  };
  grid.nu = cells.x;
  grid.nv = cells.y;
  grid.tiles = {(x.y - x.x) / 0.5, (height.y - height.x) / 0.5};
  grid.flip = piece.side < 0;
  add_grid(builder, grid);
}

// Returns the inward normal of the wall.
glm::dvec3 wall_normal(int side, double height) {
  const double angle = height / kRadius;
  return {0, -side * std::cos(angle), -std::sin(angle)};
}

// Returns the corner at p.x along the cabin and at the height p.y.
Corner wall_corner(int side, glm::dvec2 p) {
  return {wall_point(side, p.x, p.y, 0), wall_normal(side, p.y), {p.x / 0.5, p.y / 0.5}};
}

// Returns the border of the square [-1, 1]² in 4 n steps, anticlockwise.
std::vector<glm::dvec2> square_border(int n) {
  std::vector<glm::dvec2> border;
  const glm::dvec2 start[] = {{-1, -1}, {1, -1}, {1, 1}, {-1, 1}};
  for (int edge = 0; edge < 4; ++edge)
    for (int i = 0; i < n; ++i)
      border.push_back(glm::mix(start[edge], start[(edge + 1) % 4], double(i) / n));
  return border;
}

struct Window {
  int side, bay;
  glm::dvec2 centre;
};

// Adds the wall around a window: rings from the rectangle of the band to the rim of the window.
void add_window_wall(Builder& builder, const Window& window, int n) {
  const auto border = square_border(n);
  const int rings = builder.segments(0.12, builder.coarse() ? 1 : 2);
  const auto corner = [&](int ring, std::size_t i) {
    const glm::dvec2 q = border[i % border.size()];
    const glm::dvec2 outer(q.x * kBay / 2, q.y * kBandHalf), inner = window_rim(q.x, q.y);
    const glm::dvec2 p = window.centre + glm::mix(inner, outer, double(ring) / rings);
    return wall_corner(window.side, p);
  };
  for (int ring = 0; ring < rings; ++ring)
    for (std::size_t i = 0; i < border.size(); ++i)
      builder.quad(corner(ring, i), corner(ring, i + 1), corner(ring + 1, i + 1),
                   corner(ring + 1, i));
}

// Adds the funnel from the rim outwards, and the blind at its end.
void add_reveal(Builder& builder, const Window& window, int n) {
  const int side = window.side;
  const glm::dvec2 centre = window.centre;
  const auto border = square_border(n);
  builder.begin("window_reveals", "trim");
  const int rings = builder.segments(kRevealDepth, builder.coarse() ? 1 : 2);
  const auto corner = [&](int ring, std::size_t i) {
    const glm::dvec2 q = border[i % border.size()];
    const double t = double(ring) / rings;
    // A rounded funnel: steep at the rim, then straight.
    const double scale = 1 - (1 - kRevealScale) * (1 - (1 - t) * (1 - t));
    const glm::dvec2 p = centre + scale * window_rim(q.x, q.y);
    const glm::dvec3 out = wall_normal(side, centre.y);
    const glm::dvec3 c = wall_point(side, centre.x, centre.y, 0),
                     at = wall_point(side, p.x, p.y, 0);
    const glm::dvec3 radial = c - at - out * glm::dot(c - at, out);
    const glm::dvec3 normal = glm::normalize(glm::normalize(radial) + out * (0.15 + 0.9 * (1 - t)));
    return Corner{wall_point(side, p.x, p.y, -kRevealDepth * t),
                  normal,
                  {double(i) / border.size() * 2, t * 0.2}};
  };
  for (int ring = 0; ring < rings; ++ring)
    for (std::size_t i = 0; i < border.size(); ++i)
      builder.quad(corner(ring, i), corner(ring, i + 1), corner(ring + 1, i + 1),
                   corner(ring + 1, i));
  const double share = blind_share(side, window.bay);
  if (share <= 0) return;
  builder.begin("window_blinds", "blind");
  GridShape blind;
  const double top = centre.y + kWindowHalf.y, bottom = top - 2 * kWindowHalf.y * share;
  blind.surface = [=](double u, double v) {
    return wall_point(side, centre.x + (2 * u - 1) * kWindowHalf.x, bottom + (top - bottom) * v,
                      -0.8 * kRevealDepth);
  };
  blind.nu = builder.segments(2 * kWindowHalf.x, 2);
  blind.nv = builder.segments(top - bottom);
  blind.flip = side < 0;
  add_grid(builder, blind);
}

void add_bay(Builder& builder, int side, int bay) {
  const glm::dvec2 x(bay * kBay, (bay + 1) * kBay);
  const double middle = wall_height(kWindowHeight), floor = wall_height(0);
  const WallRows rows = wall_rows(builder);
  builder.begin("lining", "lining");
  add_wall(builder, {side, x, {middle + kBandHalf, kRadius * kCrownAngle}},
           {rows.band, rows.lining});
  builder.begin("dado", "dado");
  add_wall(builder, {side, x, {floor, middle - kBandHalf}}, {rows.band, rows.dado});
  builder.begin("lining", "lining");
  if (!has_window(bay))
    return add_wall(builder, {side, x, {middle - kBandHalf, middle + kBandHalf}},
                    {rows.band, rows.band});
  const Window window{side, bay, {(x.x + x.y) / 2, middle}};
  add_window_wall(builder, window, rows.band);
  add_reveal(builder, window, rows.band);
}

// Adds the crown of the fuselage above the bins and the ceiling, which no light reaches.
void add_crown(Builder& builder) {
  builder.begin("crown", "dado");
  GridShape crown;
  crown.surface = [](double u, double v) { return wall_point(1, kLength * u, crown_height(v), 0); };
  crown.nu = builder.segments(kLength) / 2 + 1;
  crown.nv = wall_rows(builder).crown;
  add_grid(builder, crown);
}

// Adds a bulkhead, whose border has the vertices of the wall's and the crown's ends: no gap opens
// beside their chords.
void add_bulkhead(Builder& builder, double x, bool faces_aft, const std::string& name) {
  builder.begin(name, faces_aft ? "trim" : "wood_panel");
  const std::vector<double> heights = row_heights(wall_rows(builder));
  GridShape wall;
  wall.nu = builder.segments(2 * kRadius);
  wall.nv = int(heights.size()) - 1;
  wall.surface = [&, rows = wall.nv](double u, double v) {
    const int row = std::clamp(int(v * rows), 0, rows - 1);
    const glm::dvec3 border =
        wall_point(1, x, glm::mix(heights[row], heights[row + 1], v * rows - row), 0);
    return glm::dvec3(x, (2 * u - 1) * border.y, border.z);
  };
  wall.flip = !faces_aft;
  wall.tiles_of = [](glm::dvec3 p) { return glm::dvec2(p.y, p.z) * 0.8; };
  add_grid(builder, wall);
}

void add_floor(Builder& builder) {
  const double edge = half_width(0), runner = 0.29, entry = 1.95;
  const auto piece = [&](const char* name, const char* material, glm::dvec2 x, glm::dvec2 y) {
    builder.begin(name, material);
    GridShape grid;
    grid.surface = [=](double u, double v) {
      return glm::dvec3(x.x + (x.y - x.x) * u, y.x + (y.y - y.x) * v, 0);
    };
    grid.nu = builder.segments(x.y - x.x);
    grid.nv = builder.segments(y.y - y.x);
    grid.tiles = {(x.y - x.x) / 0.4, (y.y - y.x) / 0.4};
    add_grid(builder, grid);
  };
  piece("floor_entry", "entry_floor", {0, entry}, {-edge, edge});
  piece("floor", "carpet", {entry, kLength}, {-edge, -runner});
  piece("floor", "carpet", {entry, kLength}, {runner, edge});
  piece("aisle", "aisle_carpet", {entry, kLength}, {-runner, runner});
}

}  // namespace

void add_shell(Builder& builder) {
  for (int side : {-1, 1})
    for (int bay = 0; bay < kBays; ++bay) add_bay(builder, side, bay);
  add_crown(builder);
  add_floor(builder);
  add_bulkhead(builder, 0, true, "bulkhead_front");
  add_bulkhead(builder, kLength, false, "bulkhead_aft");
  builder.begin("lavatory_door", "trim");
  RoundedBox door;
  door.centre = {kLength - 0.02, 0, 0.97};
  door.half = {0.015, 0.3, 0.95};
  door.radius = 0.012;
  add_rounded_box(builder, door);
  builder.begin("lavatory_handle", "metal");
  RoundedBox handle;
  handle.centre = {kLength - 0.05, -0.22, 1.0};
  handle.half = {0.015, 0.02, 0.09};
  handle.radius = 0.014;
  add_rounded_box(builder, handle);
}

std::vector<Strip> light_strips() {
  std::vector<Strip> strips;
  for (int side : {-1, 1}) {
    // Along the upper edge of the bins, shining inwards.
    const glm::dvec2 a(side * 0.614, 1.915), b(side * 0.606, 1.99);
    // On top of the bins, shining up to the ceiling.
    const glm::dvec2 c(side * 0.66, 1.975), d(side * 0.80, 1.975);
    // Below the bins, shining down the lining.
    const glm::dvec2 e(side * 1.32, 1.49), f(side * 1.24, 1.49);
    const bool left = side > 0;
    strips.push_back({kBinStart, kLength - 0.02, left ? a : b, left ? b : a, 6, "strip"});
    strips.push_back({kBinStart, kLength - 0.02, left ? c : d, left ? d : c, 6, "cove"});
    strips.push_back({kBinStart, kLength - 0.02, left ? e : f, left ? f : e, 6, "wash"});
  }
  strips.push_back({0.75, 1.55, {0.55, 2.105}, {0.05, 2.105}, 1, "entry_light"});
  return strips;
}

void add_ceiling(Builder& builder) {
  builder.begin("ceiling", "ceiling");
  GridShape arch;
  arch.surface = [](double u, double v) {
    const double y = 0.8 * (2 * v - 1);
    return glm::dvec3(kBinStart + (kLength - kBinStart) * u, y, 2.2 - 0.1 * y * y / 0.64);
  };
  arch.nu = builder.segments(kLength - kBinStart);
  arch.nv = 2 * builder.segments(0.8, 3);
  arch.tiles = {4, 1};
  arch.flip = true;
  add_grid(builder, arch);
  builder.begin("ceiling_entry", "ceiling");
  RoundedBox panel;
  panel.centre = {0.97, 0, 2.16};
  panel.half = {0.97, 0.8, 0.05};
  panel.radius = 0.03;
  add_rounded_box(builder, panel);
  for (const Strip& strip : light_strips()) {
    builder.begin("light_strips", strip.material);
    GridShape grid;
    grid.surface = [&](double u, double v) {
      const glm::dvec2 p = glm::mix(strip.from, strip.to, v);
      return glm::dvec3(strip.x0 + (strip.x1 - strip.x0) * u, p.x, p.y);
    };
    grid.nu = builder.segments(strip.x1 - strip.x0) / 2 + 1;
    add_grid(builder, grid);
  }
}

}  // namespace cabin
