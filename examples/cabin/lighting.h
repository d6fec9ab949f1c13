// Illuminance at the cabin's vertices: the sun, the sky in the windows and the strips directly, and
// what the surfaces send each other.
#pragma once

#include <cstdint>
#include <span>

#include "examples/cabin/layout.h"
#include "examples/cabin/tracer.h"
#include "libatlas/core/context.h"

namespace cabin {

struct Sun {
  glm::vec3 towards;      // unit
  glm::vec3 illuminance;  // lux on a surface that faces it
  float radius;           // of its disc, radians
};

struct LightingOptions {
  std::uint32_t seed = 1;
  int direct_samples = 64;     // shadow rays a vertex, shared among its lights
  int indirect_samples = 384;  // gathering rays a vertex of the coarse mesh
};

class Lighting {
 public:
  // Keeps references: both must outlive it.
  Lighting(const Tracer& tracer, const LightingOptions& options);

  // Illuminance straight from the lights, lux. The same place gives the same answer, whatever else
  // is asked and in whichever order.
  glm::vec3 direct_at(const Vertex& vertex) const;

  // direct_at for the vertices from `first` on, in parallel.
  void light_directly(Mesh& mesh, std::size_t first, const atlas::Context& context) const;

  // Fills mesh.indirect from mesh.direct by radiosity: hemisphere rays from every vertex are traced
  // once and kept, then light is passed along them until the bounces die away. Meant for the coarse
  // mesh that the tracer was made of; emitters count as black here, being lights already.
  void light_indirectly(Mesh& mesh, const atlas::Context& context) const;

 private:
  const Tracer& tracer_;
  const LightingOptions& options_;
  std::vector<AreaLight> lights_;
  Sun sun_;
};

Sun cabin_sun();

// Gives the vertices of emitting surfaces a part of what they shine with as their light, so that
// lamps look lit: at the end, when nothing gathers any more.
void show_emitters(Mesh& mesh);

// The share (0..1) of an unshadowed polygon's exitance that a surface at `point` with `normal`
// receives, exactly: Lambert's formula clipped at the horizon (Lambert, Photometria, 1760; Baum et
// al. 1989). Corners run clockwise seen from the point.
float polygon_form_factor(std::span<const glm::vec3> corners, glm::vec3 point, glm::vec3 normal);

}  // namespace cabin
