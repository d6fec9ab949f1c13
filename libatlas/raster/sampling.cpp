#include "libatlas/raster/sampling.h"

namespace atlas {

SampleGrid::SampleGrid(int shifts) {
  while (side * side < shifts && side < 8) ++side;
  count = side * side;
  const double step = 1.0 / side;
  for (int j = 0; j < side; ++j)
    for (int i = 0; i < side; ++i) {
      // Row j moves by a fraction of a step to the right, column i by one down: each x and each y
      // then occurs once among the K positions.
      const double dx = (j + 0.5) * step, dy = (side - 1 - i + 0.5) * step;
      offset[j * side + i] = {(i + dx) * step, (j + dy) * step};
    }
}

}  // namespace atlas
