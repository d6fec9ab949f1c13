// The names of temporary files, what is told of them, and what is said before anything is written.
#include <gtest/gtest.h>
#include <sys/stat.h>

#include <filesystem>
#include <fstream>
#include <string>
#include <utility>

#include "libatlas/files/atomic_file.h"
#include "libatlas/files/leftovers.h"
#include "tests/core/no_root.h"
#include "tests/support/temp_folder.h"

namespace atlas {
namespace {

namespace fs = std::filesystem;
using test::TempFolder;

TEST(AtomicNames, EndAtAWholeCharacter) {
  const TempFolder folder;
  AtomicFiles files;
  const std::string face = "\xf0\x9f\x98\x80";  // U+1F600
  for (const auto& [kept, rest] : {std::pair<std::size_t, const char*>{117, "at byte 120"},
                                   {118, "two bytes before"},
                                   {119, "one byte before"},
                                   {120, "after it"}}) {
    const std::string stem = std::string(kept, 'n') + face + face;
    const std::string name = files.path_for(folder / (stem + ".obj")).filename().string();
    EXPECT_EQ(name.rfind("." + std::string(kept, 'n') + "." + process_mark() + ".part.", 0), 0u)
        << rest << ": " << name;
  }
}

TEST(AtomicNames, LongExtensionsLeaveRoomForTheMark) {
  const TempFolder folder;
  const std::string name = "n." + std::string(240, 'x');
  const Status status = write_file(folder / name, "x");
  EXPECT_TRUE(status.ok()) << status.message();
  EXPECT_EQ(TempFolder::read(folder / name), "x");
}

TEST(AtomicNames, MessagesHaveTheNameThatWasGivenWhereverItStands) {
  const TempFolder folder;
  fs::create_directories(folder / "store");
  folder.write("store/real.png", "old");
  fs::create_symlink("store/real.png", folder / "page.png");
  AtomicFiles files;
  const std::string first = files.path_for(folder / "page.png").string();
  const std::string second = files.path_for(folder / "b.png").string();
  EXPECT_EQ(files.targets(), (std::vector<fs::path>{folder / "page.png", folder / "b.png"}));
  const Status told = files.told_by_target(
      {ErrorCode::io, "no room for " + second + ": " + first + ": cannot open " + first});
  const std::string page = (folder / "page.png").string();
  EXPECT_EQ(told.message(),
            "no room for " + (folder / "b.png").string() + ": " + page + ": cannot open " + page);
}

TEST(AtomicNames, DiscardedFilesGoAtOnceAndAreNotPutInPlace) {
  const TempFolder folder;
  const fs::path pipe = folder / "pipe";
  ASSERT_EQ(::mkfifo(pipe.c_str(), 0600), 0);
  AtomicFiles files;
  ASSERT_TRUE(files.write(folder / "kept.txt", "kept").ok());
  const fs::path dropped = files.path_for(folder / "dropped.txt");
  std::ofstream(dropped) << "dropped";
  ASSERT_TRUE(fs::exists(dropped));
  files.discard(dropped);
  EXPECT_FALSE(fs::exists(dropped));
  files.discard(files.path_for(pipe));
  EXPECT_TRUE(fs::is_fifo(pipe));
  EXPECT_EQ(files.targets(), (std::vector<fs::path>{folder / "kept.txt"}));
  ASSERT_TRUE(files.commit().ok());
  EXPECT_TRUE(files.targets().empty());
  EXPECT_FALSE(fs::exists(folder / "dropped.txt"));
  EXPECT_EQ(folder.count(), 2u);
}

// The earlier file is linked under another name before the new one would take its place.
TEST(AtomicNames, AFileThatWasNeverWrittenLeavesTheEarlierOneAlone) {
  const TempFolder folder;
  folder.write("world.obj", "old");
  AtomicFiles files;
  (void)files.path_for(folder / "world.obj");
  EXPECT_EQ(files.commit().code(), ErrorCode::io);
  EXPECT_EQ(TempFolder::read(folder / "world.obj"), "old");
  EXPECT_EQ(folder.count(), 1u);
}

TEST(CheckWritable, TellsWhatIsInTheWay) {
  const TempFolder folder;
  for (const char* name : {"taken", "dark/inside", "blind"}) fs::create_directories(folder / name);
  ASSERT_EQ(::chmod((folder / "dark").c_str(), 0), 0);
  ASSERT_EQ(::chmod((folder / "blind").c_str(), 0222), 0);  // it takes files only by name
  {
    const test::NoRoot user;
    for (const auto& [name, words] :
         {std::pair("dark/inside/a.txt", "inside cannot be looked at: Permission denied"),
          {"blind/a.txt", "blind does not take files: Permission denied (name another folder)"}}) {
      const Status status = check_writable(folder / name);
      EXPECT_EQ(status.code(), ErrorCode::io) << name;
      EXPECT_NE(status.message().find(words), std::string::npos) << status.message();
    }
  }
  const Status taken = check_writable(folder / "taken");
  EXPECT_NE(taken.message().find("has a directory of that name"), std::string::npos);
  for (const char* name : {"dark", "blind"}) ::chmod((folder / name).c_str(), 0755);
}

// A device such as /dev/full takes bytes though its folder takes no files.
TEST(CheckWritable, PipesNeedNoRoomInTheirFolder) {
  const TempFolder folder;
  fs::create_directories(folder / "closed");
  ASSERT_EQ(::mkfifo((folder / "closed/pipe").c_str(), 0666), 0);
  ASSERT_EQ(::chmod((folder / "closed").c_str(), 0555), 0);
  {
    const test::NoRoot user;
    EXPECT_TRUE(check_writable(folder / "closed/pipe").ok());
    EXPECT_FALSE(check_writable(folder / "closed/file").ok());
  }
  ::chmod((folder / "closed").c_str(), 0755);
}

}  // namespace
}  // namespace atlas
