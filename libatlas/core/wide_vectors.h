// Internal: vectors of two and four doubles for inner loops. Arithmetic is done on each element
// separately, so results do not depend on the processor's instructions.
#pragma once

namespace atlas {

// Every 64-bit processor handles it in one instruction. It is aligned to 16 bytes, like the memory
// that std::vector allocates; WebAssembly's memory is not, and need not be.
#ifdef __wasm__
#define ATLAS_PAIR_ALIGNMENT 8
#else
#define ATLAS_PAIR_ALIGNMENT 16
#endif
using Pair = double __attribute__((vector_size(16), may_alias, aligned(ATLAS_PAIR_ALIGNMENT)));
static_assert(__STDCPP_DEFAULT_NEW_ALIGNMENT__ >= ATLAS_PAIR_ALIGNMENT);

// If has_wide_vectors, functions marked ATLAS_WIDE handle it in one instruction. Elsewhere
// compilers split it into two, and may run out of registers. QuadInPlace is the type for reading it
// from arrays.
using Quad = double __attribute__((vector_size(32)));
using QuadInPlace =
    double __attribute__((vector_size(32), aligned(ATLAS_PAIR_ALIGNMENT), may_alias));

// For functions that are called by functions with and without ATLAS_WIDE: they are compiled for
// each.
#define ATLAS_INLINE [[gnu::always_inline]] inline

// Clang gets no wide vectors: where QuadInPlace is a template argument or behind a reference, Clang
// forgets that it need not be aligned to 32 bytes, and reads it with instructions that require it.
// Neither does Windows, on whose stack GCC does not align them.
// LIBATLAS_NARROW_VECTORS compiles what other processors execute (the preset tsan does).
#if defined(__x86_64__) && defined(__GNUC__) && !defined(__clang__) && !defined(_WIN32) && \
    !defined(LIBATLAS_NARROW_VECTORS)
#define ATLAS_WIDE [[gnu::target("avx2")]]
inline const bool has_wide_vectors = __builtin_cpu_supports("avx2");
#else
#define ATLAS_WIDE
inline constexpr bool has_wide_vectors = false;
#endif

}  // namespace atlas
