#include "benchmarks/support/work.h"

#include "examples/cabin/lit_cabin.h"

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

Result<LoadedScene> make_cabin(std::uint64_t triangles, const Context& context) {
  cabin::Mesh mesh = cabin::coarse_cabin(triangles);
  cabin::LightingOptions options;
  options.direct_samples = cabin::default_samples(triangles);
  cabin::light_cabin(mesh, triangles, options, context);
  return scene_of(std::move(mesh));
}

}  // namespace atlas::bench
