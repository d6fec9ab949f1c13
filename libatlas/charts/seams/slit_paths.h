// Internal: seams of charts with themselves, drawn straight.
#pragma once

#include <memory>

#include "libatlas/charts/seams/straighten.h"

namespace atlas {

// The borders between charts, too, become straighter where they need not stop at the ends of slits.
// Those from border to border, as along tubes, are closed meanwhile; then they are opened again so
// far as they lie within their charts, and drawn on to the border where that has moved away.
class Slits {
 public:
  // `options` as for straighten_borders(), `triangles` empty. Keeps references to all.
  Slits(const Topology& topology, const StraightenOptions& options, Partition& partition,
        Frames& frames);
  ~Slits();

  // In charts of at least three rings.
  void close();
  void reopen();  // those
  // Replaces each path by a shorter one (creases count a quarter) within `rings` edges of it, a few
  // times, as long as that saves much. Ends on the chart's border move along it, others stay. What
  // lies between the two paths changes banks, and its frames turn with it. What topology forbids
  // stays as it is.
  void straighten();

 private:
  class Straightener;
  std::unique_ptr<Straightener> straightener_;
};

}  // namespace atlas
