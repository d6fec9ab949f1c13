#include "libatlas/raster/sampling.h"

namespace atlas {

SampleGrid::SampleGrid(int shifts) {
  while (side * side < shifts && side < 8) ++side;
  count = side * side;
  const double step = 1.0 / side;
  for (int j = 0; j < side; ++j)
    for (int i = 0; i < side; ++i) {
      // Row j is moved to the right by a fraction of a step that grows with j, and column i is
      // moved down relative to the columns before it. Each x and each y then occurs only once among
      // the K positions.
      const double dx = (j + 0.5) * step, dy = (side - 1 - i + 0.5) * step;
      offset[j * side + i] = {(i + dx) * step, (j + dy) * step};
    }
}

}  // namespace atlas
