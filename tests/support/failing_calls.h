// Runs a program in which one call to the system fails, or before which it is killed.
#pragma once

#include <fcntl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "tests/support/temp_folder.h"

namespace atlas::test {

struct FailingCall {
  std::string call;  // open, write, link, rename, unlink or fsync
  int number;        // of the call, from 1
  bool kills;
};

struct FailingRun {
  bool struck = false;   // whether there was such a call
  bool crashed = false;  // whether a signal ended the program that is not part of the test
  int exit_code = -1;
};

// Calls count for files whose paths begin with `folder`, which is absolute. The program's output is
// dropped.
inline FailingRun run_failing(const std::vector<std::string>& arguments,
                              const std::filesystem::path& folder, const FailingCall& fault) {
  const std::filesystem::path mark = folder.string() + ".struck";
  std::filesystem::remove(mark);
  const pid_t process = ::fork();
  if (process == 0) {
    ::setenv("LD_PRELOAD", LIBATLAS_TEST_FAILING_CALLS, 1);
    ::setenv("FAILING_CALL", fault.call.c_str(), 1);
    ::setenv("FAILING_NUMBER", std::to_string(fault.number).c_str(), 1);
    ::setenv("FAILING_FOLDER", folder.c_str(), 1);
    if (fault.kills) ::setenv("FAILING_KILL", "1", 1);
    const int nothing = ::open("/dev/null", O_RDWR);
    for (const int stream : {STDOUT_FILENO, STDERR_FILENO}) ::dup2(nothing, stream);
    std::vector<char*> words;
    for (const std::string& word : arguments) words.push_back(const_cast<char*>(word.c_str()));
    words.push_back(nullptr);
    ::execv(words[0], words.data());
    ::_exit(127);
  }
  int status = 0;
  ::waitpid(process, &status, 0);
  FailingRun run;
  const bool killed = WIFSIGNALED(status) && WTERMSIG(status) == SIGKILL;
  run.struck = (fault.kills && killed) || std::filesystem::remove(mark);
  run.crashed = WIFSIGNALED(status) && !(fault.kills && killed);
  if (WIFEXITED(status)) run.exit_code = WEXITSTATUS(status);
  return run;
}

// Returns the contents of the files of a folder by their names.
inline std::map<std::string, std::string> files_in(const std::filesystem::path& folder) {
  std::map<std::string, std::string> files;
  for (const auto& entry : std::filesystem::directory_iterator(folder))
    if (entry.is_regular_file())
      files[entry.path().filename().string()] = TempFolder::read(entry.path());
  return files;
}

}  // namespace atlas::test
