// Internal: measures a pass's GPU time without waiting for it, with a ring of GL_TIME_ELAPSED
// queries.
#pragma once

#include <array>
#include <limits>

#include "libatlas/view/gl_objects.h"

namespace atlas {

class PassTimer {
 public:
  PassTimer() {
    for (GlQuery& q : queries_) q = create<GlQuery>(glCreateQueries, GL_TIME_ELAPSED);
  }
  void begin() { glBeginQuery(GL_TIME_ELAPSED, queries_[at_ % kRing].get()); }
  void end() {
    glEndQuery(GL_TIME_ELAPSED);
    ++at_;
    poll();
  }
  // Returns the time of the newest pass whose time has arrived; NaN before that.
  double seconds() const { return seconds_; }

  // Takes in the times that have arrived. end() calls it; call it after glFinish() to get the time
  // of the frame just drawn.
  void poll() {
    // Results older than the ring are lost, since their query objects have been used again.
    if (at_ - read_ > kRing - 1) read_ = at_ - (kRing - 1);
    for (; read_ < at_; ++read_) {
      const GLuint query = queries_[read_ % kRing].get();
      GLuint ready = 0;
      glGetQueryObjectuiv(query, GL_QUERY_RESULT_AVAILABLE, &ready);
      if (!ready) return;
      GLuint64 nanoseconds = 0;
      glGetQueryObjectui64v(query, GL_QUERY_RESULT, &nanoseconds);
      seconds_ = double(nanoseconds) * 1e-9;
    }
  }

 private:
  static constexpr unsigned kRing = 4;
  std::array<GlQuery, kRing> queries_;
  unsigned at_ = 0, read_ = 0;
  double seconds_ = std::numeric_limits<double>::quiet_NaN();
};

}  // namespace atlas
