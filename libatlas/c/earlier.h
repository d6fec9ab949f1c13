// Internal: uvs of an earlier state of a mesh, as they come from C.
#pragma once

#include <cstdint>
#include <vector>

#include "libatlas/c/atlas.h"
#include "libatlas/core/status.h"
#include "libatlas/unwrap/like.h"

namespace atlas::c {

// Holds what EarlierUvs points at.
class EarlierArrays {
 public:
  // Once per object. Errors: bad_input for an array that is null, or whose stride or size of
  // indices is not possible; bad_option, unsupported: of the struct. What check_earlier() finds is
  // left to that.
  Status take(const libatlas_earlier_uvs& given);
  const EarlierUvs& uvs() const { return earlier_; }

 private:
  std::vector<Vec3f> positions_ = {};
  std::vector<std::uint32_t> indices_ = {}, uv_indices_ = {};
  std::vector<Vec2f> uvs_ = {};
  std::vector<Extent> pages_ = {};
  EarlierUvs earlier_ = {};
};

}  // namespace atlas::c
