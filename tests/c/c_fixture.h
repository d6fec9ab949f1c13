// What tests of the C interface share: objects that are destroyed, and meshes of shapes.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "libatlas/c/atlas.h"
#include "tests/support/shapes.h"

namespace atlas::test {

struct Destroy {
  void operator()(libatlas_context* c) const { libatlas_context_destroy(c); }
  void operator()(libatlas_atlas* a) const { libatlas_atlas_destroy(a); }
  void operator()(libatlas_unwrapped* u) const { libatlas_unwrapped_destroy(u); }
  void operator()(libatlas_packed* p) const { libatlas_packed_destroy(p); }
  void operator()(libatlas_packed_islands* p) const { libatlas_packed_islands_destroy(p); }
};
template <class T>
using Owned = std::unique_ptr<T, Destroy>;

template <class T>
T sized() {
  T out{};
  out.size = sizeof out;
  return out;
}

inline libatlas_mesh mesh_of(const Shape& shape) {
  libatlas_mesh mesh;
  libatlas_mesh_init(&mesh, sizeof mesh);
  mesh.positions = shape.positions.data();
  mesh.position_count = shape.positions.size();
  mesh.indices = shape.indices.data();
  mesh.index_count = shape.indices.size();
  return mesh;
}

class C : public testing::Test {
 protected:
  libatlas_context* context() { return context_.get(); }
  std::string message() { return libatlas_message(context()); }

  Owned<libatlas_atlas> atlas_of(const std::vector<Shape>& shapes) {
    libatlas_atlas* atlas = nullptr;
    EXPECT_EQ(libatlas_atlas_create(context(), &atlas), LIBATLAS_OK);
    for (std::uint32_t i = 0; i < shapes.size(); ++i) {
      const libatlas_mesh mesh = mesh_of(shapes[i]);
      std::uint32_t number = 99;
      EXPECT_EQ(libatlas_add_mesh(context(), atlas, &mesh, &number), LIBATLAS_OK) << message();
      EXPECT_EQ(number, i);
    }
    return Owned<libatlas_atlas>(atlas);
  }

  Owned<libatlas_unwrapped> unwrap(const libatlas_atlas* atlas,
                                   const libatlas_unwrap_options* options = nullptr) {
    libatlas_unwrapped* unwrapped = nullptr;
    EXPECT_EQ(libatlas_unwrap(context(), atlas, options, &unwrapped), LIBATLAS_OK) << message();
    return Owned<libatlas_unwrapped>(unwrapped);
  }

  const std::vector<Shape> shapes_{torus(24, 12), box(3), grid(5, 5)};
  Owned<libatlas_context> context_{libatlas_context_create()};
};

template <class T>
bool same(const T* values, std::size_t count, std::span<const T> expected) {
  return count == expected.size() && std::equal(expected.begin(), expected.end(), values);
}

}  // namespace atlas::test
