// Where there are no threads, as in WebAssembly.
#include "libatlas/core/run_chunks.h"

namespace atlas {

void run_chunks(std::size_t, bool, std::size_t chunks,
                const std::function<void(std::size_t)>& run) {
  for (std::size_t chunk = 0; chunk < chunks; ++chunk) run(chunk);
}

void release_loop_threads() {}

}  // namespace atlas
