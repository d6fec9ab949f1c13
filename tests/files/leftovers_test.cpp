// Which files are taken for the temporary files of processes that have ended.
#include "libatlas/files/leftovers.h"

#include <gtest/gtest.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <filesystem>
#include <string>

#include "libatlas/files/atomic_file.h"
#include "tests/core/no_root.h"
#include "tests/support/temp_folder.h"

namespace atlas {
namespace {

using test::TempFolder;

std::string mark_of(const std::string& process) {
  const std::string own = process_mark();
  return own.substr(0, own.rfind('-') + 1) + process;
}

std::string mark_of_an_ended_process() {
  const pid_t process = ::fork();
  if (process == 0) ::_exit(0);
  EXPECT_EQ(::waitpid(process, nullptr, 0), process);
  return mark_of(std::to_string(process));
}

bool is_removed(const TempFolder& folder, const std::string& name) {
  folder.write(name, "");
  remove_leftovers(folder.path());
  return !std::filesystem::exists(folder / name);
}

TEST(Leftovers, AreKnownByTheirWholeNames) {
  const TempFolder folder;
  const std::string ended = mark_of_an_ended_process();
  for (const char* end : {".part", ".part.7", ".part.7.obj"})
    EXPECT_TRUE(is_removed(folder, ".world." + ended + end)) << end;
  EXPECT_FALSE(is_removed(folder, "world." + ended + ".part.7.obj")) << "not hidden";
  for (const char* end : {"", ".obj", "x.part.1", ".partial.obj", ".before.12.png"})
    EXPECT_FALSE(is_removed(folder, ".world." + ended + end)) << end;
}

// Of these numbers kill(2) thinks in other terms: of the own group, of another one, of no process.
TEST(Leftovers, NumbersThatNameNoProcessStay) {
  const TempFolder folder;
  for (const char* number : {"0", "-7654321", "99999999999999999999", ""})
    EXPECT_FALSE(is_removed(folder, ".world." + mark_of(number) + ".part.1.obj")) << number;
}

TEST(Leftovers, FilesOfAnotherUsersProcessStay) {
  const TempFolder folder;
  ASSERT_EQ(::chmod(folder.path().c_str(), 0777), 0);
  const auto file = folder.write(".world." + mark_of("1") + ".part.1.obj", "");
  const auto left = folder.write(".world." + mark_of_an_ended_process() + ".part.1.obj", "");
  {
    const test::NoRoot user;  // who may not even send a signal to the first process
    remove_leftovers(folder.path());
  }
  EXPECT_TRUE(std::filesystem::exists(file));
  EXPECT_FALSE(std::filesystem::exists(left));
}

TEST(Leftovers, GoFromEveryFolderOfAnExport) {
  const TempFolder folder;
  const std::string name = "/.world." + mark_of_an_ended_process() + ".part.1.obj";
  for (const char* place : {"one", "two", "three"}) {
    std::filesystem::create_directories(folder / place);
    folder.write(place + name, "");
  }
  AtomicFiles files;
  for (const char* place : {"one", "two", "three"}) {
    (void)files.path_for(folder / place / "world.obj");
    EXPECT_FALSE(std::filesystem::exists(folder / (place + name))) << place;
  }
}

}  // namespace
}  // namespace atlas
