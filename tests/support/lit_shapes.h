// Small lit scenes whose charts are laid out by hand, so that texture/ and bake/ are tested without
// the chart stage.
#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include "libatlas/charts/charts.h"
#include "libatlas/scene/scene.h"

namespace atlas {

struct LitShape {
  Scene scene;
  ChartSet charts;
};

// Returns the illumination at (u, v) of a chart, in scene units.
using Light = std::function<Vec3f(double u, double v)>;

// A flat rectangle in z = 0 of columns x rows cells of two triangles each. It is one chart whose
// uvs are x and y. `jitter` (0 to 0.3) moves inner vertices by up to that share of a cell.
struct Sheet {
  double width = 1, height = 1;
  int columns = 8, rows = 8;
  double jitter = 0;
  Vec3f diffuse{1, 1, 1};
};
LitShape make_sheet(const Sheet& sheet, const Light& light);

// Adds the triangles, materials and charts of `from`, whose positions are moved by `offset`.
void append(LitShape& to, const LitShape& from, Vec3f offset);

// Puts a texture on every triangle of the first material, with uv = (x, y) * repeats.
void add_texture(LitShape& shape, const Image8& image, Vec2f repeats);

}  // namespace atlas
