#include "tests/support/lit_shapes.h"

#include <random>

namespace atlas {

LitShape make_sheet(const Sheet& sheet, const Light& light) {
  LitShape out;
  Scene& s = out.scene;
  ChartSet& c = out.charts;
  std::mt19937 random(11);
  for (int j = 0; j <= sheet.rows; ++j)
    for (int i = 0; i <= sheet.columns; ++i) {
      const bool rim = i == 0 || j == 0 || i == sheet.columns || j == sheet.rows;
      const auto moved = [&] {
        const double r = (random() % 2001) / 1000.0 - 1;
        return rim ? 0.0 : sheet.jitter * r;
      };
      const double u = sheet.width * (i + moved()) / sheet.columns;
      const double v = sheet.height * (j + moved()) / sheet.rows;
      s.positions.push_back({static_cast<float>(u), static_cast<float>(v), 0});
      s.illumination.push_back(light(u, v));
      c.uvs.push_back({u, v});
      c.uv_vertex.push_back(static_cast<std::uint32_t>(c.uv_vertex.size()));
    }
  const auto row = static_cast<std::uint32_t>(sheet.columns + 1);
  for (std::uint32_t j = 0; j < std::uint32_t(sheet.rows); ++j)
    for (std::uint32_t i = 0; i < std::uint32_t(sheet.columns); ++i) {
      const std::uint32_t a = j * row + i;
      for (const std::uint32_t v : {a, a + 1, a + row + 1, a, a + row + 1, a + row})
        s.indices.push_back(v);
    }
  const auto n = static_cast<std::uint32_t>(s.indices.size() / 3);
  s.triangle_material.assign(n, 0);
  s.triangle_object.assign(n, 0);
  s.materials.push_back({"sheet", sheet.diffuse, -1});
  s.object_names.push_back("sheet");
  c.triangle_uv = s.indices;
  c.triangle_chart.assign(n, 0);
  for (std::uint32_t t = 0; t < n; ++t) c.chart_triangles.push_back(t);
  Chart chart;
  chart.triangle_count = n;
  chart.uv_count = static_cast<std::uint32_t>(c.uvs.size());
  chart.size = {sheet.width, sheet.height};
  c.charts.push_back(chart);
  c.surface_area = sheet.width * sheet.height;
  return out;
}

void append(LitShape& to, const LitShape& from, Vec3f offset) {
  Scene& s = to.scene;
  ChartSet& c = to.charts;
  const auto vertices = static_cast<std::uint32_t>(s.positions.size());
  const auto uvs = static_cast<std::uint32_t>(c.uvs.size());
  const auto triangles = static_cast<std::uint32_t>(s.triangle_count());
  const auto materials = static_cast<std::uint32_t>(s.materials.size());
  const auto charts = static_cast<std::uint32_t>(c.charts.size());
  for (const Vec3f& p : from.scene.positions)
    s.positions.push_back({p.x + offset.x, p.y + offset.y, p.z + offset.z});
  for (const Vec3f& e : from.scene.illumination) s.illumination.push_back(e);
  for (const std::uint32_t i : from.scene.indices) s.indices.push_back(i + vertices);
  for (const std::uint32_t m : from.scene.triangle_material)
    s.triangle_material.push_back(m + materials);
  s.triangle_object.resize(s.triangle_count(), 0);
  for (const Material& m : from.scene.materials) s.materials.push_back(m);
  for (const Vec2d& q : from.charts.uvs) c.uvs.push_back(q);
  for (const std::uint32_t v : from.charts.uv_vertex) c.uv_vertex.push_back(v + vertices);
  for (const std::uint32_t i : from.charts.triangle_uv) c.triangle_uv.push_back(i + uvs);
  for (const std::uint32_t i : from.charts.triangle_chart) c.triangle_chart.push_back(i + charts);
  for (const std::uint32_t t : from.charts.chart_triangles)
    c.chart_triangles.push_back(t + triangles);
  for (Chart chart : from.charts.charts) {
    chart.first_triangle += triangles;
    chart.first_uv += uvs;
    c.charts.push_back(chart);
  }
}

void add_texture(LitShape& shape, const Image8& image, Vec2f repeats) {
  Scene& s = shape.scene;
  s.materials[0].texture = static_cast<std::int32_t>(s.textures.size());
  s.textures.push_back({"test.png", image});
  s.texcoords.clear();
  for (const Vec3f& p : s.positions) s.texcoords.push_back({p.x * repeats.x, p.y * repeats.y});
  s.texcoord_indices = s.indices;
}

}  // namespace atlas
