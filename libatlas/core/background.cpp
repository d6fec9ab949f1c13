#include "libatlas/core/background.h"

#include <utility>

namespace atlas {

Status Background::add(std::function<Status()> task) {
  while (!under_way_.empty() && under_way_.size() >= at_once_) wait_for_oldest();
  if (!status_.ok()) return status_;
  if (at_once_ == 0) return status_ = task();
  under_way_.push_back(std::async(std::launch::async, std::move(task)));
  return {};
}

Status Background::finish() {
  while (!under_way_.empty()) wait_for_oldest();
  return status_;
}

void Background::wait_for_oldest() {
  std::future<Status> oldest = std::move(under_way_.front());
  under_way_.pop_front();
  const Status status = oldest.get();
  if (status_.ok()) status_ = status;
}

}  // namespace atlas
