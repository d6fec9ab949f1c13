// Internal: Pool, which lends objects that are expensive to create, one to each running task.
#pragma once

#include <memory>
#include <mutex>
#include <utility>
#include <vector>

namespace atlas {

// All members except idle() may be called from several threads at once.
template <class T>
class Pool {
 public:
  // Returns an object that was given back, or a new one.
  std::unique_ptr<T> take() {
    const std::lock_guard lock(mutex_);
    if (idle_.empty()) return std::make_unique<T>();
    std::unique_ptr<T> object = std::move(idle_.back());
    idle_.pop_back();
    return object;
  }
  void give(std::unique_ptr<T> object) {
    const std::lock_guard lock(mutex_);
    idle_.push_back(std::move(object));
  }

  // Returns the objects that were given back.
  const std::vector<std::unique_ptr<T>>& idle() const { return idle_; }

 private:
  std::mutex mutex_;
  std::vector<std::unique_ptr<T>> idle_;
};

}  // namespace atlas
