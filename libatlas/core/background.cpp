#include "libatlas/core/background.h"

#include <memory>
#include <system_error>
#include <utility>

#include "libatlas/core/parallel.h"

namespace atlas {

// If the system starts no thread, for example because a limit of processes is reached, the task is
// done before this function returns, and its CPU time is the caller's already.
std::future<Background::Done> Background::start(std::function<Status()> task) {
  // The task is shared, since a start that fails may have moved it away already.
  const auto shared = std::make_shared<std::function<Status()>>(std::move(task));
  try {
    return std::async(std::launch::async, [shared] {
      const double begun = own_cpu_seconds();
      Status status = (*shared)();
      return Done{std::move(status), own_cpu_seconds() - begun};
    });
  } catch (const std::system_error&) {
    std::packaged_task<Done()> here([shared] { return Done{(*shared)(), 0}; });
    std::future<Done> result = here.get_future();
    here();
    return result;
  }
}

Status Background::add(std::function<Status()> task) {
  while (!under_way_.empty() && under_way_.size() >= at_once_) wait_for_oldest();
  if (!status_.ok()) return status_;
  if (at_once_ == 0) return status_ = task();
  under_way_.push_back(start(std::move(task)));
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
