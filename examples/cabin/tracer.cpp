#include "examples/cabin/tracer.h"

#include <cstring>
#include <glm/geometric.hpp>
#include <limits>
#include <stdexcept>

#include "examples/cabin/embree.h"

namespace cabin {
namespace {

constexpr float kEndless = std::numeric_limits<float>::infinity();

template <class Ray>
void set_ray(Ray& ray, glm::vec3 origin, glm::vec3 direction, float distance) {
  ray.org_x = origin.x;
  ray.org_y = origin.y;
  ray.org_z = origin.z;
  ray.dir_x = direction.x;
  ray.dir_y = direction.y;
  ray.dir_z = direction.z;
  ray.tnear = 0;
  ray.tfar = distance;
  ray.mask = ~0u;
  ray.flags = 0;
  ray.time = 0;
}

}  // namespace

struct Tracer::Impl {
  RTCDevice device = nullptr;
  RTCScene scene = nullptr;
  ~Impl() {
    if (scene) rtcReleaseScene(scene);
    if (device) rtcReleaseDevice(device);
  }
};

Tracer::Tracer(std::span<const glm::vec3> positions,
               std::span<const std::array<std::uint32_t, 3>> triangles)
    : impl_(std::make_unique<Impl>()) {
  impl_->device = rtcNewDevice(nullptr);
  if (!impl_->device) throw std::runtime_error("Embree could not be started");
  impl_->scene = rtcNewScene(impl_->device);
  // Robust: no ray passes through the edge between two triangles, where it would look like a light
  // leak. High quality: the tree is built once and used for a hundred million rays.
  rtcSetSceneFlags(impl_->scene, RTC_SCENE_FLAG_ROBUST);
  rtcSetSceneBuildQuality(impl_->scene, RTC_BUILD_QUALITY_HIGH);
  RTCGeometry geometry = rtcNewGeometry(impl_->device, RTC_GEOMETRY_TYPE_TRIANGLE);
  void* position_buffer = rtcSetNewGeometryBuffer(
      geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, sizeof(glm::vec3), positions.size());
  void* triangle_buffer =
      rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3,
                              3 * sizeof(std::uint32_t), triangles.size());
  if (!position_buffer || !triangle_buffer)
    throw std::runtime_error("Embree has no memory for the mesh");
  std::memcpy(position_buffer, positions.data(), positions.size_bytes());
  std::memcpy(triangle_buffer, triangles.data(), triangles.size_bytes());
  rtcCommitGeometry(geometry);
  rtcAttachGeometry(impl_->scene, geometry);
  rtcReleaseGeometry(geometry);
  rtcCommitScene(impl_->scene);
}

Tracer::~Tracer() = default;

Hit Tracer::nearest(glm::vec3 origin, glm::vec3 direction) const {
  RTCRayHit query;
  set_ray(query.ray, origin, direction, kEndless);
  query.hit.geomID = RTC_INVALID_GEOMETRY_ID;
  query.hit.primID = RTC_INVALID_GEOMETRY_ID;
  query.hit.instID[0] = RTC_INVALID_GEOMETRY_ID;
  intersect(impl_->scene, query);
  Hit hit;
  if (query.hit.geomID == RTC_INVALID_GEOMETRY_ID) return hit;
  hit.triangle = query.hit.primID;
  hit.u = query.hit.u;
  hit.v = query.hit.v;
  hit.distance = query.ray.tfar;
  hit.front = glm::dot(glm::vec3(query.hit.Ng_x, query.hit.Ng_y, query.hit.Ng_z), direction) < 0;
  return hit;
}

bool Tracer::blocked(glm::vec3 origin, glm::vec3 direction, float distance) const {
  RTCRay ray;
  set_ray(ray, origin, direction, distance);
  return occluded(impl_->scene, ray);
}

}  // namespace cabin
