#include "tests/simplify/shapes.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace atlas::simplify_test {
namespace {

constexpr double kPi = std::numbers::pi;

float as_float(double x) {
  return static_cast<float>(x);
}

std::uint32_t noise(std::uint32_t i, std::uint32_t j) {
  std::uint32_t h = i * 73856093U ^ j * 19349663U;
  h = (h ^ (h >> 13)) * 1274126177U;
  return h ^ (h >> 16);
}

}  // namespace

std::uint32_t ChartedMeshBuilder::vertex(const Vec3f& p) {
  const auto [entry, fresh] = known_.emplace(std::array{p.x + 0.0F, p.y + 0.0F, p.z + 0.0F},
                                             static_cast<std::uint32_t>(known_.size()));
  if (fresh) mesh_.positions.push_back(p);
  return entry->second;
}

void ChartedMeshBuilder::add_chart(const std::vector<Vertex>& vertices,
                                   const std::vector<std::uint32_t>& triangles) {
  ChartSet& set = mesh_.charts;
  Chart chart;
  chart.first_triangle = static_cast<std::uint32_t>(set.chart_triangles.size());
  chart.triangle_count = static_cast<std::uint32_t>(triangles.size() / 3);
  chart.first_uv = static_cast<std::uint32_t>(set.uvs.size());
  chart.uv_count = static_cast<std::uint32_t>(vertices.size());
  for (const Vertex& v : vertices) {
    set.uvs.push_back(v.uv);
    set.uv_vertex.push_back(vertex(v.position));
  }
  for (std::uint32_t t = 0; t < chart.triangle_count; ++t) {
    const auto id = static_cast<std::uint32_t>(set.triangle_chart.size());
    set.triangle_chart.push_back(static_cast<std::uint32_t>(set.charts.size()));
    set.chart_triangles.push_back(id);
    for (int k = 0; k < 3; ++k) {
      const std::uint32_t uv = chart.first_uv + triangles[3 * t + k];
      set.triangle_uv.push_back(uv);
      mesh_.indices.push_back(set.uv_vertex[uv]);
    }
  }
  set.charts.push_back(chart);
}

void ChartedMeshBuilder::add_grid(int nu, int nv, const Map& at, const Keep& keep) {
  std::vector<Vertex> vertices;
  std::vector<std::uint32_t> triangles;
  std::map<std::pair<int, int>, std::uint32_t> ids;
  const auto id = [&](int i, int j) {
    const auto [entry, fresh] =
        ids.emplace(std::pair(i, j), static_cast<std::uint32_t>(vertices.size()));
    if (fresh) vertices.push_back(at(double(i) / nu, double(j) / nv));
    return entry->second;
  };
  for (int j = 0; j < nv; ++j) {
    for (int i = 0; i < nu; ++i) {
      if (keep && !keep(i, j)) continue;
      const std::uint32_t a = id(i, j), b = id(i + 1, j), c = id(i + 1, j + 1), d = id(i, j + 1);
      const bool rising = noise(static_cast<std::uint32_t>(i), static_cast<std::uint32_t>(j)) & 1U;
      const std::vector<std::uint32_t> quad =
          rising ? std::vector{a, b, c, a, c, d} : std::vector{a, b, d, b, c, d};
      triangles.insert(triangles.end(), quad.begin(), quad.end());
    }
  }
  add_chart(vertices, triangles);
}

void ChartedMeshBuilder::flip(std::uint32_t t) {
  std::swap(mesh_.indices[3 * t + 1], mesh_.indices[3 * t + 2]);
  std::swap(mesh_.charts.triangle_uv[3 * t + 1], mesh_.charts.triangle_uv[3 * t + 2]);
  mesh_.charts.flipped_triangles.push_back(t);
}

ChartedMesh box(int n, double size, Vec3d corner) {
  ChartedMeshBuilder builder;
  for (int axis = 0; axis < 3; ++axis) {
    for (const int side : {0, 1}) {
      builder.add_grid(n, n, [&](double s, double t) {
        double p[3];
        p[axis] = side;
        p[(axis + 1) % 3] = side ? s : t;
        p[(axis + 2) % 3] = side ? t : s;
        return ChartedMeshBuilder::Vertex{
            {as_float(corner.x + size * p[0]), as_float(corner.y + size * p[1]),
             as_float(corner.z + size * p[2])},
            {size * s, size * t}};
      });
    }
  }
  return builder.build();
}

ChartedMesh sphere(int n) {
  ChartedMeshBuilder builder;
  for (int axis = 0; axis < 3; ++axis) {
    for (const int side : {0, 1}) {
      builder.add_grid(n, n, [&](double s, double t) {
        // Points that faces share must be bitwise equal, so everything is computed from the point
        // on the cube.
        double p[3];
        p[axis] = side ? 1 : -1;
        p[(axis + 1) % 3] = 2 * (side ? s : t) - 1;
        p[(axis + 2) % 3] = 2 * (side ? t : s) - 1;
        double q[3];
        for (int k = 0; k < 3; ++k) q[k] = std::tan(p[k] * kPi / 4);
        const double squares[3] = {q[0] * q[0], q[1] * q[1], q[2] * q[2]};
        const double low = std::min({squares[0], squares[1], squares[2]}),
                     high = std::max({squares[0], squares[1], squares[2]}),
                     middle = squares[0] + squares[1] + squares[2] - low - high;
        const double r = std::sqrt(low + middle + high);
        const float x = as_float(as_float(q[0] / r)), y = as_float(as_float(q[1] / r)),
                    z = as_float(as_float(q[2] / r));
        const double u = q[(axis + 1) % 3] / r, v = q[(axis + 2) % 3] / r;
        return ChartedMeshBuilder::Vertex{{x, y, z},
                                          side ? Vec2d{u + 1, v + 1} : Vec2d{v + 1, u + 1}};
      });
    }
  }
  return builder.build();
}

ChartedMesh plate_with_hole(int n) {
  ChartedMeshBuilder builder;
  builder.add_grid(
      n, n,
      [](double s, double t) {
        return ChartedMeshBuilder::Vertex{{as_float(s), as_float(0.6 * t), as_float(0.8 * t)},
                                          {s, t}};
      },
      [n](int i, int j) { return i < n / 3 || i >= 2 * n / 3 || j < n / 3 || j >= 2 * n / 3; });
  return builder.build();
}

ChartedMesh cylinder(int n, bool cut) {
  ChartedMeshBuilder builder;
  const int charts = cut ? 1 : 2;
  for (int c = 0; c < charts; ++c) {
    builder.add_grid(n / charts, n, [&](double s, double t) {
      const int step = static_cast<int>(std::lround(s * (n / charts))) + c * (n / charts);
      const double angle = 2 * kPi * (step % n) / n;  // both sides of the cut are bitwise equal
      return ChartedMeshBuilder::Vertex{
          {as_float(std::cos(angle)), as_float(std::sin(angle)), as_float(2 * t)},
          {2 * kPi * s / charts, 2 * t}};
    });
  }
  return builder.build();
}

ChartedMesh bumpy(int n, double amplitude) {
  ChartedMeshBuilder builder;
  builder.add_grid(n, n, [&](double s, double t) {
    const auto i = static_cast<std::uint32_t>(std::lround(s * n)),
               j = static_cast<std::uint32_t>(std::lround(t * n));
    const double h = amplitude * (std::sin(7 * s) * std::cos(5 * t) +
                                  0.02 * (noise(i, j) % 1000 / 1000.0 - 0.5));
    return ChartedMeshBuilder::Vertex{{as_float(s), as_float(t), as_float(h)}, {s, t}};
  });
  return builder.build();
}

ChartedMesh partition(int n) {
  ChartedMeshBuilder builder;
  for (int wall = 0; wall < 3; ++wall) {
    builder.add_grid(n, n, [&](double s, double t) {
      const double x = wall == 0 ? s : wall == 1 ? -s : 0, y = wall == 2 ? s : 0;
      return ChartedMeshBuilder::Vertex{{as_float(x), as_float(y), as_float(t)}, {s, t}};
    });
  }
  return builder.build();
}

ChartedMesh wall_on_field(int n, double amplitude) {
  const auto height = [amplitude](double s, double t) {
    return as_float(amplitude * std::sin(5 * s) * std::cos(4 * t));
  };
  ChartedMeshBuilder builder;
  builder.add_grid(n, n, [&](double s, double t) {
    return ChartedMeshBuilder::Vertex{{as_float(s), as_float(t), height(s, t)}, {s, t}};
  });
  builder.add_grid(n / 2, n / 4, [&](double s, double t) {  // over the middle of the field
    const double x = 0.25 + s / 2, z = height(x, 0.5) * (1 - t) + 0.5 * t;
    return ChartedMeshBuilder::Vertex{{as_float(x), 0.5F, as_float(z)}, {x, z + 1}};
  });
  return builder.build();
}

ChartedMesh torus(int n) {
  ChartedMeshBuilder builder;
  builder.add_grid(3 * n, n, [n](double s, double t) {
    const double a = 2 * kPi * (std::lround(s * 3 * n) % (3 * n)) / (3 * n),
                 b = 2 * kPi * (std::lround(t * n) % n) / n;
    const double r = 3 + std::cos(b);
    return ChartedMeshBuilder::Vertex{
        {as_float(r * std::cos(a)), as_float(r * std::sin(a)), as_float(std::sin(b))},
        {6 * kPi * s, 2 * kPi * t}};
  });
  return builder.build();
}

ChartedMesh moebius(int n) {
  ChartedMeshBuilder builder;
  builder.add_grid(6 * n, n, [n](double s, double t) {
    const int step = static_cast<int>(std::lround(s * 6 * n)),
              row = static_cast<int>(std::lround(t * n));
    // After one turn around, the row runs the other way.
    const double a = 2 * kPi * (step % (6 * n)) / (6 * n);
    const double w = 2.0 * (step == 6 * n ? n - row : row) / n - 1;
    const double r = 4 + w * std::cos(a / 2);
    return ChartedMeshBuilder::Vertex{
        {as_float(r * std::cos(a)), as_float(r * std::sin(a)), as_float(w * std::sin(a / 2))},
        {8 * kPi * s, 2 * t}};
  });
  return builder.build();
}

ChartedMesh two_sided(int n) {
  ChartedMeshBuilder builder;
  for (const bool back : {false, true}) {
    builder.add_grid(n, n, [back](double s, double t) {
      return ChartedMeshBuilder::Vertex{{as_float(back ? t : s), as_float(back ? s : t), 0},
                                        {s, t}};
    });
  }
  return builder.build();
}

ChartedMesh touching_plates(int n, int m) {
  ChartedMeshBuilder builder;
  builder.add_grid(n, n, [](double s, double t) {
    return ChartedMeshBuilder::Vertex{{as_float(s), as_float(t - 1), 0}, {s, t}};
  });
  builder.add_grid(m, m, [](double s, double t) {
    return ChartedMeshBuilder::Vertex{{as_float(s), 0, as_float(t)}, {s, t}};
  });
  return builder.build();
}

ChartedMesh patchwork(int n, int holes, double amplitude, std::uint32_t seed) {
  constexpr int kSites = 9, kLabels = 8;
  const auto label = [&](int i, int j) {
    int best = 0;
    double least = 1e300;
    for (int k = 0; k < kSites; ++k) {
      const auto id = static_cast<std::uint32_t>(k);
      const double x = noise(seed, 2 * id) % 1000 / 1000.0 * n,
                   y = noise(seed, 2 * id + 1) % 1000 / 1000.0 * n;
      const double d = std::hypot(i - x, j - y) *
                       (1 + noise(static_cast<std::uint32_t>(i + 31 * j), seed) % 100 / 400.0);
      if (d < least) {
        least = d;
        best = k % kLabels;
      }
    }
    return best;
  };
  ChartedMeshBuilder builder;
  for (int chart = holes; chart < kLabels; ++chart) {
    bool any = false;
    for (int i = 0; i < n * n && !any; ++i) any = label(i % n, i / n) == chart;
    if (!any) continue;
    builder.add_grid(
        n, n,
        [&](double s, double t) {
          const double h = amplitude * std::sin(5 * s + seed) * std::cos(4 * t);
          return ChartedMeshBuilder::Vertex{{as_float(s), as_float(t), as_float(h)}, {s, t}};
        },
        [&](int i, int j) { return label(i, j) == chart; });
  }
  return builder.build();
}

}  // namespace atlas::simplify_test
