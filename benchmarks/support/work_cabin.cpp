#include "benchmarks/support/work.h"

#include <algorithm>

#include "examples/cabin/refine.h"

namespace atlas::bench {
namespace {

LoadedScene scene_of(cabin::Mesh&& mesh) {
  LoadedScene loaded;
  Scene& scene = loaded.scene;
  for (std::size_t i = 0; i < mesh.vertices.size(); ++i) {
    const glm::vec3 p = mesh.vertices[i].position, e = mesh.direct[i] + mesh.indirect[i];
    scene.positions.push_back({p.x, p.y, p.z});
    scene.illumination.push_back({e.x, e.y, e.z});
  }
  for (const glm::vec2& uv : mesh.texcoords) scene.texcoords.push_back({uv.x, uv.y});
  for (const cabin::Triangle& t : mesh.triangles) {
    scene.indices.insert(scene.indices.end(), t.vertex.begin(), t.vertex.end());
    scene.texcoord_indices.insert(scene.texcoord_indices.end(), t.texcoord.begin(),
                                  t.texcoord.end());
    scene.triangle_material.push_back(t.material);
    scene.triangle_object.push_back(t.object);
  }
  for (cabin::SurfaceMaterial& m : mesh.materials) {
    Material material{m.name, {m.diffuse.x, m.diffuse.y, m.diffuse.z}, -1};
    if (!m.texture_file.empty()) {
      material.texture = std::int32_t(scene.textures.size());
      scene.textures.push_back({m.texture_file, std::move(m.texture)});
    }
    scene.materials.push_back(material);
  }
  scene.object_names = mesh.objects;
  return loaded;
}

}  // namespace

// As atlas-make-cabin does it, with fewer rays: what is measured is the export, not the light.
Result<LoadedScene> make_cabin(std::uint64_t triangles, const Context& context) {
  constexpr std::size_t kCoarse = 60000;
  cabin::Mesh mesh =
      cabin::build_cabin(std::min<std::size_t>(kCoarse, triangles * 35 / 100), triangles * 8 / 10);
  const cabin::Shell shell = cabin::shell_of(mesh);
  const cabin::Tracer tracer(shell.positions, shell.triangles);
  cabin::LightingOptions options;
  options.direct_samples = 32;
  options.indirect_samples = 48;
  const cabin::Lighting lighting(tracer, options);
  lighting.light_directly(mesh, 0, context);
  lighting.light_indirectly(mesh, context);
  cabin::refine(mesh, {std::size_t(triangles), 12}, lighting, context);
  cabin::show_emitters(mesh);
  return scene_of(std::move(mesh));
}

}  // namespace atlas::bench
