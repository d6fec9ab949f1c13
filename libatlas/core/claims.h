// Internal: a parallel loop over tasks that share things, as the borders between charts share the
// charts.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>

#include "libatlas/core/context.h"

namespace atlas {

// The two things that a task claims; any numbers.
using Claims = std::array<std::uint32_t, 2>;

// Calls body(i) once for each task i, on up to context.threads threads. Tasks that claim the same
// thing run one after the other, in the order given: where a task touches what it claims alone, the
// outcome is that of a serial loop. Once context.cancelled(), tasks not yet begun are skipped. What
// a body throws comes out of the call.
void for_each_claim(const Context& context, std::span<const Claims> tasks,
                    const std::function<void(std::size_t task)>& body);

}  // namespace atlas
