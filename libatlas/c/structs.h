// Internal: structs of the C interface, which begin with their size.
#pragma once

#include <fmt/format.h>

#include <algorithm>
#include <cstddef>
#include <cstring>

#include "libatlas/c/atlas.h"
#include "libatlas/core/status.h"

namespace atlas::c {

// No version of a struct will be larger than this, so a larger size was never set.
inline constexpr std::size_t kLargestStruct = 4096;

// The size of a struct in the first version of the library, before members were added to it.
template <class T>
inline constexpr std::size_t kFirstSize = sizeof(T);
template <>
inline constexpr std::size_t kFirstSize<libatlas_mesh> = offsetof(libatlas_mesh, polygon_sizes);
template <>
inline constexpr std::size_t kFirstSize<libatlas_unwrap_options> = offsetof(libatlas_unwrap_options,
                                                                            like);
template <>
inline constexpr std::size_t kFirstSize<libatlas_charts> = offsetof(libatlas_charts, origins);

template <class T>
constexpr bool usable_size(std::size_t size) {
  return size >= kFirstSize<T> && size <= kLargestStruct;
}

template <class T>
Status check_size(const T* given, const char* name) {
  if (!given) return {ErrorCode::bad_input, fmt::format("{} is null", name)};
  if (!usable_size<T>(given->size))
    return {ErrorCode::bad_option,
            fmt::format("{}: size is {} (set it to sizeof({}))", name, given->size, name)};
  return {};
}

// Copies what is passed in. Members that the caller does not know are 0; those that this version
// does not know must be.
template <class T>
Status take_struct(const T* given, const char* name, T& taken) {
  if (Status s = check_size(given, name); !s.ok()) return s;
  const auto* const bytes = reinterpret_cast<const unsigned char*>(given);
  const std::size_t known = std::min(sizeof(T), given->size);
  if (std::any_of(bytes + known, bytes + given->size, [](unsigned char b) { return b != 0; }))
    return {ErrorCode::unsupported,
            fmt::format("{}: uses members that this version of the library does not know", name)};
  taken = {};
  std::memcpy(&taken, given, known);
  return {};
}

// Writes to a struct of the caller, whose size is set and stays, what it has room for. Members that
// this version does not know become 0.
template <class T>
void fill_struct(T* given, std::size_t size, T values) {
  values.size = size;
  std::memset(static_cast<void*>(given), 0, size);
  std::memcpy(static_cast<void*>(given), &values, std::min(size, sizeof(T)));
}

template <class T>
Status hand_out(T* given, const char* name, const T& values) {
  if (Status s = check_size(given, name); !s.ok()) return s;
  fill_struct(given, given->size, values);
  return {};
}

inline Status check_preset(const char* name, const char* member, libatlas_preset preset) {
  if (preset >= LIBATLAS_FAST && preset <= LIBATLAS_BEST) return {};
  return {ErrorCode::bad_option,
          fmt::format("{}: {} is {} (0: fast, 1: standard, 2: best)", name, member, preset)};
}

inline Status check_flag(const char* name, const char* member, int32_t flag) {
  if (flag == 0 || flag == 1) return {};
  return {ErrorCode::bad_option, fmt::format("{}: {} is {} (0 or 1)", name, member, flag)};
}

template <class T>
libatlas_status set_defaults(T* given, std::size_t size, const T& values) {
  if (!given) return LIBATLAS_BAD_INPUT;
  if (!usable_size<T>(size)) return LIBATLAS_BAD_OPTION;
  fill_struct(given, size, values);
  return LIBATLAS_OK;
}

}  // namespace atlas::c
