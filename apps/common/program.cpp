#include "apps/common/program.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include <cerrno>
#include <csignal>
#include <cstring>
#include <exception>
#include <new>

namespace atlas::app {
namespace {

int g_stdout_error = 0;  // errno of the first failure

void note_stdout(bool written) {
  if (!written && g_stdout_error == 0) g_stdout_error = errno ? errno : EIO;
}

void open_closed_streams() {
  for (const int stream : {STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO}) {
    // The lowest number that is free is the stream's own.
    if (::fcntl(stream, F_GETFD) == -1 && errno == EBADF && ::open("/dev/null", O_RDWR) < 0) return;
  }
}

int complain(const char* name, std::string_view what) {
  print(stderr, fmt::format("{}: error: {}\n", name, what));
  return 1;
}

}  // namespace

void print(std::FILE* stream, std::string_view text) {
  errno = 0;
  const bool written = std::fwrite(text.data(), 1, text.size(), stream) == text.size();
  if (stream == stdout) note_stdout(written && std::fflush(stream) == 0);
}

int run_program(const char* name, int argc, char** argv, int (*body)(int, char**)) {
  open_closed_streams();
  std::signal(SIGPIPE, SIG_IGN);
  int code = 1;
  try {
    code = body(argc, argv);
  } catch (const std::bad_alloc&) {
    code = complain(name, "out of memory (fewer --threads, smaller pages or a smaller input)");
  } catch (const std::exception& error) {
    code = complain(name, error.what());
  }
  errno = 0;
  note_stdout(std::fflush(stdout) == 0 && !std::ferror(stdout));
  if (code == 0 && g_stdout_error != 0 && g_stdout_error != EPIPE)
    code = complain(name, fmt::format("standard output: {}", std::strerror(g_stdout_error)));
  return code;
}

}  // namespace atlas::app
