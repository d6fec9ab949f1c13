// Generated meshes for tests, of any size, with known topology and closed forms where possible.
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
  std::vector<std::uint32_t> indices;  // three per triangle, anticlockwise seen from outside

  std::size_t triangle_count() const { return indices.size() / 3; }
  // Adds the two triangles of the quad a b c d, which is anticlockwise.
  void add_quad(std::uint32_t a, std::uint32_t b, std::uint32_t c, std::uint32_t d);
};

// A flat grid of nx * ny quads over [0, width] x [0, height], facing +z.
Shape grid(int nx, int ny, double width = 1, double height = 1);
// A closed box from (0, 0, 0) to `size`. Each face has n x n quads; vertices are shared.
Shape box(int n, Vec3d size = {1, 1, 1});
// Closed surfaces. A sphere has latitude circles of `around` vertices and one vertex at each pole.
Shape sphere(int around, int rings, double radius = 1);
Shape icosphere(int subdivisions, double radius = 1);
// An evenly triangulated sphere of 20 n² triangles: each face of an icosahedron is divided into n².
Shape geodesic_sphere(int n, double radius = 1);
Shape torus(int around, int across, double major = 1, double minor = 0.4);
// Developable surfaces: the open side of a cylinder, and that of a cone which is cut open along a
// generator and whose apex is a vertex. half_angle is between axis and side, in radians; slant is
// the length of the side.
Shape cylinder(int around, int along, double radius = 1, double height = 2);
Shape cone(int around, int along, double half_angle, double slant = 1);
// A closed cone on a disc of radius 1, as two fans of triangles.
Shape closed_cone(int around, double height);
// A geodesic cap of the unit sphere with the half-angle theta (radians) around +z.
Shape cap(int around, int rings, double theta);
// A closed plate with `holes` square holes in a row, so its genus is `holes`. Cell sides have n
// edges.
Shape plate_with_holes(int holes, int n);
// n triangles with random position, size and direction in the unit cube, without shared vertices.
Shape soup(int n, std::uint64_t seed);
// A flat fan of n triangles around one vertex.
Shape fan(int n);
// n triangles of unit length and width 1/aspect side by side: slivers that share their long sides.
Shape needles(int n, double aspect);
// n triangles, 0.9 radians apart around the edge between vertices 0 and 1, which they all share.
Shape sheets(int n);

// Moves every vertex by up to `amplitude` in each coordinate; equal seeds give equal results.
Shape noisy(Shape shape, double amplitude, std::uint64_t seed);
// Adds scan noise: Gaussian along the vertex normals, with `sigma` in mean edge lengths.
Shape noisy_along_normals(Shape shape, double sigma, std::uint64_t seed = 7);
// Maps p to scale * p + offset, computed in double and rounded once.
Shape moved(Shape shape, double scale, Vec3d offset = {});
// Returns both shapes as one mesh.
Shape together(Shape a, const Shape& b);

double surface_area(const Shape& shape);
// Returns V - E + F of the mesh as indexed.
long euler_characteristic(const Shape& shape);
// Returns the number of edges that exactly one triangle uses.
std::size_t border_edges(const Shape& shape);

// Shapes on which every property should hold: discs, closed surfaces, handles, many pieces, badly
// shaped triangles.
std::vector<Shape> zoo();

}  // namespace atlas::test
