#include "benchmarks/support/own_process.h"

#include <fmt/format.h>
#include <oneapi/tbb/global_control.h>
#include <sys/wait.h>
#include <unistd.h>
#ifdef __GLIBC__
#include <malloc.h>
#endif

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <string>

#include "benchmarks/support/callgrind.h"
#include "libatlas/core/parallel.h"

namespace atlas::bench {
namespace {

// One end of a pipe as a stream that closes itself.
class Stream {
 public:
  Stream(int descriptor, const char* mode) : file_(fdopen(descriptor, mode)) {}
  ~Stream() { std::fclose(file_); }
  Stream(const Stream&) = delete;
  Stream& operator=(const Stream&) = delete;

  void write(const std::string& line) {
    std::fprintf(file_, "%s\n", line.c_str());
    std::fflush(file_);
  }
  // Returns false at the end.
  bool read(std::string& line) {
    line.clear();
    for (int c; (c = std::fgetc(file_)) != EOF; line += char(c))
      if (c == '\n') return true;
    return false;
  }

 private:
  FILE* file_;
};

// A child process has only the thread that forked, so a thread pool would wait for its workers for
// ever. TBB starts its pool again when it is next needed, in parent and child.
bool end_threads() {
  release_threads();
  tbb::task_scheduler_handle pool{tbb::attach{}};
  return tbb::finalize(pool, std::nothrow);
}

[[noreturn]] void be_child(int descriptor, const std::function<void(const TakeRow&)>& work) {
  {
    Stream parent(descriptor, "w");
    work([&](const Row& row) { parent.write(to_json_line(row)); });
  }
  std::fflush(stdout);
  ::_exit(0);  // destructors and exit handlers are left to the parent
}

int wait_for(pid_t child) {
  int status = 0;
  while (::waitpid(child, &status, 0) < 0 && errno == EINTR) {
  }
  return status;
}

}  // namespace

void in_own_process(const Row& otherwise, const TakeRow& done,
                    const std::function<void(const TakeRow& done)>& work) {
  if (under_valgrind()) return work(done);
  const auto fail = [&](const std::string& why) {
    Row row = otherwise;
    row.failure = why;
    done(row);
  };
  if (!end_threads()) return fail("threads still run, so that no process can be forked");
#ifdef __GLIBC__
  malloc_trim(0);
#endif
  std::fflush(nullptr);  // otherwise both processes would write buffered output
  int ends[2];
  if (::pipe(ends) != 0) return fail(fmt::format("no pipe: {}", std::strerror(errno)));
  const pid_t child = ::fork();
  if (child == 0) {
    ::close(ends[0]);
    be_child(ends[1], work);
  }
  ::close(ends[1]);
  Stream stream(ends[0], "r");
  if (child < 0) return fail(fmt::format("no process: {}", std::strerror(errno)));
  for (std::string text; stream.read(text);) {
    Result<Row> row = row_from_line(text);
    if (!row.ok()) break;  // the line is incomplete: the child died, which its status shows
    done(std::move(*row));
  }
  const int status = wait_for(child);
  if (WIFSIGNALED(status))
    fail(fmt::format("its process was ended by signal {} ({})", WTERMSIG(status),
                     ::strsignal(WTERMSIG(status))));
  else if (WEXITSTATUS(status) != 0)
    fail(fmt::format("its process ended with code {}", WEXITSTATUS(status)));
}

}  // namespace atlas::bench
