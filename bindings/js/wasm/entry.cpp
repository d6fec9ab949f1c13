// What libatlas.wasm has besides the functions of atlas.h: the ways back into JavaScript.
#include <cstdlib>
#include <new>

#include "libatlas/c/atlas.h"

#define FROM_JAVASCRIPT(name) __attribute__((import_module("javascript"), import_name(name)))
#define TO_JAVASCRIPT(name) extern "C" __attribute__((export_name(name)))

extern "C" {
FROM_JAVASCRIPT("progress") int tell_progress(const char* stage, double fraction);
FROM_JAVASCRIPT("warning") void tell_warning(const char* line);
FROM_JAVASCRIPT("out_of_memory") void tell_out_of_memory();
}

// One call runs at a time, so JavaScript knows whose progress it is told.
TO_JAVASCRIPT("create_context") libatlas_context* create_context() {
  // There are no exceptions here, so this one is thrown by JavaScript, and the memory with all that
  // is in it is given up.
  std::set_new_handler(tell_out_of_memory);
  libatlas_context* const context = libatlas_context_create();
  libatlas_set_progress(
      context,
      [](void*, const char* stage, double fraction) { return tell_progress(stage, fraction); },
      nullptr);
  libatlas_set_warning(
      context, [](void*, const char* line) { tell_warning(line); }, nullptr);
  return context;
}

TO_JAVASCRIPT("allocate") void* allocate(std::size_t bytes) {
  return ::operator new(bytes);
}
TO_JAVASCRIPT("release") void release(void* memory) {
  ::operator delete(memory);
}
