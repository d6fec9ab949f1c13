// Internal: vectors of two and four doubles for inner loops. Arithmetic on them is that of their
// elements, so results do not depend on what the processor has.
#pragma once

namespace atlas {

// Elementary to every 64-bit processor. Lies at multiples of 16 bytes, as what std::vector
// allocates begins.
using Pair = double __attribute__((vector_size(16), may_alias));
static_assert(__STDCPP_DEFAULT_NEW_ALIGNMENT__ >= sizeof(Pair));

// One instruction's worth where has_wide_vectors, in functions marked ATLAS_WIDE; elsewhere
// compilers make two of each, and may run out of registers. QuadInPlace is how they are read from
// arrays.
using Quad = double __attribute__((vector_size(32)));
using QuadInPlace = double __attribute__((vector_size(32), aligned(16), may_alias));

// For what functions with and without ATLAS_WIDE share: it is compiled for each.
#define ATLAS_INLINE [[gnu::always_inline]] inline

// Clang forgets that QuadInPlace need not lie at multiples of 32 where it is a template's argument
// or behind a reference, and reads it by instructions that insist on them.
#if defined(__x86_64__) && defined(__GNUC__) && !defined(__clang__)
#define ATLAS_WIDE [[gnu::target("avx2")]]
inline const bool has_wide_vectors = __builtin_cpu_supports("avx2");
#else
#define ATLAS_WIDE
inline constexpr bool has_wide_vectors = false;
#endif

}  // namespace atlas
