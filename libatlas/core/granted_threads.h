// Internal: how many threads the system lets a process have.
#pragma once

#include <cstddef>

namespace atlas {

// Returns how many of `wanted` threads (>= 1, the caller's included) the system lets run at once.
// Limits of processes (ulimit -u, containers) and of address space (ulimit -v) may leave fewer,
// which oneTBB does not expect: where it fails to start a thread from one of its own, it ends the
// program. Threads are started to find out, but only for a number larger than any granted before.
std::size_t granted_threads(std::size_t wanted);

// Returns how many of `count` further threads can start. It starts them to find out, and they end
// together.
std::size_t startable_threads(std::size_t count);

}  // namespace atlas
