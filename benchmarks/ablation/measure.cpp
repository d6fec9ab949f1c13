#include "benchmarks/ablation/measure.h"

#include <algorithm>
#include <cmath>
#include <ctime>
#include <map>
#include <numeric>
#include <tuple>
#include <vector>

#include "libatlas/core/random.h"
#include "libatlas/unwrap/unwrap.h"

namespace atlas::bench {
namespace {

using test::Shape;

double thread_seconds() {
  timespec time{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &time);
  return double(time.tv_sec) + 1e-9 * double(time.tv_nsec);
}

// Makes vertices of equal position one.
Shape welded(const Shape& shape) {
  Shape result{shape.name, {}, {}};
  std::map<std::tuple<float, float, float>, std::uint32_t> places;
  for (const std::uint32_t v : shape.indices) {
    const Vec3f p = shape.positions[v];
    const auto [place, is_new] =
        places.try_emplace({p.x, p.y, p.z}, std::uint32_t(result.positions.size()));
    if (is_new) result.positions.push_back(p);
    result.indices.push_back(place->second);
  }
  return result;
}

double mean_edge(const Shape& shape) {
  double sum = 0;
  for (std::size_t t = 0; t < shape.triangle_count(); ++t)
    for (std::size_t k = 0; k < 3; ++k) {
      const Vec3f a = shape.positions[shape.indices[3 * t + k]];
      const Vec3f b = shape.positions[shape.indices[3 * t + (k + 1) % 3]];
      sum += std::hypot(double(a.x) - b.x, double(a.y) - b.y, double(a.z) - b.z);
    }
  return sum / double(shape.indices.size());
}

test::UvMesh uv_mesh(const Shape& shape, const UnwrappedMesh& unwrapped) {
  test::UvMesh mesh;
  for (const Vec3f& p : shape.positions) mesh.positions.push_back({p.x, p.y, p.z});
  for (const Vec2f& uv : unwrapped.uvs) mesh.uvs.push_back({uv.x, uv.y});
  for (std::size_t t = 0; t < shape.triangle_count(); ++t) {
    test::UvMesh::Face face;
    std::copy_n(&shape.indices[3 * t], 3, face.position.begin());
    std::copy_n(&unwrapped.indices[3 * t], 3, face.uv.begin());
    face.page = unwrapped.triangle_page[t];
    mesh.faces.push_back(face);
  }
  mesh.pages = std::uint32_t(unwrapped.pages.size());
  return mesh;
}

}  // namespace

Result<UnwrapFigures> measure_unwrap(const Shape& given, std::uint32_t draw) {
  constexpr double kMoved = 1e-3;  // of a mean edge
  Shape shape = welded(given);
  if (draw > 0) shape = test::noisy(std::move(shape), kMoved * mean_edge(shape), draw);
  MeshView mesh;
  mesh.positions = shape.positions;
  mesh.indices = shape.indices;
  Context context;
  context.threads = 1;
  // The charts are made twice, since their time alone is not reported by the one call.
  double begin = thread_seconds();
  if (Result<ChartSet> charts = make_charts(mesh, {}, context); !charts.ok())
    return charts.status();
  UnwrapFigures figures;
  figures.chart_seconds = thread_seconds() - begin;
  begin = thread_seconds();
  const Result<UnwrappedMesh> unwrapped = unwrap_mesh(mesh, {}, context);
  if (!unwrapped.ok()) return unwrapped.status();
  figures.page_seconds = std::max(0.0, thread_seconds() - begin - figures.chart_seconds);
  const test::UvMesh uvs = uv_mesh(shape, *unwrapped);
  const Extent page = unwrapped->pages[0];
  const test::AtlasMeasures measures = test::measure_atlas(uvs, page.width, page.height);
  figures.charts = unwrapped->charts.charts.size();
  figures.stretch_l2 = measures.stretch_l2;
  figures.stretch_999 = measures.stretch_999;
  figures.page_use = measures.utilization;
  figures.defects = measures.flipped + measures.degenerate + measures.outside + measures.overlap +
                    measures.bleed + measures.mirrored;
  figures.seams = measure_seams(uvs);
  return figures;
}

}  // namespace atlas::bench
