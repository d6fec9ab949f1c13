#include <algorithm>
#include <atomic>
#include <condition_variable>
#include <exception>
#include <map>
#include <mutex>
#include <new>
#include <system_error>
#include <thread>
#include <vector>

#include "libatlas/core/run_chunks.h"

namespace atlas {
namespace {

// A loop whose chunks are handed out one by one.
struct OpenLoop {
  std::size_t chunks;
  const std::function<void(std::size_t)>& run;
  std::atomic<std::size_t> next{0};
  std::size_t helpers = 0;          // threads besides the caller that run chunks of it
  std::exception_ptr failure = {};  // the first one
};

// The threads that share the loops of one calling thread: an outermost loop, and those within its
// chunks. Whoever opens a loop runs chunks of it until none is left, and then waits only for those
// that others have begun; these wait in turn only for loops further within, so that all end.
class Crew {
 public:
  // Fewer threads start where the system grants no more.
  explicit Crew(std::size_t size) {
    try {
      while (threads_.size() + 1 < size) threads_.emplace_back([this] { help(); });
    } catch (const std::system_error&) {
    } catch (const std::bad_alloc&) {
    }
  }
  ~Crew() {
    {
      const std::lock_guard lock(mutex_);
      ending_ = true;
    }
    opened_.notify_all();
    for (std::thread& thread : threads_) thread.join();
  }
  Crew(const Crew&) = delete;
  Crew& operator=(const Crew&) = delete;

  void run(std::size_t chunks, const std::function<void(std::size_t)>& body) {
    OpenLoop loop{chunks, body};
    std::unique_lock lock(mutex_);
    open_.push_back(&loop);
    lock.unlock();
    opened_.notify_all();
    run_what_is_left(loop);
    lock.lock();
    std::erase(open_, &loop);
    left_.wait(lock, [&] { return loop.helpers == 0; });
    if (loop.failure) std::rethrow_exception(loop.failure);
  }

 private:
  void run_what_is_left(OpenLoop& loop);
  void help();

  std::mutex mutex_;
  std::condition_variable opened_, left_;
  std::vector<OpenLoop*> open_;  // the last one is the furthest within
  bool ending_ = false;
  std::vector<std::thread> threads_;
};

// The crew whose chunk this thread runs, if any.
thread_local Crew* crew_at_work = nullptr;

void Crew::run_what_is_left(OpenLoop& loop) {
  Crew* const before = crew_at_work;
  crew_at_work = this;
  try {
    for (std::size_t chunk; (chunk = loop.next.fetch_add(1)) < loop.chunks;) loop.run(chunk);
  } catch (...) {
    loop.next = loop.chunks;
    const std::lock_guard lock(mutex_);
    if (!loop.failure) loop.failure = std::current_exception();
  }
  crew_at_work = before;
}

void Crew::help() {
  std::unique_lock lock(mutex_);
  while (true) {
    opened_.wait(lock, [&] { return ending_ || !open_.empty(); });
    if (ending_) return;
    OpenLoop& loop = *open_.back();
    ++loop.helpers;
    lock.unlock();
    run_what_is_left(loop);
    lock.lock();
    std::erase(open_, &loop);  // nothing of it is left to begin
    if (--loop.helpers == 0) left_.notify_all();
  }
}

// Returns this thread's crews by the number of threads that are wanted, for its later loops.
std::map<std::size_t, Crew>& own_crews() {
  thread_local std::map<std::size_t, Crew> crews;
  return crews;
}

}  // namespace

void run_chunks(std::size_t threads, bool within, std::size_t chunks,
                const std::function<void(std::size_t)>& run) {
  Crew& crew = within ? *crew_at_work : own_crews().try_emplace(threads, threads).first->second;
  crew.run(chunks, run);
}

void release_loop_threads() {
  own_crews().clear();
}

}  // namespace atlas
