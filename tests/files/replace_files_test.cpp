// Several files are replaced together, whatever fails on the way.
#include "libatlas/files/replace_files.h"

#include <gtest/gtest.h>
#include <sys/stat.h>
#include <unistd.h>

#include <fstream>
#include <map>
#include <string>
#include <thread>
#include <vector>

#include "libatlas/files/atomic_file.h"
#include "tests/core/no_root.h"
#include "tests/support/failing_calls.h"
#include "tests/support/temp_folder.h"

namespace atlas {
namespace {

namespace fs = std::filesystem;
using test::FailingCall;
using test::FailingRun;
using test::TempFolder;

using Files = std::map<std::string, std::string>;

Files world(const std::string& text) {
  Files files;
  for (const std::string name : {"world_0.png", "world_1.png", "world.mtl", "world.obj"})
    files[name] = text + name;
  return files;
}

// What the next run into the folder does before it writes, whatever it writes.
void next_run(const fs::path& folder) {
  AtomicFiles files;
  (void)files.path_for(folder / "other.txt");
}

class ReplaceFiles : public testing::Test {
 protected:
  // Makes the folder anew, with these files.
  void fill(const Files& files) const {
    fs::remove_all(folder());
    fs::create_directories(folder());
    for (const auto& [name, bytes] : files) std::ofstream(folder() / name) << bytes;
  }
  fs::path folder() const { return temporary_ / "out"; }

  // Lets each call fail in turn, or kills the process before each, and expects the old files or the
  // new ones. Returns the number of calls.
  int strike(const std::string& call, bool kills, const Files& old) const {
    const Files made = world("new");
    for (int number = 1;; ++number) {
      fill(old);
      const FailingRun run =
          test::run_failing({LIBATLAS_TEST_COMMIT_PROBE, folder().string(), "new", "durable"},
                            folder(), FailingCall{call, number, kills});
      EXPECT_FALSE(run.crashed);
      if (!run.struck) {
        EXPECT_EQ(run.exit_code, 0);
        EXPECT_EQ(test::files_in(folder()), made);
        return number - 1;
      }
      if (!kills) expect_whole(run.exit_code == 0 ? made : old);
      next_run(folder());
      const Files left = test::files_in(folder());
      EXPECT_TRUE(left == old || left == made)
          << call << ' ' << number << ": " << testing::PrintToString(left);
    }
  }

 private:
  // Other files may be there, which the next run removes.
  void expect_whole(const Files& wanted) const {
    Files visible = test::files_in(folder());
    std::erase_if(visible, [](const auto& file) { return file.first.starts_with('.'); });
    EXPECT_EQ(visible, wanted);
  }

  TempFolder temporary_;
};

#if !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
TEST_F(ReplaceFiles, AreOldOrNewWhateverFails) {
  for (const Files& old : {Files(), world("old")}) {
    for (const auto& [call, least] :
         {std::pair("open", 7), {"write", 10}, {"rename", 4}, {"unlink", 1}, {"fsync", 8}})
      EXPECT_GE(strike(call, false, old), least) << call;
    EXPECT_EQ(strike("link", false, old), int(old.size()));
  }
}

TEST_F(ReplaceFiles, AreOldOrNewWhereverTheProcessIsKilled) {
  for (const Files& old : {Files(), world("old")}) {
    for (const auto& [call, least] :
         {std::pair("open", 7), {"write", 10}, {"rename", 4}, {"unlink", 1}, {"fsync", 8}})
      EXPECT_GE(strike(call, true, old), least) << call;
    EXPECT_EQ(strike("link", true, old), int(old.size()));
  }
}

// The next run is killed as well while it puts back the old files.
TEST_F(ReplaceFiles, PuttingBackMayBeInterruptedToo) {
  const Files old = world("old"), made = world("new");
  const auto run = [&](const FailingCall& fault) {
    return test::run_failing({LIBATLAS_TEST_COMMIT_PROBE, folder().string(), "new"}, folder(),
                             fault);
  };
  for (const char* call : {"rename", "unlink"})
    for (int number = 1;; ++number) {
      fill(old);
      ASSERT_TRUE(run({"rename", 4, true}).struck);
      if (!run({call, number, true}).struck) break;
      next_run(folder());
      const Files left = test::files_in(folder());
      EXPECT_TRUE(left == old || left == made)
          << call << ' ' << number << ": " << testing::PrintToString(left);
    }
}

// What someone has put there since the run was killed is not touched.
TEST_F(ReplaceFiles, FilesOfOthersStay) {
  for (const Files& old : {Files(), world("old")}) {
    fill(old);
    ASSERT_TRUE(test::run_failing({LIBATLAS_TEST_COMMIT_PROBE, folder().string(), "new"}, folder(),
                                  {"rename", 4, true})
                    .struck);
    Files wanted = old;
    wanted["world_1.png"] = "of another program";
    fs::remove(folder() / "world_1.png");
    std::ofstream(folder() / "world_1.png") << wanted["world_1.png"];
    next_run(folder());
    EXPECT_EQ(test::files_in(folder()), wanted);
  }
}
// A link may lead the mesh to another folder.
TEST_F(ReplaceFiles, MayLieInSeveralFolders) {
  const Files old = world("old");
  for (int number = 1; number <= 4; ++number) {
    fill(old);
    fs::create_directories(folder() / "store");
    fs::rename(folder() / "world.obj", folder() / "store/real.obj");
    fs::create_symlink("store/real.obj", folder() / "world.obj");
    ASSERT_TRUE(test::run_failing({LIBATLAS_TEST_COMMIT_PROBE, folder().string(), "new"}, folder(),
                                  {"rename", number, true})
                    .struck);
    next_run(folder() / "store");  // whose part of the old world stays
    next_run(folder());
    EXPECT_TRUE(fs::is_symlink(folder() / "world.obj"));
    EXPECT_EQ(test::files_in(folder()), old);
    EXPECT_EQ(test::files_in(folder() / "store"), (Files{{"real.obj", old.at("world.obj")}}));
  }
}
#endif

// Two processes that write the same names never leave a file of each.
TEST_F(ReplaceFiles, CommitsComeOneAfterTheOther) {
  fill({});
  const auto commit = [&](const std::string& text) {
    for (int i = 0; i < 100; ++i) {
      AtomicFiles files;
      for (const auto& [name, bytes] : world(text))
        ASSERT_TRUE(files.write(folder() / name, bytes).ok());
      const Status status = files.commit();
      ASSERT_TRUE(status.ok()) << status.message();
    }
  };
  std::thread first(commit, "first"), second(commit, "second");
  first.join();
  second.join();
  const Files left = test::files_in(folder());
  EXPECT_TRUE(left == world("first") || left == world("second")) << testing::PrintToString(left);
}

TEST_F(ReplaceFiles, JournalsOfOthersAreRefused) {
  const std::string name = ".libatlas-commit-" + std::to_string(::geteuid());
  const auto message = [&] {
    AtomicFiles files;
    for (const char* target : {"a.txt", "b.txt"})
      EXPECT_TRUE(files.write(folder() / target, "x").ok());
    return files.commit().message();
  };
  fill({});
  EXPECT_EQ(message(), "");
  fill({{name, "p no journal"}});
  EXPECT_NE(message().find(name + ": is damaged, so it is not known"), std::string::npos);
  EXPECT_EQ(test::files_in(folder()).size(), 1u);
  fill({{"mine", "precious"}});
  fs::create_symlink("mine", folder() / name);
  EXPECT_NE(message().find(name + ": cannot be opened"), std::string::npos);
  fs::remove(folder() / name);
  fs::create_hard_link(folder() / "mine", folder() / name);
  EXPECT_NE(message().find(name + ": is not a journal of this user"), std::string::npos);
  EXPECT_EQ(TempFolder::read(folder() / "mine"), "precious");
}

}  // namespace
}  // namespace atlas
