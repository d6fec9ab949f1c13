// What programs show on a terminal, and how they take signals. Each case runs in a process of its
// own, whose stderr may be a terminal.
#include "apps/common/terminal.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <gtest/gtest.h>
#include <signal.h>
#include <stdlib.h>
#include <sys/wait.h>
#include <unistd.h>

#include <functional>
#include <string>

namespace atlas::app {
namespace {

struct Shown {
  std::string text;  // of stdout and stderr
  int status = 0;    // as wait() tells it
};

enum class Stream { terminal, pipe };

// Runs a function with stdout and stderr on a terminal or a pipe. Its result is the exit code.
Shown shown(Stream stream, const std::function<int()>& run) {
  int ends[2] = {-1, -1};
  if (stream == Stream::pipe) {
    EXPECT_EQ(::pipe(ends), 0);
  } else {
    ends[0] = ::posix_openpt(O_RDWR | O_NOCTTY);
    EXPECT_TRUE(ends[0] >= 0 && ::grantpt(ends[0]) == 0 && ::unlockpt(ends[0]) == 0);
    ends[1] = ::open(::ptsname(ends[0]), O_RDWR | O_NOCTTY);
  }
  const pid_t child = ::fork();
  if (child == 0) {
    for (const int signal : {SIGINT, SIGTERM, SIGHUP}) ::signal(signal, SIG_DFL);
    ::dup2(ends[1], STDOUT_FILENO);
    ::dup2(ends[1], STDERR_FILENO);
    ::close(ends[1]);
    ::_exit(run());
  }
  ::close(ends[1]);
  Shown result;
  char buffer[4096];
  // A terminal whose other end is closed gives an error instead of an end.
  for (ssize_t n; (n = ::read(ends[0], buffer, sizeof buffer)) > 0;)
    result.text.append(buffer, std::size_t(n));
  ::close(ends[0]);
  EXPECT_EQ(::waitpid(child, &result.status, 0), child);
  return result;
}

std::string bar(const std::string& stage, int filled, int percent) {
  return fmt::format("\r{:<14} [{}{}] {:3d} %", stage, std::string(std::size_t(filled), '#'),
                     std::string(std::size_t(28 - filled), '.'), percent);
}

const std::string kCleared = "\r" + std::string(60, ' ') + "\r";

TEST(ProgressBar, GrowsWithTheStageAndGoesWithIt) {
  const Shown s = shown(Stream::terminal, [] {
    Terminal terminal("prog", false);
    const Context context = terminal.context(1);
    context.report("packing", 0);
    context.report("packing", 0.004);  // still 0 %
    context.report("packing", 0.5);
    context.report("packing", 0.25);  // threads may report in any order
    context.report("packing", 1);
    context.report("baking", 0.25);
    return 0;
  });
  EXPECT_EQ(s.text, bar("packing", 0, 0) + bar("packing", 14, 50) + bar("packing", 28, 100) +
                        kCleared + bar("baking", 7, 25) + kCleared);
}

TEST(ProgressBar, MakesRoomForLines) {
  const Shown s = shown(Stream::terminal, [] {
    Terminal terminal("prog", false);
    const Context context = terminal.context(1);
    context.report("a", 0.5);
    context.say("said");
    context.say("again");
    context.report("a", 0.75);
    terminal.line("told");
    context.report("a", 0.9);
    terminal.error("wrong");
    return 0;
  });
  // The terminal adds a carriage return to each line feed.
  EXPECT_EQ(s.text, bar("a", 14, 50) + kCleared + "prog: said\r\nprog: again\r\n" +
                        bar("a", 21, 75) + kCleared + "told\r\n" + bar("a", 25, 90) + kCleared +
                        "prog: error: wrong\r\n");
}

TEST(ProgressBar, IsForTerminalsOnlyAndNotForQuietPrograms) {
  const auto work = [](bool quiet) {
    return [quiet] {
      Terminal terminal("prog", quiet);
      const Context context = terminal.context(1);
      context.report("a", 0.5);
      context.say("said");
      terminal.line("told");
      terminal.error("wrong");
      return 0;
    };
  };
  EXPECT_EQ(shown(Stream::pipe, work(false)).text, "prog: said\ntold\nprog: error: wrong\n");
  EXPECT_EQ(shown(Stream::terminal, work(true)).text, "prog: said\r\nprog: error: wrong\r\n");
}

TEST(Terminal, RewordsWarningsAndErrorsButNotLines) {
  const Shown s = shown(Stream::pipe, [] {
    Terminal terminal("prog", false);
    terminal.reword([](std::string_view text) { return "<" + std::string(text) + ">"; });
    terminal.context(1).say("said\nin two lines");
    terminal.line("told\nin two lines");
    terminal.error("wrong\n");
    return 0;
  });
  EXPECT_EQ(s.text, "prog: <said in two lines>\ntold\nin two lines\nprog: error: <wrong >\n");
}

TEST(Terminal, GivesItsThreadsToTheContext) {
  Terminal terminal("prog", true);
  EXPECT_EQ(terminal.context(5).threads, 5);
  EXPECT_FALSE(terminal.context(5).cancelled());
}

// timeout(1) sends each signal twice, which must not end what cleans up.
TEST(Signals, CancelAndTheThirdEndsTheProgram) {
  for (const int signal : {SIGINT, SIGTERM, SIGHUP}) {
    const Shown twice = shown(Stream::pipe, [signal] {
      Terminal terminal("prog", false);
      const Context context = terminal.context(1);
      if (context.cancelled()) return 1;
      ::raise(signal);
      if (!context.cancelled()) return 2;
      ::raise(signal);
      return 7;
    });
    EXPECT_TRUE(WIFEXITED(twice.status) && WEXITSTATUS(twice.status) == 7) << signal;
  }
  const Shown thrice = shown(Stream::pipe, [] {
    Terminal terminal("prog", false);
    for (int i = 0; i < 3; ++i) ::raise(SIGINT);
    return 0;
  });
  EXPECT_TRUE(WIFSIGNALED(thrice.status) && WTERMSIG(thrice.status) == SIGINT);
}

// Programs that nohup(1) has started go on when the terminal is closed, and those in the background
// of a script when ctrl-C ends what is in front.
TEST(Signals, StayIgnoredWhereTheyWere) {
  for (const int signal : {SIGINT, SIGTERM, SIGHUP}) {
    const Shown s = shown(Stream::pipe, [signal] {
      ::signal(signal, SIG_IGN);
      Terminal terminal("prog", false);
      ::raise(signal);
      return terminal.context(1).cancelled() ? 1 : 7;
    });
    EXPECT_TRUE(WIFEXITED(s.status) && WEXITSTATUS(s.status) == 7) << signal;
  }
  // Not even two signals of another kind, after which ctrl-C ends a program, change that.
  const Shown s = shown(Stream::pipe, [] {
    ::signal(SIGINT, SIG_IGN);
    Terminal terminal("prog", false);
    for (const int signal : {SIGTERM, SIGTERM, SIGINT}) ::raise(signal);
    return 7;
  });
  EXPECT_TRUE(WIFEXITED(s.status) && WEXITSTATUS(s.status) == 7);
}

TEST(ExitCodes, AreThoseOfTheManual) {
  EXPECT_EQ(exit_code({}), 0);
  EXPECT_EQ(exit_code({ErrorCode::io, ""}), 1);
  EXPECT_EQ(exit_code({ErrorCode::bad_input, ""}), 1);
  EXPECT_EQ(exit_code({ErrorCode::no_solution, ""}), 1);
  EXPECT_EQ(exit_code({ErrorCode::bad_option, ""}), 2);
  EXPECT_EQ(exit_code(Status::cancelled()), 130);
}

}  // namespace
}  // namespace atlas::app
