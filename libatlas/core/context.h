// The context of long work: the number of threads, callbacks for progress and warnings, and a flag
// that cancels the work.
#pragma once

#include <atomic>
#include <functional>
#include <string_view>

namespace atlas {

// Passed by const reference to every stage. A default-constructed context uses all cores, reports
// nothing, and cannot be cancelled.
//
// Threads: every function except those of windows (view/context.h) may be called from several
// threads at once, also on the same input, and works on threads of its own. An object is for one
// thread at a time, unless its header says more; const members of results only read plain data.
// Exceptions: the library itself throws only std::bad_alloc. An exception of a callback ends the
// stage and leaves the call that was given the callback; files are whole or absent then, too.
struct Context {
  // Number of threads; 0 or less: as many as the machine has. At most 256, or as many as the
  // machine has, are used, and fewer where the system does not grant that many (ulimit -u,
  // containers). Results never depend on it.
  int threads = 0;
  // Called as (stage, fraction in [0, 1]), from any thread, but never from two threads at once by
  // the same library call. The fractions of a stage rise, stages follow each other, and some stages
  // report rarely.
  std::function<void(std::string_view stage, double fraction)> progress = {};
  // Called with one line of text about something that was skipped or repaired or is worth knowing,
  // from any thread as `progress` is.
  std::function<void(std::string_view line)> warn = {};
  // The caller (or its signal handler) sets it to end the work; every long loop polls it. The stage
  // then returns Status::cancelled() and leaves nothing half-written.
  const std::atomic<bool>* cancel = nullptr;

  bool cancelled() const { return cancel && cancel->load(std::memory_order_relaxed); }
  void report(std::string_view stage, double fraction) const {
    if (progress) progress(stage, fraction);
  }
  void say(std::string_view line) const {
    if (warn) warn(line);
  }
};

}  // namespace atlas
