#include "libatlas/core/background.h"

#include <utility>

#include "libatlas/core/parallel.h"

namespace atlas {

Status Background::add(std::function<Status()> task) {
  while (!under_way_.empty() && under_way_.size() >= at_once_) wait_for_oldest();
  if (!status_.ok()) return status_;
  if (at_once_ == 0) return status_ = task();
  under_way_.push_back(std::async(std::launch::async, [task = std::move(task)] {
    const double begun = own_cpu_seconds();
    Status status = task();
    return Done{std::move(status), own_cpu_seconds() - begun};
  }));
  return {};
}

Status Background::finish() {
  while (!under_way_.empty()) wait_for_oldest();
  return status_;
}

void Background::wait_for_oldest() {
  std::future<Done> oldest = std::move(under_way_.front());
  under_way_.pop_front();
  Done done = oldest.get();
  add_own_cpu_seconds(done.cpu_seconds);
  if (status_.ok()) status_ = std::move(done.status);
}

}  // namespace atlas
