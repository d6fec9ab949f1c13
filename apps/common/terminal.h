// What the applications share on a terminal: a progress bar, warnings, and ctrl-C.
#pragma once

#include <functional>
#include <string>
#include <string_view>
#include <utility>

#include "libatlas/core/context.h"
#include "libatlas/core/status.h"

namespace atlas::app {

// Draws one progress bar per stage on stderr, if that is a terminal and the program is not quiet.
// Ctrl-C sets the context's cancel flag. Only one Terminal may exist at a time.
class Terminal {
 public:
  Terminal(std::string program, bool quiet);
  ~Terminal();
  Terminal(const Terminal&) = delete;
  Terminal& operator=(const Terminal&) = delete;

  // Returns a context with this terminal's progress, warnings (to stderr, always) and cancel flag;
  // it must not outlive the terminal.
  Context context(int threads);

  // Sets the function that rewords warnings and errors of the library for the program's users.
  // Until then they stay as they are.
  void reword(std::function<std::string(std::string_view)> words) { words_ = std::move(words); }

  void line(std::string_view text);   // to stdout, after clearing the bar; not when quiet
  void error(std::string_view text);  // to stderr, always, as "program: error: text"

 private:
  void progress(std::string_view stage, double fraction);
  void warning(std::string_view text);
  void clear_bar();

  std::string program_, stage_;
  std::function<std::string(std::string_view)> words_;
  bool quiet_, is_terminal_, bar_shown_ = false;
  int shown_percent_ = -1;
};

// Returns the exit code of every application: 0 done, 1 failed, 2 bad command line, 130 cancelled.
int exit_code(const Status& status);

}  // namespace atlas::app
