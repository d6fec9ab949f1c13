// A locale of another country, for what must not depend on it.
#pragma once

#include <clocale>
#include <cstdlib>
#include <filesystem>
#include <string>

#include "tests/support/temp_folder.h"

namespace atlas::test {

// Sets the process's locale while it lives. Few machines have more than one installed, so it is
// made where the sources of locales are there; else entered() is false, and the test is to skip.
class ForeignLocale {
 public:
  // For example LC_NUMERIC, "de_DE", "ISO-8859-1".
  ForeignLocale(int category, const std::string& name, const std::string& characters)
      : category_(category), before_(std::setlocale(category, nullptr)) {
    const std::filesystem::path made = folder_ / name;
    const std::string command =
        "localedef -c -i " + name + " -f " + characters + " " + made.string() + " >/dev/null 2>&1";
    // It warns of characters that the set lacks, and ends with 1 then.
    [[maybe_unused]] const int ignored = std::system(command.c_str());
    ::setenv("LOCPATH", folder_.path().c_str(), 1);
    entered_ = std::setlocale(category, name.c_str()) != nullptr;
    ::unsetenv("LOCPATH");
  }
  ~ForeignLocale() { std::setlocale(category_, before_.c_str()); }
  ForeignLocale(const ForeignLocale&) = delete;
  ForeignLocale& operator=(const ForeignLocale&) = delete;

  bool entered() const { return entered_; }

 private:
  TempFolder folder_;
  int category_;
  std::string before_;
  bool entered_ = false;
};

}  // namespace atlas::test
