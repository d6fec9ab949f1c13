// Internal: run_chunks(), the loop under parallel_for(): on threads of oneTBB (run_chunks_tbb.cpp)
// or, in a build without it, on threads of our own (run_chunks_own.cpp); in WebAssembly on the
// caller's (run_chunks_none.cpp).
#pragma once

#include <cstddef>
#include <functional>

namespace atlas {

// Calls run(0), ..., run(chunks - 1), each once and in any order, on up to `threads` threads (>= 1,
// the caller's included), and returns when all are done. `within`: the caller runs a chunk of
// another loop, whose threads this loop shares, whatever `threads` is. Once a call has thrown,
// those that have not begun are left out, and the exception leaves this function.
void run_chunks(std::size_t threads, bool within, std::size_t chunks,
                const std::function<void(std::size_t)>& run);

// Ends or gives up the threads that are kept for later loops of the calling thread.
void release_loop_threads();

}  // namespace atlas
