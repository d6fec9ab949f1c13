// Compares the charts of a shape in other units, orientations and positions, and says what may
// differ.
#pragma once

#include <array>
#include <string>
#include <vector>

#include "libatlas/charts/charts.h"
#include "tests/support/shapes.h"

namespace atlas::test {

// A mesh in double precision, as a file with many digits holds it.
struct WideMesh {
  std::string name;
  std::vector<Vec3d> positions;
  std::vector<std::uint32_t> indices;
};

WideMesh widened(const Shape& shape);

// Row-major 3x3 matrices: the rotation by `angle` about (x, y, z), and one with a random axis and
// angle.
using Turn = std::array<double, 9>;
Turn turn_about(Vec3d axis, double angle);
Turn random_turn(std::uint64_t seed);

WideMesh turned(WideMesh mesh, const Turn& turn);
WideMesh scaled(WideMesh mesh, double factor);
WideMesh shifted(WideMesh mesh, Vec3d offset);

// Rounds the positions to float, once.
Shape narrowed(const WideMesh& mesh);

ChartSet charts_of(const Shape& shape, int threads = 1);

// Compares the charts of changed meshes with those of the original, case by case. In every case the
// L2 stretch has to stay within 1 % and the number of charts within 3 %, and no triangle may be
// flipped. In nine of ten cases the length of the seams has to stay within 3 %, too; rounding may
// move a border in the others.
class Comparison {
 public:
  // `factor` is the one by which the lengths were scaled.
  void add(const std::string& name, const ChartSet& charts, const ChartSet& reference,
           double factor);
  ~Comparison();  // reports the result

 private:
  int cases_ = 0, alike_ = 0;
  std::string others_;
};

}  // namespace atlas::test
