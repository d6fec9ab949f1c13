#include "benchmarks/tone/light_scenes.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <glm/geometric.hpp>
#include <numbers>
#include <utility>

#include "examples/cabin/layout.h"
#include "examples/cabin/lighting.h"
#include "examples/cabin/lit_cabin.h"
#include "examples/cabin/primitives.h"
#include "examples/cabin/refine.h"
#include "examples/cabin/tracer.h"
#include "examples/cabin/write.h"
#include "libatlas/core/luma.h"

namespace atlas::bench {
namespace {

using cabin::AreaLight;
using cabin::Builder;
using cabin::Lights;
using cabin::Mesh;
using cabin::SurfaceMaterial;
using glm::dvec3;

constexpr double kEdge = 0.3;  // metres; refinement makes shorter ones where the light changes
constexpr std::size_t kTriangles = 24000;

std::vector<SurfaceMaterial> materials() {
  const auto plain = [](const char* name, glm::vec3 diffuse) {
    SurfaceMaterial m;
    m.name = name;
    m.diffuse = m.reflectance = diffuse;
    return m;
  };
  std::vector<SurfaceMaterial> list{
      plain("wall", {0.65f, 0.63f, 0.58f}),  plain("ceiling", {0.8f, 0.8f, 0.78f}),
      plain("floor", {0.34f, 0.27f, 0.2f}),  plain("wood", {0.4f, 0.25f, 0.14f}),
      plain("cloth", {0.16f, 0.24f, 0.36f}), plain("stone", {0.45f, 0.44f, 0.42f}),
      plain("grass", {0.14f, 0.22f, 0.08f}), plain("lamp", glm::vec3(1))};
  return list;
}

struct Sheet {
  dvec3 corner, u, v;  // it faces along u x v
};

void add(Builder& builder, const char* material, const Sheet& sheet) {
  builder.begin(material, material);
  cabin::GridShape shape;
  shape.surface = [&](double a, double b) { return sheet.corner + a * sheet.u + b * sheet.v; };
  shape.nu = builder.segments(glm::length(sheet.u));
  shape.nv = builder.segments(glm::length(sheet.v));
  cabin::add_grid(builder, shape);
}

void add_block(Builder& builder, const char* material, dvec3 low, dvec3 high) {
  const dvec3 x(high.x - low.x, 0, 0), y(0, high.y - low.y, 0), z(0, 0, high.z - low.z);
  add(builder, material, {low, y, x});
  add(builder, material, {low + z, x, y});
  add(builder, material, {low, x, z});
  add(builder, material, {low + y, z, x});
  add(builder, material, {low, z, y});
  add(builder, material, {low + x, y, z});
}

// Adds a room from the origin to `size` without its wall at the largest x, and that wall unless it
// is to have a window.
void add_room(Builder& builder, dvec3 size, bool window = false) {
  const dvec3 x(size.x, 0, 0), y(0, size.y, 0), z(0, 0, size.z);
  add(builder, "floor", {{}, x, y});
  add(builder, "ceiling", {z, y, x});
  add(builder, "wall", {{}, z, x});
  add(builder, "wall", {y, x, z});
  add(builder, "wall", {{}, y, z});
  if (!window) add(builder, "wall", {x, z, y});
}

AreaLight light_of(const Sheet& sheet, glm::vec3 exitance) {
  const dvec3 &a = sheet.corner, &u = sheet.u, &v = sheet.v;
  return {{glm::vec3(a), glm::vec3(a + v), glm::vec3(a + u + v), glm::vec3(a + u)},
          exitance,
          glm::vec3(glm::normalize(glm::cross(u, v)))};
}

// Adds a lamp that is seen as bright as it is.
void add_lamp(Builder& builder, Lights& lights, const Sheet& sheet, glm::vec3 exitance) {
  add(builder, "lamp", sheet);
  lights.areas.push_back(light_of(sheet, exitance));
}

// The sky above a yard: facets of a dome, all of one exitance.
void add_sky(Lights& lights, dvec3 centre, glm::vec3 exitance) {
  constexpr int kAround = 10, kUp = 4;
  constexpr double kRadius = 60;
  const auto at = [&](int i, int k) {
    const double azimuth = 2 * std::numbers::pi * i / kAround, up = std::numbers::pi / 2 * k / kUp;
    return glm::vec3(centre + kRadius * dvec3(std::cos(azimuth) * std::cos(up),
                                              std::sin(azimuth) * std::cos(up), std::sin(up)));
  };
  for (int k = 0; k < kUp; ++k)
    for (int i = 0; i < kAround; ++i) {
      AreaLight facet{{at(i, k), at(i + 1, k), at(i + 1, k + 1)}, exitance, {}};
      if (k + 1 < kUp) facet.corners.push_back(at(i, k + 1));
      facet.normal = glm::normalize(
          glm::cross(facet.corners[2] - facet.corners[0], facet.corners[1] - facet.corners[0]));
      lights.areas.push_back(std::move(facet));
    }
}

struct Made {
  Mesh mesh;
  Lights lights;
};

// Lights what was built, refines it where the light changes, and shows lamps as bright as they are.
Made lit(const Builder& builder, Lights lights, const Context& context) {
  Made made{builder.finish(materials()), std::move(lights)};
  Mesh& mesh = made.mesh;
  const auto lamp = std::find_if(mesh.materials.begin(), mesh.materials.end(),
                                 [](const SurfaceMaterial& m) { return m.name == "lamp"; });
  for (const AreaLight& light : made.lights.areas)
    lamp->emission = glm::max(lamp->emission, light.exitance);
  const cabin::Shell shell = cabin::shell_of(mesh);
  const cabin::Tracer tracer(shell.positions, shell.triangles);
  const cabin::LightingOptions options{1, 96, 192};
  const cabin::Lighting lighting(tracer, made.lights, options);
  lighting.light_directly(mesh, 0, context);
  lighting.light_indirectly(mesh, context);
  cabin::refine(mesh, {std::max(kTriangles, mesh.triangles.size()), 8}, lighting, context);
  for (const cabin::Triangle& t : mesh.triangles) {
    const glm::vec3 emission = mesh.materials[t.material].emission;
    if (emission == glm::vec3(0)) continue;
    for (const cabin::Id v : t.vertex) mesh.direct[v] = emission, mesh.indirect[v] = glm::vec3(0);
  }
  return made;
}

void furnish(Builder& builder) {
  add_block(builder, "wood", {1.6, 1.4, 0.68}, {3.2, 2.3, 0.74});
  add_block(builder, "wood", {1.7, 1.5, 0}, {1.8, 1.6, 0.68});
  add_block(builder, "wood", {3, 2.1, 0}, {3.1, 2.2, 0.68});
  add_block(builder, "cloth", {3.6, 0.3, 0}, {4.5, 1.3, 0.45});
  add_block(builder, "wood", {0.02, 3, 0}, {0.5, 3.98, 1.9});
}

// A lamp under the ceiling that shines up, so that the ceiling above it is a hot spot.
Made hot_spot(const Context& context) {
  Builder builder(kEdge, false);
  add_room(builder, {6, 4, 3});
  furnish(builder);
  Lights lights;
  add_block(builder, "wood", {2.8, 1.8, 2.6}, {3.2, 2.2, 2.68});
  add_lamp(builder, lights, {{2.82, 1.82, 2.69}, {0.36, 0, 0}, {0, 0.36, 0}},
           {16000, 15000, 13000});
  return lit(builder, std::move(lights), context);
}

// A room with a window at the largest x.
Made with_window(glm::vec3 sky, const cabin::Sun& sun, const Context& context) {
  Builder builder(kEdge, false);
  const dvec3 size(5, 4, 2.8);
  add_room(builder, size, true);
  furnish(builder);
  const double low = 0.9, high = 2.3, left = 1.2, right = 2.8;
  const dvec3 x(size.x, 0, 0), y(0, 1, 0), z(0, 0, 1);
  add(builder, "wall", {x, low * z, size.y * y});
  add(builder, "wall", {x + high * z, (size.z - high) * z, size.y * y});
  add(builder, "wall", {x + low * z, (high - low) * z, left * y});
  add(builder, "wall", {x + low * z + right * y, (high - low) * z, (size.y - right) * y});
  Lights lights{{}, sun};
  const Sheet window{x + low * z + left * y, (high - low) * z, (right - left) * y};
  lights.areas.push_back(light_of(window, sky));
  return lit(builder, std::move(lights), context);
}

Made sun_in_a_corner(const Context& context) {
  const cabin::Sun sun{glm::normalize(glm::vec3(1, -0.42f, 0.42f)), {70000, 64000, 54000}};
  return with_window({6000, 6600, 7600}, sun, context);
}

Made moonlight(const Context& context) {
  return with_window({0.05f, 0.06f, 0.08f}, {}, context);
}

Made visible_lamps(const Context& context) {
  Builder builder(kEdge, false);
  add_room(builder, {8, 6, 2.8});
  furnish(builder);
  Lights lights;
  for (const double x : {1.0, 3.5, 6.0})
    for (const double y : {1.5, 3.9})
      add_lamp(builder, lights, {{x, y, 2.78}, {0, 0.6, 0}, {1.2, 0, 0}}, {5200, 5000, 4600});
  return lit(builder, std::move(lights), context);
}

Made corridor(const Context& context) {
  Builder builder(kEdge, false);
  add_room(builder, {20, 2, 2.5});
  Lights lights;
  for (const double x : {1.5, 7.0, 12.5})
    add_lamp(builder, lights, {{x, 0.85, 2.48}, {0, 0.3, 0}, {0.6, 0, 0}}, {7000, 6600, 5600});
  return lit(builder, std::move(lights), context);
}

void add_yard(Builder& builder) {
  add(builder, "grass", {{}, {16, 0, 0}, {0, 12, 0}});
  add_block(builder, "stone", {0, 0, 0}, {16, 1, 3.5});
  add_block(builder, "stone", {0, 11, 0}, {10, 12, 5});
  add_block(builder, "wall", {0, 1, 0}, {3, 11, 6});
  add_block(builder, "stone", {9, 4, 0}, {11, 6, 0.5});
  add_block(builder, "wood", {12.5, 8, 0}, {15, 10.5, 2.4});
}

Made overcast(const Context& context) {
  Builder builder(2 * kEdge, false);
  add_yard(builder);
  Lights lights;
  add_sky(lights, {8, 6, 0}, {9500, 10000, 10600});
  return lit(builder, std::move(lights), context);
}

Made night(const Context& context) {
  Builder builder(2 * kEdge, false);
  add_yard(builder);
  Lights lights;
  add_sky(lights, {8, 6, 0}, {0.004f, 0.005f, 0.007f});
  add_block(builder, "stone", {7.05, 2.3, 0}, {7.15, 2.4, 3.2});
  add_lamp(builder, lights, {{6.9, 2.45, 3.15}, {0, 0.3, 0}, {0.4, 0, 0}}, {9000, 6500, 3500});
  return lit(builder, std::move(lights), context);
}

Made sample_cabin(const Context& context) {
  constexpr std::size_t kCabinTriangles = 40000;
  Made made{cabin::coarse_cabin(kCabinTriangles, context), cabin::cabin_lights()};
  cabin::light_cabin(made.mesh, kCabinTriangles, {1, 64, 128}, context);
  return made;
}

// Light that is the same everywhere, as of a measuring sphere.
Made even_light(const Context&) {
  Builder builder(kEdge, false);
  add_room(builder, {6, 4, 3});
  furnish(builder);
  Made made{builder.finish(materials()), {}};
  made.mesh.direct.assign(made.mesh.vertices.size(), glm::vec3(50000));
  made.mesh.indirect.assign(made.mesh.vertices.size(), glm::vec3(0));
  return made;
}

// A vase in dark colours, as a scanner gives them: sRGB-encoded, and no light.
Made colour_scan(const Context&) {
  Builder builder(0.01, false);
  builder.begin("vase", "lamp");
  cabin::add_revolved(
      builder, {{0, 0, 0},
                [](double t) { return glm::dvec2(0.08 + 0.05 * std::sin(1.2 + 5 * t), 0.4 * t); },
                0.13,
                0.4});
  Made made{builder.finish(materials()), {}};
  for (const cabin::Vertex& v : made.mesh.vertices) {
    const float band = 0.5f + 0.5f * std::sin(60 * v.position.z);
    made.mesh.direct.push_back(glm::vec3(0.32f, 0.12f, 0.08f) * band +
                               glm::vec3(0.05f, 0.16f, 0.22f) * (1 - band));
  }
  made.mesh.indirect.assign(made.mesh.vertices.size(), glm::vec3(0));
  return made;
}

// Tells where light glares: on lamps, and where the sun shines.
std::vector<bool> glare_of(const Made& made) {
  const Mesh& mesh = made.mesh;
  std::vector<bool> glares(mesh.vertices.size());
  for (const cabin::Triangle& t : mesh.triangles)
    for (const cabin::Id v : t.vertex)
      if (mesh.materials[t.material].emission != glm::vec3(0)) glares[v] = true;
  if (made.lights.sun.illuminance == glm::vec3(0)) return glares;
  const cabin::Shell shell = cabin::shell_of(mesh);
  const cabin::Tracer tracer(shell.positions, shell.triangles);
  const cabin::LightingOptions options;
  const cabin::Lighting sunlight(tracer, {{}, made.lights.sun}, options);
  for (std::size_t v = 0; v < glares.size(); ++v)
    if (sunlight.direct_at(mesh.vertices[v]) != glm::vec3(0)) glares[v] = true;
  return glares;
}

std::vector<float> luminance_of(const Mesh& mesh) {
  std::vector<float> result(mesh.vertices.size());
  for (const cabin::Triangle& t : mesh.triangles)
    for (const cabin::Id v : t.vertex) {
      const glm::vec3 y =
          mesh.materials[t.material].reflectance * (mesh.direct[v] + mesh.indirect[v]);
      result[v] = luma(y.x, y.y, y.z);
    }
  return result;
}

}  // namespace

Result<std::vector<LightScene>> make_light_scenes(const std::filesystem::path& folder,
                                                  const Context& context) {
  struct Recipe {
    const char* name;
    std::function<Made(const Context&)> make;
    Quantity quantity = Quantity::illuminance;
  };
  const Recipe kScenes[] = {{"hot spot over a lamp", hot_spot},
                            {"sun in a corner", sun_in_a_corner},
                            {"visible lamps", visible_lamps},
                            {"corridor", corridor},
                            {"yard, overcast", overcast},
                            {"yard at night, one lamp", night},
                            {"cabin", sample_cabin},
                            {"bright and even", even_light},
                            {"moonlight", moonlight},
                            {"colours of a scan", colour_scan, Quantity::colour}};
  std::vector<LightScene> scenes;
  for (const auto& [name, make, quantity] : kScenes) {
    context.say(name);
    const Made made = make(context);
    if (context.cancelled()) return Status::cancelled();
    LightScene& scene = scenes.emplace_back();
    scene.name = name;
    scene.file = folder / ("scene" + std::to_string(scenes.size()) + ".obj");
    scene.quantity = quantity;
    scene.shell = cabin::shell_of(made.mesh);
    scene.luminance = luminance_of(made.mesh);
    scene.glares = glare_of(made);
    if (Status s = cabin::write_scene(scene.file, made.mesh, false, context); !s.ok()) return s;
  }
  return scenes;
}

}  // namespace atlas::bench
