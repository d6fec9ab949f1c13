// The same shape in other units, directions and places: what may change in its charts, and what
// not.
#pragma once

#include <array>
#include <string>
#include <vector>

#include "libatlas/charts/charts.h"
#include "tests/support/shapes.h"

namespace atlas::test {

// A mesh in double, as a file of many digits holds it.
struct WideMesh {
  std::string name;
  std::vector<Vec3d> positions;
  std::vector<std::uint32_t> indices;
};

WideMesh widened(const Shape& shape);

// Row-major 3x3 matrices: the turn by `angle` about (x, y, z), and one of random axis and angle.
using Turn = std::array<double, 9>;
Turn turn_about(Vec3d axis, double angle);
Turn random_turn(std::uint64_t seed);

WideMesh turned(WideMesh mesh, const Turn& turn);
WideMesh scaled(WideMesh mesh, double factor);
WideMesh shifted(WideMesh mesh, Vec3d offset);

// Positions rounded to float once.
Shape narrowed(const WideMesh& mesh);

ChartSet charts_of(const Shape& shape, int threads = 1);

// Holds what became of a mesh's charts against the original's, case by case. Every case has to
// keep its L2 stretch within 1 %, to flip nothing, and to keep the number of charts within 3 %;
// nine cases of ten have to keep the seams, too: rounding may move a border.
class Comparison {
 public:
  // `factor`: of the lengths.
  void add(const std::string& name, const ChartSet& charts, const ChartSet& reference,
           double factor);
  ~Comparison();  // reports

 private:
  int cases_ = 0, alike_ = 0;
  std::string others_;
};

}  // namespace atlas::test
