#include "libatlas/core/claims.h"

#include <algorithm>
#include <condition_variable>
#include <mutex>
#include <queue>
#include <unordered_map>
#include <vector>

#include "libatlas/core/parallel.h"

namespace atlas {
namespace {

// The tasks and what they wait for. A worker waits only while another one runs a task, because the
// first of the unfinished tasks never has to wait for another.
class Queue {
 public:
  explicit Queue(std::span<const Claims> tasks) : left_(tasks.size()), nodes_(tasks.size()) {
    std::unordered_map<std::uint32_t, std::uint32_t> last;  // the last task that claims each object
    for (std::uint32_t i = 0; i < tasks.size(); ++i) {
      for (const std::uint32_t thing : tasks[i]) {
        const auto [at, is_first] = last.emplace(thing, i);
        if (is_first || at->second == i) continue;
        nodes_[at->second].next.push_back(i);
        ++nodes_[i].before;
        at->second = i;
      }
      if (nodes_[i].before == 0) ready_.push(i);
    }
  }

  // Runs tasks until none is left.
  void work(const Context& context, const std::function<void(std::size_t)>& body) {
    std::unique_lock lock(mutex_);
    for (;;) {
      changed_.wait(lock, [&] { return left_ == 0 || !ready_.empty(); });
      if (left_ == 0) return;
      const std::uint32_t task = ready_.top();
      ready_.pop();
      lock.unlock();
      run(context, task, body);
      lock.lock();
      finish(task);
    }
  }

 private:
  struct Node {
    std::vector<std::uint32_t> next;
    std::uint32_t before = 0;  // number of tasks to wait for
  };

  void run(const Context& context, std::uint32_t task,
           const std::function<void(std::size_t)>& body) {
    try {
      if (!context.cancelled()) body(task);
    } catch (...) {
      const std::lock_guard lock(mutex_);
      left_ = 0;
      changed_.notify_all();
      throw;
    }
  }

  void finish(std::uint32_t task) {
    if (left_ == 0) return;  // another task has thrown
    --left_;
    for (const std::uint32_t next : nodes_[task].next) {
      if (--nodes_[next].before == 0) ready_.push(next);
    }
    changed_.notify_all();
  }

  std::mutex mutex_;
  std::condition_variable changed_;
  std::size_t left_;
  std::vector<Node> nodes_;
  std::priority_queue<std::uint32_t, std::vector<std::uint32_t>, std::greater<>> ready_;
};

}  // namespace

void for_each_claim(const Context& context, std::span<const Claims> tasks,
                    const std::function<void(std::size_t)>& body) {
  if (context.threads == 1 || tasks.size() < 2) {
    for (std::size_t i = 0; i < tasks.size() && !context.cancelled(); ++i) body(i);
    return;
  }
  Queue queue(tasks);
  parallel_for(context, std::min(thread_count(context), tasks.size()), 1,
               [&](std::size_t, std::size_t) { queue.work(context, body); });
}

}  // namespace atlas
