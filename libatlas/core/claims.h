// Internal: for_each_claim(), a parallel loop over tasks that share objects; for example, each
// border between two charts is a task, and borders share charts.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>

#include "libatlas/core/context.h"

namespace atlas {

// The two objects that a task claims, as any numbers that identify them.
using Claims = std::array<std::uint32_t, 2>;

// Calls body(i) once for each task i, on up to context.threads threads. Tasks that claim the same
// object run one after the other, in the given order. So if every task touches only what it claims,
// the result is that of a serial loop. Once context.cancelled(), tasks that have not begun are
// skipped. Exceptions of `body` leave this function.
void for_each_claim(const Context& context, std::span<const Claims> tasks,
                    const std::function<void(std::size_t task)>& body);

}  // namespace atlas
