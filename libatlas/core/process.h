// Internal: what the system tells of this process beyond clock.h, in one file per system
// (process_posix.cpp, process_windows.cpp), which also define what clock.h declares of it.
#pragma once

#include <cstdint>

namespace atlas {

// Returns how many bytes of address space the process may still take; UINT64_MAX without a limit.
std::uint64_t free_address_space();

}  // namespace atlas
