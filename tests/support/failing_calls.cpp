// A library for LD_PRELOAD that lets a chosen call to the system fail, or kills the process before
// it. The environment says which:
//   FAILING_CALL    open, write, link, rename, unlink or fsync
//   FAILING_NUMBER  the number of the call, from 1
//   FAILING_FOLDER  only calls for files whose paths begin so are counted
//   FAILING_KILL    if set, the process is killed
// A call that is to fail creates the file FAILING_FOLDER.struck.
#include <dlfcn.h>
#include <fcntl.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <cerrno>
#include <csignal>
#include <cstdarg>
#include <cstdio>
#include <cstdlib>
#include <cstring>

namespace {

constexpr std::size_t kLongest = 4096;

bool is_under(const char* path) {
  const char* folder = std::getenv("FAILING_FOLDER");
  return folder && std::strncmp(path, folder, std::strlen(folder)) == 0;
}

bool is_under(int file) {
  char name[64], path[kLongest];
  std::snprintf(name, sizeof name, "/proc/self/fd/%d", file);
  const ssize_t length = ::readlink(name, path, sizeof path - 1);
  if (length < 0) return false;
  path[length] = 0;
  return is_under(path);
}

// Counts a call, and returns whether it is to fail.
bool strikes(const char* call) {
  static int count = 0;  // calls of several threads need no order: their order is no one's
  const char *which = std::getenv("FAILING_CALL"), *number = std::getenv("FAILING_NUMBER");
  if (!which || !number || std::strcmp(which, call) != 0) return false;
  if (__atomic_add_fetch(&count, 1, __ATOMIC_RELAXED) != std::atoi(number)) return false;
  if (std::getenv("FAILING_KILL")) ::raise(SIGKILL);
  char path[kLongest];
  std::snprintf(path, sizeof path, "%s.struck", std::getenv("FAILING_FOLDER"));
  const long mark = ::syscall(SYS_open, path, O_CREAT | O_WRONLY, 0600);
  if (mark >= 0) ::syscall(SYS_close, mark);
  errno = std::strcmp(call, "write") == 0 ? ENOSPC : EIO;
  return true;
}

template <class Function>
Function next(const char* name) {
  return reinterpret_cast<Function>(::dlsym(RTLD_NEXT, name));
}

int open_with(const char* name, const char* path, int flags, mode_t mode) {
  if (is_under(path) && strikes("open")) return -1;
  return next<int (*)(const char*, int, mode_t)>(name)(path, flags, mode);
}

std::FILE* open_stream(const char* name, const char* path, const char* mode) {
  if (is_under(path) && strikes("open")) return nullptr;
  return next<std::FILE* (*)(const char*, const char*)>(name)(path, mode);
}

}  // namespace

// The modes of these are read even where none is given: that is what the C library does.
#define FAILING_OPEN(name)                         \
  int name(const char* path, int flags, ...) {     \
    va_list arguments;                             \
    va_start(arguments, flags);                    \
    const mode_t mode = va_arg(arguments, mode_t); \
    va_end(arguments);                             \
    return open_with(#name, path, flags, mode);    \
  }
#define FAILING_STREAM(name)                            \
  std::FILE* name(const char* path, const char* mode) { \
    return open_stream(#name, path, mode);              \
  }
#define FAILING_PWRITE(name)                                                                  \
  ssize_t name(int file, const void* bytes, size_t count, off_t at) {                         \
    if (is_under(file) && strikes("write")) return -1;                                        \
    return next<ssize_t (*)(int, const void*, size_t, off_t)>(#name)(file, bytes, count, at); \
  }
#define FAILING_ONE(name, call)                     \
  int name(const char* path) noexcept {             \
    if (is_under(path) && strikes(call)) return -1; \
    return next<int (*)(const char*)>(#name)(path); \
  }
#define FAILING_TWO(name)                                            \
  int name(const char* from, const char* to) noexcept {              \
    if (is_under(to) && strikes(#name)) return -1;                   \
    return next<int (*)(const char*, const char*)>(#name)(from, to); \
  }

extern "C" {
FAILING_OPEN(open)
FAILING_OPEN(open64)
FAILING_STREAM(fopen)
FAILING_STREAM(fopen64)
FAILING_PWRITE(pwrite)
FAILING_PWRITE(pwrite64)
FAILING_ONE(unlink, "unlink")
FAILING_ONE(remove, "unlink")
FAILING_TWO(link)
FAILING_TWO(rename)

ssize_t write(int file, const void* bytes, size_t count) {
  if (is_under(file) && strikes("write")) return -1;
  return next<ssize_t (*)(int, const void*, size_t)>("write")(file, bytes, count);
}

ssize_t writev(int file, const struct iovec* parts, int count) {
  if (is_under(file) && strikes("write")) return -1;
  return next<ssize_t (*)(int, const struct iovec*, int)>("writev")(file, parts, count);
}

size_t fwrite(const void* bytes, size_t size, size_t count, std::FILE* file) {
  if (is_under(::fileno(file)) && strikes("write")) return 0;
  return next<size_t (*)(const void*, size_t, size_t, std::FILE*)>("fwrite")(bytes, size, count,
                                                                             file);
}

int fclose(std::FILE* file) {  // writes what is buffered
  const bool fails = is_under(::fileno(file)) && strikes("write");
  const int result = next<int (*)(std::FILE*)>("fclose")(file);
  if (!fails) return result;
  errno = ENOSPC;
  return EOF;
}

int fsync(int file) {
  if (is_under(file) && strikes("fsync")) return -1;
  return next<int (*)(int)>("fsync")(file);
}
}
