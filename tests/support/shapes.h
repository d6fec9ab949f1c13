// Meshes for tests, made in code: any size, known topology, closed forms where there are any.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "libatlas/core/vec.h"

namespace atlas::test {

struct Shape {
  std::string name;
  std::vector<Vec3f> positions;
  std::vector<std::uint32_t> indices;  // 3 a triangle, anticlockwise seen from outside

  std::size_t triangle_count() const { return indices.size() / 3; }
};

// A flat grid of nx * ny quads over [0, width] x [0, height], facing +z.
Shape grid(int nx, int ny, double width = 1, double height = 1);
// A closed box from (0, 0, 0) to `size`, each face n x n quads; corners are shared.
Shape box(int n, Vec3d size = {1, 1, 1});
// Closed surfaces. sphere: around latitude circles with one vertex at each pole.
Shape sphere(int around, int rings, double radius = 1);
Shape icosphere(int subdivisions, double radius = 1);
// Evenly triangulated sphere of 20 n² triangles: each face of an icosahedron cut into n².
Shape geodesic_sphere(int n, double radius = 1);
Shape torus(int around, int across, double major = 1, double minor = 0.4);
// Developable: the open mantle of a cylinder, and that of a cone cut open along a generator (its
// apex is a vertex). half_angle is between axis and mantle, radians; slant the length of the
// mantle.
Shape cylinder(int around, int along, double radius = 1, double height = 2);
Shape cone(int around, int along, double half_angle, double slant = 1);
// On a disc of radius 1: two fans of triangles.
Shape closed_cone(int around, double height);
// A geodesic cap of the unit sphere, of half-angle theta (radians) about +z.
Shape cap(int around, int rings, double theta);
// A closed plate with `holes` square holes in a row: genus = holes. Every cell side is cut into n.
Shape plate_with_holes(int holes, int n);
// n triangles of random place, size and direction in the unit cube; nothing is shared.
Shape soup(int n, std::uint64_t seed);
// A fan of n triangles around one vertex, flat.
Shape fan(int n);
// n triangles of unit length and width 1/aspect side by side: slivers whose long sides are shared.
Shape needles(int n, double aspect);
// n triangles, 0.9 radians apart around the edge of vertices 0 and 1, which all of them share.
Shape sheets(int n);

// Every vertex moved by up to `amplitude` in each coordinate, the same for the same seed.
Shape noisy(Shape shape, double amplitude, std::uint64_t seed);
// Scan noise: Gaussian along the vertex normals, `sigma` in mean edge lengths.
Shape noisy_along_normals(Shape shape, double sigma, std::uint64_t seed = 7);
// p -> scale * p + offset, in double, rounded once.
Shape moved(Shape shape, double scale, Vec3d offset = {});
// Both in one mesh.
Shape together(Shape a, const Shape& b);

double surface_area(const Shape& shape);
// V - E + F of the mesh as indexed.
long euler_characteristic(const Shape& shape);
// Edges used by exactly one triangle.
std::size_t border_edges(const Shape& shape);

// A set that every property should hold on: discs, closed surfaces, handles, many pieces, bad
// shapes.
std::vector<Shape> zoo();

}  // namespace atlas::test
