// unwrap_mesh loses nothing, vertices keep what they are copies of, and uvs flip no triangle.
#include "libatlas/unwrap/unwrap.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <stdexcept>
#include <string>
#include <string_view>
#include <thread>
#include <utility>

#include "libatlas/core/clock.h"
#include "libatlas/pipeline/export_world.h"
#include "libatlas/scene/check_scene.h"
#include "libatlas/unwrap/part_gaps.h"
#include "tests/pipeline/lit_scene.h"
#include "tests/pipeline/unwrap_checks.h"
#include "tests/support/shapes.h"
#include "tests/support/slowness.h"
#include "tests/support/temp_folder.h"

namespace atlas::test {
namespace {

TEST(Unwrap, ATorusOnOnePage) {
  const LoadedScene ring = lit_scene(torus(24, 12));
  const auto mesh = unwrap_mesh(view_of(ring.scene), {}, {});
  ASSERT_TRUE(mesh.ok()) << mesh.status().message();
  expect_sound(view_of(ring.scene), *mesh);
  EXPECT_EQ(mesh->pages.size(), 1u);
  EXPECT_GT(mesh->utilization, 0.55);
  EXPECT_GT(mesh->vertices.size(), ring.scene.positions.size());  // because of seams
}

// Vertices at one position have different normals, as renderers need them. A vertex of the result
// is a copy of the vertex that the triangle names, not of another one at the same position.
TEST(Unwrap, VerticesOfOnePlaceStayApart) {
  const Shape cube = box(1);
  std::vector<Vec3f> positions;
  std::vector<std::uint32_t> indices;
  for (const std::uint32_t v : cube.indices) {
    indices.push_back(std::uint32_t(positions.size()));
    positions.push_back(cube.positions[v]);
  }
  MeshView view;
  view.positions = positions;
  view.indices = indices;
  const auto mesh = unwrap_mesh(view, {}, {});
  ASSERT_TRUE(mesh.ok()) << mesh.status().message();
  expect_sound(view, *mesh);
  EXPECT_EQ(mesh->vertices, indices);
  EXPECT_LT(mesh->charts.charts.size(), 6u);  // charts treat equal positions as one
}

// A soup of triangles around one hub, each with its own copy of the hub's vertex. The copies share
// a uv in each chart, and there are as many as triangles.
TEST(Unwrap, AHubOfThousandsIsQuick) {
  constexpr std::uint32_t kSpokes = 80000;
  std::vector<Vec3f> positions;
  std::vector<std::uint32_t> indices;
  const auto rim = [](std::uint32_t k) {
    const double a = 2 * M_PI * (k % kSpokes) / kSpokes;
    return Vec3f{float(std::cos(a)), float(std::sin(a)), 0};
  };
  for (std::uint32_t k = 0; k < kSpokes; ++k) {
    for (const Vec3f& p : {Vec3f{}, rim(k), rim(k + 1)}) {
      indices.push_back(std::uint32_t(positions.size()));
      positions.push_back(p);
    }
  }
  MeshView view;
  view.positions = positions;
  view.indices = indices;
  UnwrapOptions options;
  options.charts.preset = ChartPreset::fast;
  const double begun = cpu_seconds();
  const auto mesh = unwrap_mesh(view, options, {});
  ASSERT_TRUE(mesh.ok()) << mesh.status().message();
  EXPECT_EQ(mesh->vertices, indices);
  EXPECT_LT(cpu_seconds() - begun, 3 * kSlowness);
}

TEST(Unwrap, PagesSquareAndSeveralWithADensity) {
  const LoadedScene scene = lit_room(6);
  UnwrapOptions options;
  options.pages = 3;
  options.page_size = 256;
  const auto several = unwrap_mesh(view_of(scene.scene), options, {});
  ASSERT_TRUE(several.ok()) << several.status().message();
  expect_sound(view_of(scene.scene), *several);
  EXPECT_GT(several->pages.size(), 1u);
  EXPECT_LE(several->pages.size(), 3u);

  options.pages = 1;
  options.square = true;
  options.texels_per_unit = 4;
  const auto coarse = unwrap_mesh(view_of(scene.scene), options, {});
  ASSERT_TRUE(coarse.ok()) << coarse.status().message();
  expect_sound(view_of(scene.scene), *coarse);
  EXPECT_DOUBLE_EQ(coarse->texels_per_unit, 4);
  EXPECT_EQ(coarse->pages[0].width, coarse->pages[0].height);

  options.texels_per_unit = 1e6;  // more than the page holds
  const auto fine = unwrap_mesh(view_of(scene.scene), options, {});
  ASSERT_TRUE(fine.ok()) << fine.status().message();
  EXPECT_LT(fine->texels_per_unit, 1e3);
  EXPECT_GT(fine->texels_per_unit, 4);
}

TEST(Unwrap, MoreTexelsThanPagesHoldAreAsManyAsTheyHold) {
  const LoadedScene ring = lit_scene(torus(24, 12));
  UnwrapOptions options{{.page_size = 128}};
  const auto full = unwrap_mesh(view_of(ring.scene), options, {});
  options.texels_per_unit = 1e300;  // sides of charts in texels would exceed the range of double
  const auto asked = unwrap_mesh(view_of(ring.scene), options, {});
  ASSERT_TRUE(full.ok() && asked.ok()) << asked.status().message();
  EXPECT_EQ(asked->uvs, full->uvs);
}

// Without padding, charts reach the edges of the page, and go beyond them by the rounding of their
// rotation.
TEST(Unwrap, UvsAtThePagesEdgesAreOnIt) {
  for (std::uint64_t seed = 1; seed <= 60; ++seed) {
    const Shape shape = soup(3, seed);
    MeshView view;
    view.positions = shape.positions;
    view.indices = shape.indices;
    const auto mesh = unwrap_mesh(view, {{.page_size = 64, .padding = 0, .square = true}}, {});
    ASSERT_TRUE(mesh.ok()) << mesh.status().message();
    expect_sound(view, *mesh);
  }
}

TEST(Unwrap, UvsOfVerticesAreKept) {
  const LoadedScene ring = lit_scene(torus(24, 12));
  const auto made = unwrap_mesh(view_of(ring.scene), {}, {});
  ASSERT_TRUE(made.ok());
  std::vector<Vec3f> positions;
  for (const std::uint32_t v : made->vertices) positions.push_back(ring.scene.positions[v]);
  MeshView view;
  view.positions = positions;
  view.indices = made->indices;
  view.texcoords = made->uvs;  // one per vertex, so there is no second list of indices
  UnwrapOptions options;
  options.charts.keep_uv_charts = true;
  options.charts.uv_aspect = double(made->pages[0].width) / made->pages[0].height;
  const auto kept = unwrap_mesh(view, options, {});
  ASSERT_TRUE(kept.ok()) << kept.status().message();
  EXPECT_EQ(kept->charts.repairs.kept_charts, made->charts.charts.size());
  EXPECT_EQ(kept->charts.repairs.reflattened_charts, 0u);
}

TEST(Unwrap, WhatTurnsTheWrongWayKeepsItsCorners) {
  LoadedScene ring = lit_scene(torus(24, 12));
  std::swap(ring.scene.indices[3 * 17 + 1], ring.scene.indices[3 * 17 + 2]);
  const auto mesh = unwrap_mesh(view_of(ring.scene), {}, {});
  ASSERT_TRUE(mesh.ok()) << mesh.status().message();
  EXPECT_EQ(mesh->charts.flipped_triangles, std::vector<std::uint32_t>{17});
  expect_sound(view_of(ring.scene), *mesh);
}

// A turn of a spiral ramp. Laid flat its ends nearly meet, although one lies above the other.
TEST(Unwrap, PartsOfAChartAreKeptApartWhereAsked) {
  Shape ramp = grid(60, 6);
  for (Vec3f& p : ramp.positions) {
    const double angle = 6.25 * p.x, radius = 1.4 - 0.4 * p.y;
    p = {float(radius * std::cos(angle)), float(radius * std::sin(angle)), 0.3F * p.x};
  }
  MeshView view;
  view.positions = ramp.positions;
  view.indices = ramp.indices;
  const auto near = [&](const UnwrappedMesh& mesh) {
    return left_part_gaps(view, mesh.charts, mesh.placements, {}).near_after;
  };
  UnwrapOptions options{{.page_size = 128}};
  options.charts.min_fill = 0;  // otherwise a ring would be cut to save page area
  const auto close = unwrap_mesh(view, options, {});
  options.part_gaps = true;
  const auto open = unwrap_mesh(view, options, {});
  ASSERT_TRUE(close.ok() && open.ok());
  ASSERT_EQ(close->charts.charts.size(), 1u);
  ASSERT_EQ(open->charts.charts.size(), 1u);
  EXPECT_EQ(close->gaps.border, 0) << "not measured";
  EXPECT_GT(open->gaps.border, 100);
  EXPECT_GT(near(*close), 10);
  EXPECT_LT(near(*open), 1);
  EXPECT_EQ(near(*open), open->gaps.near_after);
  EXPECT_EQ(open->gaps.charts, 1u);
  EXPECT_LE(open->charts.distortion.stretch_999, options.charts.max_stretch);
  expect_sound(view, *open);
}

TEST(Unwrap, WrongOptionsAreNamed) {
  const LoadedScene ring = lit_scene(torus(12, 8));
  const auto message = [&](auto change) {
    UnwrapOptions options;
    change(options);
    const auto mesh = unwrap_mesh(view_of(ring.scene), options, {});
    return mesh.ok() ? std::string("ok") : mesh.status().message();
  };
  const auto expect = [&](const char* named, auto change) {
    EXPECT_NE(message(change).find(named), std::string::npos) << message(change);
  };
  expect("pages is 0", [](UnwrapOptions& o) { o.pages = 0; });
  expect("page_size is 0", [](UnwrapOptions& o) { o.page_size = 0; });
  expect("page_size is 1000", [](UnwrapOptions& o) {
    o.page_size = 1000;
    o.square = true;
  });
  expect("page_size is 32768", [](UnwrapOptions& o) { o.page_size = 32768; });
  expect("page_size is 1000", [](UnwrapOptions& o) {
    o.page_size = 1000;
    o.pages = 2;
  });
  expect("padding is -1", [](UnwrapOptions& o) { o.padding = -1; });
  expect("padding is 513", [](UnwrapOptions& o) { o.padding = 513; });
  expect("alignment is 1024", [](UnwrapOptions& o) { o.alignment = 1024; });
  expect("mip_levels is -1", [](UnwrapOptions& o) { o.mip_levels = -1; });
  expect("mip_levels is 11", [](UnwrapOptions& o) { o.mip_levels = 11; });
  expect("mip_levels is 5, whose cells of 32 texels", [](UnwrapOptions& o) {
    o.page_size = 64;
    o.mip_levels = 5;
  });
  expect("alignment is 0", [](UnwrapOptions& o) { o.alignment = 0; });
  expect("alignment is 3 (a power of two", [](UnwrapOptions& o) {
    o.alignment = 3;
    o.square = true;
  });
  expect("alignment is 6 (a power of two", [](UnwrapOptions& o) {
    o.alignment = 6;
    o.pages = 2;
  });
  expect("texels_per_unit is nan",
         [](UnwrapOptions& o) { o.texels_per_unit = std::numeric_limits<double>::quiet_NaN(); });
  expect("do not fit 1 page of 64 x 64", [](UnwrapOptions& o) {
    o.page_size = 64;
    o.square = true;
    o.padding = 16;
  });
}

// Calls from several threads on the same input give what a single call gives, as context.h
// guarantees.
TEST(ManyThreads, UnwrapAndExportAtOnce) {
  const TempFolder folder;
  const LoadedScene scene = lit_room(4);
  const auto alone = unwrap_mesh(view_of(scene.scene), {}, {});
  ASSERT_TRUE(alone.ok());
  std::vector<std::vector<Vec2f>> uvs(4);
  std::vector<Status> exported(4);
  std::vector<std::thread> threads;
  const char* targets[] = {"a.wrl", "a.gltf", "a.obj", "a.wrl"};  // their pages have the same name
  for (std::size_t i = 0; i < 4; ++i) {
    threads.emplace_back([&, i] {
      const auto mesh = unwrap_mesh(view_of(scene.scene), {}, {});
      if (mesh.ok()) uvs[i] = mesh->uvs;
      ExportOptions options;
      options.target = folder / targets[i];
      options.atlas_size = 128;
      exported[i] = export_world(scene, options, {}, {}).status();
    });
  }
  for (std::thread& thread : threads) thread.join();
  for (std::size_t i = 0; i < 4; ++i) {
    EXPECT_EQ(uvs[i], alone->uvs);
    EXPECT_TRUE(exported[i].ok()) << exported[i].message();
  }
  for (const char* target : {"a.wrl", "a.gltf"}) {
    const auto read = read_scene(folder / target, {}, {});
    EXPECT_TRUE(read.ok() && read->defects.empty()) << target;
  }
}

// Also if pages are packed several times and charts are cut.
TEST(Unwrap, ProgressEndsAtOne) {
  const LoadedScene ring = lit_scene(torus(24, 12));
  const Shape strip = grid(240, 2, 6, 0.05);
  MeshView long_strip;
  long_strip.positions = strip.positions;
  long_strip.indices = strip.indices;
  Context context;
  std::string last;
  double fraction = -1;
  context.progress = [&](std::string_view stage, double f) {
    if (stage != last) {
      EXPECT_TRUE(last.empty() || fraction == 1) << last << " ended at " << fraction;
    } else {
      EXPECT_GE(f, fraction) << stage;
    }
    last = stage;
    fraction = f;
  };
  const UnwrapOptions free{{.page_size = 256, .preset = PackPreset::fast}},
      square{{.page_size = 256, .square = true}},
      several{{.pages = 4, .page_size = 256, .preset = PackPreset::fast}};
  for (const MeshView& mesh : {view_of(ring.scene), long_strip}) {
    for (const UnwrapOptions& options : {free, square, several}) {
      last.clear();
      fraction = -1;
      ASSERT_TRUE(unwrap_mesh(mesh, options, context).ok());
      EXPECT_EQ(fraction, 1);
    }
  }
}

// Also if no parts are too near, so that pages are packed only once.
TEST(Unwrap, ProgressEndsAtOneWithPartsKeptApart) {
  const Shape sheet = grid(4, 4);
  MeshView view;
  view.positions = sheet.positions;
  view.indices = sheet.indices;
  Context context;
  double fraction = 0;
  context.progress = [&](std::string_view stage, double f) {
    if (stage != "packing") return;
    EXPECT_GE(f, fraction);
    fraction = f;
  };
  UnwrapOptions options{{.page_size = 64}};
  options.part_gaps = true;
  ASSERT_TRUE(unwrap_mesh(view, options, context).ok());
  EXPECT_EQ(fraction, 1);
}

TEST(Unwrap, ACallbacksExceptionComesOut) {
  const LoadedScene ring = lit_scene(torus(24, 12));
  Context context;
  context.progress = [](std::string_view, double) { throw std::runtime_error("mine"); };
  EXPECT_THROW((void)unwrap_mesh(view_of(ring.scene), {}, context), std::runtime_error);
  const TempFolder folder;
  ExportOptions options;
  options.target = folder / "a.wrl";
  context.progress = [](std::string_view stage, double fraction) {
    if (stage == "writing" && fraction > 0) throw std::runtime_error("mine");
  };
  EXPECT_THROW((void)export_world(ring, options, {}, context), std::runtime_error);
  EXPECT_EQ(folder.count(), 0u);
}

// A scene from a program's own arrays, also one without materials, and one with inconsistent
// arrays.
TEST(HandMadeScene, IsExportedOrRefusedByName) {
  const TempFolder folder;
  LoadedScene loaded = lit_scene(torus(24, 12));
  loaded.scene.materials.clear();
  loaded.scene.triangle_material.clear();
  loaded.scene.triangle_object.clear();
  ExportOptions options;
  options.target = folder / "world.glb";
  options.atlas_size = 256;
  auto report = export_world(loaded, options, {}, {});
  ASSERT_FALSE(report.ok());
  EXPECT_NE(report.status().message().find("complete_scene()"), std::string::npos)
      << report.status().message();
  ASSERT_TRUE(complete_scene(loaded.scene).ok());
  report = export_world(loaded, options, {}, {});
  EXPECT_TRUE(report.ok()) << report.status().message();
  loaded.scene.indices[7] = 1u << 30;
  report = export_world(loaded, options, {}, {});
  ASSERT_FALSE(report.ok());
  EXPECT_NE(report.status().message().find("indices[7]"), std::string::npos)
      << report.status().message();
}

}  // namespace
}  // namespace atlas::test
