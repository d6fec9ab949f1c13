#pragma once

#include <fcntl.h>
#include <signal.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <string>

namespace atlas::test {

// An X server of our own, on a number that it chooses.
class Xvfb {
 public:
  Xvfb() {
    int ends[2];
    if (::pipe(ends) != 0) return;
    pid_ = ::fork();
    if (pid_ == 0) {
      const int quiet = ::open("/dev/null", O_WRONLY);
      ::prctl(PR_SET_PDEATHSIG, SIGKILL);  // a test that crashes does not leave it behind
      ::dup2(ends[1], 3);
      ::dup2(quiet, 2);
      ::execlp("Xvfb", "Xvfb", "-displayfd", "3", "-noreset", "-screen", "0", "320x240x24",
               nullptr);
      ::_exit(127);
    }
    ::close(ends[1]);
    char c = 0;
    while (::read(ends[0], &c, 1) == 1 && c != '\n') display_ += c;
    ::close(ends[0]);
  }
  ~Xvfb() { kill(); }
  Xvfb(const Xvfb&) = delete;
  Xvfb& operator=(const Xvfb&) = delete;
  bool runs() const { return !display_.empty(); }
  const std::string& display() const { return display_; }
  std::string environment() const { return "-u WAYLAND_DISPLAY DISPLAY=:" + display_; }
  void kill() {
    if (pid_ <= 0) return;
    ::kill(pid_, SIGKILL);
    ::waitpid(pid_, nullptr, 0);
    pid_ = -1;
  }

 private:
  pid_t pid_ = -1;
  std::string display_;
};

}  // namespace atlas::test
