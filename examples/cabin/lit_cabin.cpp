#include "examples/cabin/lit_cabin.h"

#include <fmt/format.h>

#include <algorithm>

namespace cabin {

int default_samples(std::size_t triangles) {
  return triangles <= 200000 ? 192 : triangles <= 1200000 ? 96 : 64;
}

Mesh coarse_cabin(std::size_t triangles, const atlas::Context& context) {
  // Light between surfaces is gathered on at most this many triangles, whatever the final size. It
  // varies slowly, and its cost would otherwise dominate.
  constexpr std::size_t kCoarse = 90000;
  return build_cabin(std::min(kCoarse, triangles * 35 / 100), triangles * 8 / 10, context);
}

void light_cabin(Mesh& mesh, std::size_t triangles, const LightingOptions& options,
                 const atlas::Context& context) {
  const Shell shell = shell_of(mesh);
  if (context.cancelled()) return;
  const Tracer tracer(shell.positions, shell.triangles);
  const Lighting lighting(tracer, cabin_lights(), options);
  lighting.light_directly(mesh, 0, context);
  if (context.cancelled()) return;
  context.say("direct light");
  lighting.light_indirectly(mesh, context);
  if (context.cancelled()) return;
  context.say("indirect light");
  refine(mesh, {triangles, 12}, lighting, context);
  if (context.cancelled()) return;
  show_emitters(mesh);
  context.say(fmt::format("refined: {} triangles, {} vertices", mesh.triangles.size(),
                          mesh.vertices.size()));
}

}  // namespace cabin
