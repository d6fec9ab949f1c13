// Arrays as programs keep them to draw from: several attributes in one, indices of 16 bits.
#pragma once

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <string>

#include "libatlas/core/status.h"

namespace atlas {

// `count` values of `stride` bytes each, of which the first bytes are read: those of a T (3 floats
// for a Vec3f). They need no alignment, and may overlap. A stride of 0 stands for sizeof(T).
template <class T>
struct StridedSpan {
  const void* data = nullptr;
  std::size_t count = 0, stride = 0;

  T operator[](std::size_t i) const {
    T value;
    std::memcpy(&value, static_cast<const char*>(data) + i * (stride == 0 ? sizeof(T) : stride),
                sizeof(T));
    return value;
  }
};

// Indices of 2 or 4 bytes.
struct IndexSpan {
  const void* data = nullptr;
  std::size_t count = 0, bytes = 4;

  std::uint32_t operator[](std::size_t i) const {
    if (bytes == 2) return StridedSpan<std::uint16_t>{data, count}[i];
    return StridedSpan<std::uint32_t>{data, count}[i];
  }
};

// Whether there is an array, and a possible stride or size. `name` begins the message.
template <class T>
Status check_span(const std::string& name, const StridedSpan<T>& values) {
  if (values.count > 0 && !values.data)
    return {ErrorCode::bad_input,
            name + " are null, but there are to be " + std::to_string(values.count)};
  if (values.stride > 0 && values.stride < sizeof(T))
    return {ErrorCode::bad_input, name + " lie " + std::to_string(values.stride) +
                                      " bytes apart (at least " + std::to_string(sizeof(T)) +
                                      ", or 0 for no gaps)"};
  return {};
}
inline Status check_span(const std::string& name, const IndexSpan& indices) {
  if (indices.bytes != 2 && indices.bytes != 4)
    return {ErrorCode::bad_input,
            name + " have " + std::to_string(indices.bytes) + " bytes each (2 or 4)"};
  return check_span(name, StridedSpan<std::uint16_t>{indices.data, indices.count});
}

}  // namespace atlas
