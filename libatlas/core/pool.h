// Internal: objects that are dear to make, one a running task: handed out and taken back.
#pragma once

#include <memory>
#include <mutex>
#include <utility>
#include <vector>

namespace atlas {

// Its members may be called from several threads at once, but for idle().
template <class T>
class Pool {
 public:
  // One that was given back, or a new one.
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

  // Those that were given back.
  const std::vector<std::unique_ptr<T>>& idle() const { return idle_; }

 private:
  std::mutex mutex_;
  std::vector<std::unique_ptr<T>> idle_;
};

}  // namespace atlas
