// Shapes as meshes without materials or texture coordinates.
#pragma once

#include "libatlas/charts/charts.h"
#include "tests/support/shapes.h"

namespace atlas::test {

// The shape must outlive the view.
inline MeshView view_of(const Shape& shape) {
  MeshView view;
  view.positions = shape.positions;
  view.indices = shape.indices;
  return view;
}

}  // namespace atlas::test
