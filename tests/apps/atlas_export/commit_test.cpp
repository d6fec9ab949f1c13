// A world is the old one or the new one, wherever the program is killed and whatever fails.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <map>
#include <string>
#include <vector>

#include "libatlas/files/atomic_file.h"
#include "tests/apps/atlas_export/run_export.h"
#include "tests/support/failing_calls.h"
#include "tests/support/temp_folder.h"

namespace atlas::test {
namespace {

#if !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
using Files = std::map<std::string, std::string>;

class Commit : public testing::Test {
 protected:
  void SetUp() override { folder_.write("box.obj", lit_box(1)); }
  fs::path out() const { return folder_ / "out"; }

  std::vector<std::string> command(const std::string& extension,
                                   const std::string& exposure) const {
    return {ATLAS_EXPORT,   (folder_ / "box.obj").string(),
            "-o",           (out() / ("w" + extension)).string(),
            "--atlas-size", "64",
            "--atlases",    "2",
            "--exposure",   exposure,
            "--threads",    "1",
            "--no-error",   "--no-simplify",
            "-q",           "--durable"};
  }

  void fill(const Files& files) const {
    fs::remove_all(out());
    fs::create_directories(out());
    for (const auto& [name, bytes] : files) std::ofstream(out() / name, std::ios::binary) << bytes;
  }

  Files world(const std::string& extension, const std::string& exposure) const {
    fill({});
    const FailingRun run = run_failing(command(extension, exposure), out(), {"none", 0, false});
    EXPECT_EQ(run.exit_code, 0);
    return files_in(out());
  }

  // Lets each call fail in turn, or kills the program before each. Returns the number of calls.
  int strike(const std::string& extension, const FailingCall& fault, const Files& old,
             const Files& made) const {
    for (int number = 1;; ++number) {
      fill(old);
      const FailingRun run =
          run_failing(command(extension, "2"), out(), {fault.call, number, fault.kills});
      EXPECT_FALSE(run.crashed);
      if (!run.struck) {
        EXPECT_EQ(files_in(out()), made);
        return number - 1;
      }
      EXPECT_TRUE(fault.kills || run.exit_code <= 1) << run.exit_code;
      // What the next run does before it writes. Its output may have another name.
      (void)AtomicFiles().path_for(out() / "other.obj");
      const Files left = files_in(out());
      EXPECT_TRUE(left == made || left == old) << extension << ", " << fault.call << ' ' << number
                                               << (fault.kills ? " kills" : " fails");
    }
  }

  TempFolder folder_;
};

TEST_F(Commit, KilledAtEveryRenameAndLink) {
  for (const std::string extension : {".wrl", ".wrz", ".gltf", ".glb", ".obj"}) {
    const Files before = world(extension, "1"), made = world(extension, "2");
    ASSERT_NE(before, made);
    for (const Files& old : {Files(), before}) {
      EXPECT_EQ(strike(extension, {"rename", 0, true}, old, made), int(made.size()));
      const bool linked = made.size() > 1;  // one file needs no journal
      EXPECT_EQ(strike(extension, {"link", 0, true}, old, made), linked ? int(old.size()) : 0);
      // The other names of the earlier files, and the journal; or both pages that one file holds.
      EXPECT_EQ(strike(extension, {"unlink", 0, true}, old, made),
                linked ? int(old.size()) + 1 : 2);
    }
  }
}

TEST_F(Commit, EachCallFailsInTurn) {
  const Files before = world(".obj", "1"), made = world(".obj", "2");
  ASSERT_EQ(made.size(), 4u) << "mesh, materials and two pages";
  for (const Files& old : {Files(), before})
    for (const char* call : {"open", "write", "link", "rename", "unlink", "fsync"}) {
      const int calls = strike(".obj", {call, 0, false}, old, made);
      EXPECT_GE(calls, std::string(call) == "link" ? int(old.size()) : 1) << call;
    }
}
#endif

}  // namespace
}  // namespace atlas::test
