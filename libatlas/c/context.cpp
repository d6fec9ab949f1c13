#include <memory>
#include <new>
#include <string>
#include <string_view>

#include "libatlas/c/objects.h"

namespace atlas::c {

std::vector<libatlas_extent> to_c(const std::vector<Extent>& pages) {
  std::vector<libatlas_extent> extents;
  for (const Extent page : pages) extents.push_back({page.width, page.height});
  return extents;
}

libatlas_status to_c(ErrorCode code) {
  switch (code) {
    case ErrorCode::ok:
      return LIBATLAS_OK;
    case ErrorCode::cancelled:
      return LIBATLAS_CANCELLED;
    case ErrorCode::bad_input:
      return LIBATLAS_BAD_INPUT;
    case ErrorCode::bad_option:
      return LIBATLAS_BAD_OPTION;
    case ErrorCode::unsupported:
      return LIBATLAS_UNSUPPORTED;
    case ErrorCode::no_solution:
      return LIBATLAS_NO_SOLUTION;
    case ErrorCode::not_found:
    case ErrorCode::io:
      break;  // no call reads or writes files
  }
  return LIBATLAS_INTERNAL;
}

namespace {

// Runs a callback, whose exceptions would otherwise end in code that was not made for them.
template <class Callback>
void run_callback(libatlas_context& context, const Callback& callback) {
  try {
    callback();
  } catch (...) {
    context.callback_failed = true;
    context.cancel = context.cancelled_by_callback = true;
  }
}

}  // namespace
}  // namespace atlas::c

uint32_t libatlas_version(void) {
  return 10000 * LIBATLAS_VERSION_MAJOR + 100 * LIBATLAS_VERSION_MINOR + LIBATLAS_VERSION_PATCH;
}

libatlas_context* libatlas_context_create(void) {
  auto* const context = new (std::nothrow) libatlas_context;
  if (context) context->context.cancel = &context->cancel;
  return context;
}

void libatlas_context_destroy(libatlas_context* context) {
  delete context;
}

const char* libatlas_message(const libatlas_context* context) {
  return context ? context->message.c_str() : "the context is null";
}

void libatlas_set_threads(libatlas_context* context, int32_t threads) {
  if (context) context->context.threads = threads;
}

void libatlas_set_progress(libatlas_context* context, libatlas_progress progress, void* user) {
  if (!context) return;
  // What is stored fits into a std::function without memory.
  context->context.progress = {};
  if (!progress) return;
  context->progress = progress;
  context->progress_user = user;
  context->context.progress = [context](std::string_view stage, double fraction) {
    const std::string name(stage);
    atlas::c::run_callback(*context, [&] {
      if (context->progress(context->progress_user, name.c_str(), fraction) == 0) return;
      context->cancel = context->cancelled_by_callback = true;
    });
  };
}

void libatlas_set_warning(libatlas_context* context, libatlas_warning warning, void* user) {
  if (!context) return;
  context->context.warn = {};
  if (!warning) return;
  context->warning = warning;
  context->warning_user = user;
  context->context.warn = [context](std::string_view line) {
    const std::string text(line);
    atlas::c::run_callback(*context,
                           [&] { context->warning(context->warning_user, text.c_str()); });
  };
}

void libatlas_cancel(libatlas_context* context) {
  if (context) context->cancel = true;
}
