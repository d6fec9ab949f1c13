// Computes the illuminance at the cabin's vertices: directly from the sun, the sky in the windows
// and the strips, and indirectly from surfaces that light each other.
#pragma once

#include <cstdint>
#include <span>

#include "examples/cabin/layout.h"
#include "examples/cabin/tracer.h"
#include "libatlas/core/context.h"

namespace cabin {

struct Sun {
  glm::vec3 towards{0, 0, 1};  // unit
  glm::vec3 illuminance{0};    // lux on a surface that faces it
  float radius = 0.008f;       // of its disc, radians
};

struct LightingOptions {
  std::uint32_t seed = 1;
  int direct_samples = 64;     // shadow rays per vertex, shared among its lights
  int indirect_samples = 384;  // gathering rays per vertex of the coarse mesh
};

struct Lights {
  std::vector<AreaLight> areas;  // at most 128
  Sun sun = {};                  // none if its illuminance is 0
};

class Lighting {
 public:
  // Keeps references to the tracer and the options, so both must outlive the object.
  Lighting(const Tracer& tracer, Lights lights, const LightingOptions& options);

  // Returns the illuminance directly from the lights, in lux. The same position gives the same
  // result, independently of other calls and of their order.
  glm::vec3 direct_at(const Vertex& vertex) const;

  // Computes direct_at for the vertices from `first` on, in parallel.
  void light_directly(Mesh& mesh, std::size_t first, const atlas::Context& context) const;

  // Computes mesh.indirect from mesh.direct by radiosity. Hemisphere rays from every vertex are
  // traced and stored once; then light is passed along them for eight bounces. Meant for the coarse
  // mesh that the tracer was made of. Emitters count as black here, because they are lights
  // already.
  void light_indirectly(Mesh& mesh, const atlas::Context& context) const;

 private:
  const Tracer& tracer_;
  const LightingOptions& options_;
  std::vector<AreaLight> lights_;
  Sun sun_;
};

// Returns the strips, the sky in the windows, and the sun.
Lights cabin_lights();

// Gives the vertices of emitting surfaces a part of their own exitance as light, so that lamps look
// lit. To be called at the end, when no more light is gathered.
void show_emitters(Mesh& mesh);

// Returns the exact share (0 to 1) of an unshadowed polygon's exitance that a surface at `point`
// with `normal` receives: Lambert's formula clipped at the horizon (Lambert, Photometria, 1760;
// Baum et al. 1989). The corners run clockwise seen from the point.
float polygon_form_factor(std::span<const glm::vec3> corners, glm::vec3 point, glm::vec3 normal);

}  // namespace cabin
