// What long work is given: how many threads, where progress goes, and whether to stop.
#pragma once

#include <atomic>
#include <functional>
#include <string_view>

namespace atlas {

// Passed by const reference to every stage. Default-constructed: all cores, silent, not
// cancellable.
//
// Threads: every function but those of windows (view/context.h) may be called from several threads
// at once, also on the same input, and works on threads of its own. One object is used by one
// thread at a time, unless its header says more; const members of results are plain data.
// Exceptions: the library throws none of its own but std::bad_alloc. One that a callback throws
// ends the stage and comes out of the call that was given the callback; files are whole or absent
// then, too.
struct Context {
  // Threads to use; 0 or less means as many as the machine has. Results never depend on it.
  int threads = 0;
  // Called as (stage, fraction in [0, 1]), from any thread but by one call never from two at once.
  // A stage's fractions rise; stages follow each other, and not every one reports often.
  std::function<void(std::string_view stage, double fraction)> progress;
  // Called with one line of text about something skipped, repaired or worth knowing, likewise.
  std::function<void(std::string_view line)> warn;
  // Raised by the caller (a signal handler may) to end the work; polled by every long loop. The
  // stage then returns Status::cancelled() and leaves nothing half-written.
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
