// Internal: counts the properties of a PLY file's elements that a scene has no arrays for.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "libatlas/scene/ply/ply_header.h"
#include "libatlas/scene/scene.h"

namespace atlas {

class PlyLosses {
 public:
  // `read` lists the element's properties that the scene holds. `plural` names the elements. Both
  // header and name must outlive this object.
  PlyLosses(const PlyElement& element, std::span<const int> read, const char* plural);

  // Takes the values of one element, 1 per property. Alpha counts where it is not opaque.
  void take(const std::vector<double>& values) {
    for (Property& p : unread_) p.count += !(p.is_alpha && values[p.index] == p.opaque);
  }

  // Adds "values of vertices: quality" for each property.
  void add_to(LossCounts& counts) const;

 private:
  struct Property {
    std::size_t index = 0, count = 0;
    bool is_alpha = false;
    double opaque = 1;
  };

  const PlyElement& element_;
  const char* plural_;
  std::vector<Property> unread_;
};

}  // namespace atlas
