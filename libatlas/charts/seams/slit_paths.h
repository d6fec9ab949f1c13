// Internal: straightens slits, the seams of charts with themselves.
#pragma once

#include <memory>

#include "libatlas/charts/seams/straighten.h"

namespace atlas {

// Borders between charts also become straighter if they need not stop at the ends of slits. Slits
// from border to border, as along tubes, are therefore closed in the meantime. Afterwards they are
// opened again as far as they lie within their charts, and extended to the border where that has
// moved away.
class Slits {
 public:
  // `options` are as for straighten_borders(), with `triangles` empty. Keeps references to all
  // arguments.
  Slits(const Topology& topology, const StraightenOptions& options, Partition& partition,
        Frames& frames);
  ~Slits();

  // Closes slits from border to border, in charts whose bands have at least three rings.
  void close();
  void reopen();  // opens those again
  // Replaces each slit by a cheaper path (border_weight) within `rings` edges of it, a
  // few times, as long as that saves enough. Ends on the chart's border move along it; other ends
  // stay. The triangles between both paths change banks, and their frames turn accordingly. Slits
  // that topology does not allow to move stay as they are.
  void straighten();

 private:
  class Straightener;
  std::unique_ptr<Straightener> straightener_;
};

}  // namespace atlas
