#include "libatlas/core/parallel.h"

#include <oneapi/tbb/global_control.h>
#include <oneapi/tbb/info.h>
#include <oneapi/tbb/parallel_for.h>
#include <oneapi/tbb/task_arena.h>

#include <algorithm>
#include <optional>

namespace atlas {

void parallel_for(const Context& context, std::size_t n, std::size_t grain,
                  const std::function<void(std::size_t begin, std::size_t end)>& body) {
  grain = std::max<std::size_t>(grain, 1);
  const std::size_t chunks = (n + grain - 1) / grain;
  const auto run_chunk = [&](std::size_t chunk) {
    if (!context.cancelled()) body(chunk * grain, std::min(n, (chunk + 1) * grain));
  };
  if (chunks <= 1 || context.threads == 1) {
    for (std::size_t chunk = 0; chunk < chunks; ++chunk) run_chunk(chunk);
    return;
  }
  // More threads than cores are a valid wish (it is how tests show that results do not depend on
  // their number), which TBB grants only when told so.
  std::optional<tbb::global_control> limit;
  if (context.threads > tbb::info::default_concurrency()) {
    limit.emplace(tbb::global_control::max_allowed_parallelism, std::size_t(context.threads));
  }
  tbb::task_arena arena(context.threads > 0 ? context.threads : tbb::task_arena::automatic);
  arena.execute(
      [&] { tbb::parallel_for(std::size_t{0}, chunks, run_chunk, tbb::simple_partitioner()); });
}

}  // namespace atlas
