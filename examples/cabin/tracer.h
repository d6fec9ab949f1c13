// Traces rays against a triangle mesh. Only its implementation uses Embree (version 3 or 4).
#pragma once

#include <array>
#include <cstdint>
#include <glm/vec3.hpp>
#include <memory>
#include <span>

namespace cabin {

struct Hit {
  std::uint32_t triangle = ~0u;  // ~0: nothing was hit
  float u = 0, v = 0;            // weights of the triangle's second and third corner
  float distance = 0;
  bool front = false;  // the ray hit the side that the triangle faces
};

class Tracer {
 public:
  // Keeps its own copy of everything. Throws std::runtime_error if Embree cannot be started.
  Tracer(std::span<const glm::vec3> positions,
         std::span<const std::array<std::uint32_t, 3>> triangles);
  ~Tracer();
  Tracer(const Tracer&) = delete;
  Tracer& operator=(const Tracer&) = delete;

  // Both may be called from many threads at once.
  Hit nearest(glm::vec3 origin, glm::vec3 direction) const;
  bool blocked(glm::vec3 origin, glm::vec3 direction, float distance) const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace cabin
