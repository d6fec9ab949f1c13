// Internal: the numbers of a mesh as columns that deflate well and that a few lines of any language
// read.
#pragma once

#include <cstdint>
#include <span>
#include <string>

#include "libatlas/core/status.h"

namespace atlas {

// Appends a column of values to `out`: one byte, the number k of planes (0..4), then k planes of
// one byte a value, the lowest first. Values begin as differences from the one before (from 0 for
// the first), modulo 2^32, with the sign in the lowest bit: 0, -1, 1, -2, ... become 0, 1, 2, 3,
// ...
void append_differences(std::span<const std::uint32_t> values, std::string& out);

// Appends indices in the same form, but each as its distance from the lowest number that has not
// occurred yet: 0 is a new vertex. Precondition: vertices are numbered in the order of their first
// use.
void append_indices(std::span<const std::uint32_t> indices, std::string& out);

// Returns the bytes in zlib's format. Errors: unsupported where zlib has no memory for it.
Result<std::string> deflated(std::string_view bytes);

// Returns the bytes in base64, padded.
std::string base64(std::string_view bytes);

}  // namespace atlas
