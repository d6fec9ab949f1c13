#include "apps/common/terminal.h"

#include <fmt/format.h>
#include <unistd.h>

#include <atomic>
#include <csignal>
#include <cstdio>

#include "apps/common/program.h"

namespace atlas::app {
namespace {

std::atomic<bool> g_cancelled{false};  // the only variable that the signal handler uses

extern "C" void on_interrupt(int) {
  // After a second signal, a third ctrl-C ends the program at once, in case a stage does not poll.
  // The second one does not, because timeout(1) sends each signal twice.
  if (g_cancelled.exchange(true) && std::signal(SIGINT, SIG_DFL) == SIG_IGN)
    std::signal(SIGINT, SIG_IGN);
}

// Signals that whoever started the program lets it ignore stay ignored: those of nohup(1), and of
// shells that run it in the background.
void take(int signal) {
  if (std::signal(signal, on_interrupt) == SIG_IGN) std::signal(signal, SIG_IGN);
}

constexpr int kBarWidth = 28;

}  // namespace

Terminal::Terminal(std::string program, bool quiet)
    : program_(std::move(program)), quiet_(quiet), is_terminal_(::isatty(STDERR_FILENO) != 0) {
  for (const int signal : {SIGINT, SIGTERM, SIGHUP}) take(signal);
}

Terminal::~Terminal() {
  clear_bar();
}

Context Terminal::context(int threads) {
  Context context;
  context.threads = threads;
  context.cancel = &g_cancelled;
  context.warn = [this](std::string_view text) { warning(text); };
  if (!quiet_) {
    context.progress = [this](std::string_view stage, double fraction) {
      progress(stage, fraction);
    };
  }
  return context;
}

void Terminal::line(std::string_view text) {
  if (quiet_) return;
  clear_bar();
  print(stdout, fmt::format("{}\n", printable(text)));
}

void Terminal::error(std::string_view text) {
  clear_bar();
  print_error(program_, words_ ? words_(text) : std::string(text));
}

void Terminal::warning(std::string_view text) {
  clear_bar();
  print(stderr,
        fmt::format("{}: {}\n", program_, one_line(words_ ? words_(text) : std::string(text))));
}

void Terminal::progress(std::string_view stage, double fraction) {
  if (stage != stage_) {
    stage_ = stage;
    shown_percent_ = -1;
  }
  const int percent = int(100 * fraction);
  if (percent <= shown_percent_) return;
  shown_percent_ = percent;
  if (is_terminal_) {
    const int filled = kBarWidth * percent / 100;
    print(stderr, fmt::format("\r{:<14} [{:#<{}}{:.<{}}] {:3d} %", stage_, "", filled, "",
                              kBarWidth - filled, percent));
    std::fflush(stderr);
    bar_shown_ = true;
  }
  if (percent >= 100) clear_bar();
}

void Terminal::clear_bar() {
  if (bar_shown_) print(stderr, fmt::format("\r{:60}\r", ""));
  bar_shown_ = false;
}

int exit_code(const Status& status) {
  if (status.ok()) return 0;
  if (status.code() == ErrorCode::cancelled) return 130;
  return status.code() == ErrorCode::bad_option ? 2 : 1;
}

}  // namespace atlas::app
