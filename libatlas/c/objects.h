// Internal: what the handles of the C interface are, and how its calls end.
#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <new>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "libatlas/c/atlas.h"
#include "libatlas/core/context.h"
#include "libatlas/core/status.h"
#include "libatlas/unwrap/atlas.h"
#include "libatlas/unwrap/islands.h"

struct libatlas_context {
  atlas::Context context = {};
  std::atomic<bool> cancel = false;
  std::atomic<bool> cancelled_by_callback = false, callback_failed = false;  // the call that runs
  std::string message = {};
  libatlas_progress progress = nullptr;
  libatlas_warning warning = nullptr;
  void *progress_user = nullptr, *warning_user = nullptr;
};

struct libatlas_atlas {
  atlas::Atlas atlas = {};
};

struct libatlas_unwrapped {
  explicit libatlas_unwrapped(atlas::UnwrappedAtlas unwrapped);

  atlas::UnwrappedAtlas atlas;
  std::vector<libatlas_extent> pages = {};
  std::vector<std::vector<libatlas_instance>> instances = {};  // one per mesh
  // Columns of libatlas_charts.
  std::vector<std::uint32_t> mesh = {}, page = {}, material = {}, triangle_count = {};
  std::vector<std::uint8_t> kept = {}, origins = {};
  std::vector<double> area = {}, stretch_l2 = {}, stretch_999 = {}, stretch_max = {};
};

struct libatlas_packed {
  explicit libatlas_packed(const atlas::PackResult& result);

  std::vector<libatlas_placement> placements = {};
  std::vector<libatlas_extent> pages = {};
  std::size_t unplaced = 0;
  double utilization = 0;
  std::uint32_t page_lower_bound = 0;
};

struct libatlas_packed_islands {
  explicit libatlas_packed_islands(atlas::PackedIslands packed);

  atlas::PackedIslands islands;
  std::vector<libatlas_extent> pages = {};
  std::vector<std::uint32_t> page = {};
  std::vector<double> angle = {}, offset = {};
};

namespace atlas::c {

std::vector<libatlas_extent> to_c(const std::vector<Extent>& pages);
libatlas_status to_c(ErrorCode code);

inline Status null(const char* what) {
  return {ErrorCode::bad_input, std::string(what) + " is null"};
}

// Runs the body of a call, which returns a Status. No exception leaves it.
template <class Body>
libatlas_status run_call(libatlas_context* context, const Body& body) noexcept {
  if (!context) return LIBATLAS_BAD_INPUT;
  const auto failed = [&](libatlas_status code, const char* message) {
    context->message = message;  // short enough to need no memory
    return code;
  };
  libatlas_status code = LIBATLAS_INTERNAL;
  context->cancelled_by_callback = context->callback_failed = false;
  try {
    context->message.clear();
    const Status status = body();
    context->message = status.message();
    code = to_c(status.code());
  } catch (const std::bad_alloc&) {
    code = failed(LIBATLAS_OUT_OF_MEMORY, "out of memory");
  } catch (const std::length_error&) {  // more than a vector may hold
    code = failed(LIBATLAS_OUT_OF_MEMORY, "out of memory");
  } catch (...) {
    code = failed(LIBATLAS_INTERNAL, "internal error");
  }
  if (context->callback_failed) code = failed(LIBATLAS_CALLBACK_FAILED, "callback threw");
  // What a callback stopped was this call, not the next one.
  if (code == LIBATLAS_CANCELLED || context->cancelled_by_callback) context->cancel = false;
  return code;
}

// The same for a call that makes an object; `body` returns Result<std::unique_ptr<Object>>.
template <class Object, class Body>
libatlas_status run_making_call(libatlas_context* context, Object** object,
                                const Body& body) noexcept {
  std::unique_ptr<Object> made;
  const libatlas_status code = run_call(context, [&] {
    if (!object) return null("what receives the result");
    Result<std::unique_ptr<Object>> result = body();
    if (result.ok()) made = std::move(*result);
    return result.status();
  });
  if (object) *object = code == LIBATLAS_OK ? made.release() : nullptr;
  return code;
}

}  // namespace atlas::c
