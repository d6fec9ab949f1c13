// What the applications share on a terminal: a progress line, warnings, ctrl-C.
#pragma once

#include <functional>
#include <string>
#include <string_view>
#include <utility>

#include "libatlas/core/context.h"
#include "libatlas/core/status.h"

namespace atlas::app {

// Draws one progress bar a stage on stderr where that is a terminal, none otherwise or when quiet.
// Ctrl-C raises the context's cancel flag. One at a time.
class Terminal {
 public:
  Terminal(std::string program, bool quiet);
  ~Terminal();
  Terminal(const Terminal&) = delete;
  Terminal& operator=(const Terminal&) = delete;

  // A context whose progress, warnings and cancel flag are this terminal's; it must not outlive it.
  Context context(int threads);

  // How warnings and errors of the library are worded for the program's users; as they are, at
  // first.
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

// The exit code of every application: 0 done, 1 failed, 2 bad command line, 130 cancelled.
int exit_code(const Status& status);

}  // namespace atlas::app
