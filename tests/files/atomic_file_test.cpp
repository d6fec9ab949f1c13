#include "libatlas/files/atomic_file.h"

#include <gtest/gtest.h>
#include <signal.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <string>
#include <thread>
#include <utility>

#include "libatlas/files/leftovers.h"
#include "libatlas/files/links.h"
#include "tests/core/no_root.h"
#include "tests/support/full_disk.h"
#include "tests/support/temp_folder.h"

namespace atlas {
namespace {

using test::TempFolder;

TEST(AtomicFiles, AppearTogetherOrNotAtAll) {
  const TempFolder folder;
  folder.write("a.txt", "old");
  {
    AtomicFiles files;
    std::ofstream(files.path_for(folder / "a.txt")) << "new";
    std::ofstream(files.path_for(folder / "b.png")) << "picture";
    EXPECT_EQ(TempFolder::read(folder / "a.txt"), "old");
    EXPECT_EQ(folder.count(), 3u);
  }
  EXPECT_EQ(folder.count(), 1u);  // it was dropped without a commit
  EXPECT_EQ(TempFolder::read(folder / "a.txt"), "old");
  AtomicFiles files;
  const auto temporary = files.path_for(folder / "b.png");
  EXPECT_EQ(temporary.extension(), ".png");
  std::ofstream(temporary) << "picture";
  std::ofstream(files.path_for(folder / "a.txt")) << "new";
  ASSERT_TRUE(files.commit().ok());
  EXPECT_EQ(folder.count(), 2u);
  EXPECT_EQ(TempFolder::read(folder / "a.txt"), "new");
}

TEST(AtomicFiles, AFailedCommitTakesBackWhatItDid) {
  const TempFolder folder;
  {
    AtomicFiles files;
    std::ofstream(files.path_for(folder / "first.txt")) << "1";
    (void)files.path_for(folder / "never_written.txt");
    const Status status = files.commit();
    EXPECT_EQ(status.code(), ErrorCode::io);
    EXPECT_NE(status.message().find("never_written.txt"), std::string::npos);
  }
  EXPECT_EQ(folder.count(), 0u);
}

// If one of several files cannot be put in place, the others are restored.
TEST(AtomicFiles, AFailedCommitBringsBackWhatItReplaced) {
  const TempFolder folder;
  folder.write("old.txt", "old");
  std::filesystem::create_directories(folder / "taken.txt");
  const auto write = [&](AtomicFiles& files, const char* name) {
    std::ofstream(files.path_for(folder / name)) << "new";
  };
  {
    AtomicFiles files;
    for (const char* name : {"old.txt", "other.txt", "taken.txt", "last.txt"}) write(files, name);
    const Status status = files.commit();
    EXPECT_EQ(status.code(), ErrorCode::io);
    EXPECT_NE(status.message().find("taken.txt"), std::string::npos) << status.message();
  }
  EXPECT_EQ(TempFolder::read(folder / "old.txt"), "old");
  EXPECT_EQ(folder.count(), 2u);
  AtomicFiles files;
  for (const char* name : {"old.txt", "other.txt"}) write(files, name);
  EXPECT_TRUE(files.commit().ok());
  EXPECT_EQ(TempFolder::read(folder / "old.txt"), "new");
  EXPECT_EQ(folder.count(), 3u);
}

TEST(AtomicFiles, WriteFileReportsWhereItCannot) {
  const TempFolder folder;
  EXPECT_TRUE(write_file(folder / "x.json", "{}").ok());
  EXPECT_EQ(TempFolder::read(folder / "x.json"), "{}");
  const Status status = write_file(folder / "none" / "x.json", "{}");
  EXPECT_EQ(status.code(), ErrorCode::io);
  EXPECT_NE(status.message().find("x.json"), std::string::npos);
  // A folder of that name is in the way.
  std::filesystem::create_directories(folder / "taken" / "inside");
  EXPECT_EQ(write_file(folder / "taken", "{}").code(), ErrorCode::io);
  EXPECT_EQ(folder.count(), 2u);
}

TEST(AtomicFiles, NamesOfAnyLengthThatTheFileSystemTakes) {
  const TempFolder folder;
  AtomicFiles files;
  // Their temporary names would be equal after truncation, but they are separate files.
  for (const char* end : {"1.txt", "2.txt"})
    std::ofstream(files.path_for(folder / (std::string(250, 'n') + end))) << end;
  EXPECT_TRUE(check_writable(folder / (std::string(250, 'n') + "3.txt")).ok());
  ASSERT_TRUE(files.commit().ok());
  EXPECT_EQ(TempFolder::read(folder / (std::string(250, 'n') + "1.txt")), "1.txt");
  EXPECT_EQ(TempFolder::read(folder / (std::string(250, 'n') + "2.txt")), "2.txt");
  EXPECT_EQ(folder.count(), 2u);
  // The same holds for their extensions.
  for (const char* end : {"1", "2"})
    std::ofstream(files.path_for(folder / ("n." + std::string(70, 'x') + end))) << end;
  ASSERT_TRUE(files.commit().ok());
  EXPECT_EQ(TempFolder::read(folder / ("n." + std::string(70, 'x') + "1")), "1");
  EXPECT_EQ(TempFolder::read(folder / ("n." + std::string(70, 'x') + "2")), "2");
  const Status status = check_writable(folder / std::string(300, 'n'));
  EXPECT_EQ(status.code(), ErrorCode::io);
  EXPECT_NE(status.message().find("up to 255 bytes"), std::string::npos) << status.message();
}

TEST(AtomicFiles, AFolderThatTakesNoFileIsToldWithItsCause) {
  const TempFolder folder;
  folder.write("file", "");
  std::filesystem::create_directories(folder / "closed");
  ASSERT_EQ(::chmod((folder / "closed").c_str(), 0555), 0);
  const test::NoRoot user;
  for (const auto& [name, words] :
       {std::pair("closed/a.txt", "closed does not take files: Permission denied (name another"),
        {"absent/a.txt", "absent does not exist (create it first)"},
        {"file/a.txt", "file is not a directory (name a folder)"}}) {
    const Status status = check_writable(folder / name);
    EXPECT_EQ(status.code(), ErrorCode::io);
    EXPECT_NE(status.message().find(words), std::string::npos) << status.message();
  }
}

TEST(AtomicFiles, LinksAreFollowed) {
  const TempFolder folder;
  std::filesystem::create_directories(folder / "store");
  std::ofstream(folder / "store" / "real.txt") << "old";
  std::filesystem::create_symlink("store/real.txt", folder / "link.txt");
  ASSERT_TRUE(check_writable(folder / "link.txt").ok());
  ASSERT_TRUE(write_file(folder / "link.txt", "new").ok());
  EXPECT_TRUE(std::filesystem::is_symlink(folder / "link.txt"));
  EXPECT_EQ(TempFolder::read(folder / "store" / "real.txt"), "new");
}

// The first run through links to a file on another disk is to fill that disk, as the later ones do.
TEST(AtomicFiles, WhereLinksLeadToNoFileOneIsCreated) {
  const TempFolder folder;
  const auto link = [&](const char* to, const char* name) {
    std::filesystem::create_symlink(to, folder / name);
  };
  std::filesystem::create_directories(folder / "store" / "deep");
  link("store/deep", "folder");
  link("folder/../second", "first");  // the folder above deep is store, not the one of the link
  link("deep/third", "store/second");
  link((folder / "store" / "real.txt").c_str(), "store/deep/third");
  EXPECT_EQ(end_of_links(folder / "first"), folder / "store" / "real.txt");
  ASSERT_TRUE(check_writable(folder / "first").ok());
  for (const char* text : {"once", "twice"}) {
    ASSERT_TRUE(write_file(folder / "first", text).ok());
    EXPECT_EQ(TempFolder::read(folder / "store" / "real.txt"), text);
    for (const char* name : {"first", "store/second", "store/deep/third"})
      EXPECT_TRUE(std::filesystem::is_symlink(folder / name)) << name;
  }
}

TEST(AtomicFiles, LinksWithoutAnEndAreRefusedAndStay) {
  const TempFolder folder;
  for (const auto& [to, name] : {std::pair("b", "a"), {"a", "b"}, {"absent/c.txt", "c"}})
    std::filesystem::create_symlink(to, folder / name);
  for (const auto& [name, words] :
       {std::pair("a", "a: cannot be written: its symbolic links lead to no file but back to"),
        {"c", "absent does not exist (create it first)"}}) {
    const Status status = check_writable(folder / name);
    EXPECT_EQ(status.code(), ErrorCode::io) << name;
    EXPECT_NE(status.message().find(words), std::string::npos) << status.message();
    EXPECT_FALSE(write_file(folder / name, "text").ok()) << name;
    EXPECT_TRUE(std::filesystem::is_symlink(folder / name)) << name;
  }
  EXPECT_EQ(folder.count(), 3u);
}

TEST(AtomicFiles, DevicesAndPipesStayWhatTheyAre) {
  const TempFolder folder;
  const std::filesystem::path pipe = folder / "pipe";
  ASSERT_EQ(::mkfifo(pipe.c_str(), 0600), 0);
  std::string got;
  std::thread reader([&] { got = TempFolder::read(pipe); });
  const Status status = write_file(pipe, "through");
  reader.join();
  EXPECT_TRUE(status.ok()) << status.message();
  EXPECT_EQ(got, "through");
  EXPECT_TRUE(std::filesystem::is_fifo(pipe));
  EXPECT_EQ(folder.count(), 1u);
  {
    AtomicFiles dropped;
    EXPECT_EQ(dropped.path_for(pipe), pipe);
  }
  EXPECT_TRUE(std::filesystem::is_fifo(pipe));
}

TEST(AtomicFiles, MessagesNameTheTarget) {
  const TempFolder folder;
  AtomicFiles files;
  const auto temporary = files.path_for(folder / "page.png");
  const Status told =
      files.told_by_target({ErrorCode::io, temporary.string() + ": writing failed"});
  EXPECT_EQ(told.code(), ErrorCode::io);
  EXPECT_EQ(told.message(), (folder / "page.png").string() + ": writing failed");
}

// If the new content does not fit on the disk, the old file stays as it was.
TEST(AtomicFiles, AFullDiskChangesNothing) {
  const TempFolder folder;
  folder.write("x.json", "old");
  // The lengths are below and above what the C library buffers until a file is closed.
  for (const std::size_t length : {100u, 100'000u}) {
    Status status;
    {
      const test::FullDisk full(50);
      status = write_file(folder / "x.json", std::string(length, 'x'));
    }
    EXPECT_EQ(status.code(), ErrorCode::io) << length;
    EXPECT_NE(status.message().find("x.json: writing failed: File too large"), std::string::npos)
        << status.message();
    EXPECT_EQ(TempFolder::read(folder / "x.json"), "old");
    EXPECT_EQ(folder.count(), 1u);
  }
}

// Two threads of one program export to the same name, or share the name of a page (a.wrl and
// a.gltf). Each output must be complete.
TEST(AtomicFiles, TwoAtOnceDoNotShareATemporaryFile) {
  const TempFolder folder;
  AtomicFiles first, second;
  ASSERT_TRUE(first.write(folder / "a.png", "the first").ok());
  ASSERT_TRUE(second.write(folder / "a.png", "second").ok());
  EXPECT_TRUE(first.commit().ok());
  EXPECT_EQ(TempFolder::read(folder / "a.png"), "the first");
  EXPECT_TRUE(second.commit().ok());
  EXPECT_EQ(TempFolder::read(folder / "a.png"), "second");
  EXPECT_EQ(folder.count(), 1u);
}

// A process that is killed before it commits, and the files that it had begun.
class KilledWriter {
 public:
  explicit KilledWriter(const std::filesystem::path& target) : process_(::fork()) {
    if (process_ != 0) return;
    AtomicFiles files;
    const auto temporary = files.path_for(target);
    std::ofstream(temporary) << "half";
    for (;;) ::pause();
  }
  ~KilledWriter() { kill(); }
  void kill() {
    if (process_ <= 0) return;
    ::kill(process_, SIGKILL);
    ::waitpid(process_, nullptr, 0);
    process_ = 0;
  }

 private:
  pid_t process_;
};

void wait_for_files(const TempFolder& folder, std::size_t count) {
  for (int i = 0; i < 1000 && folder.count() < count; ++i) ::usleep(10'000);
  ASSERT_EQ(folder.count(), count);
}

TEST(AtomicFiles, WhatAKilledProcessLeftGoesWithTheNextOutput) {
  const TempFolder folder;
  folder.write("world.obj", "old");
  folder.write(".world.0badf00d-1234567.part.obj", "of another machine");
  folder.write(".notes.part.obj", "the user's own");
  const std::string mark = process_mark(), world = mark.substr(0, mark.rfind('-') + 1);
  const std::string nobodys = ".world." + world + "none.part.obj";  // names no process
  folder.write(nobodys, "the user's own");
  KilledWriter writer(folder / "world.obj");
  wait_for_files(folder, 5);
  ASSERT_TRUE(write_file(folder / "other.txt", "x").ok());
  EXPECT_EQ(folder.count(), 6u) << "files of a process at work are taken away";
  writer.kill();
  ASSERT_TRUE(write_file(folder / "world.obj", "new").ok());
  EXPECT_EQ(TempFolder::read(folder / "world.obj"), "new");
  EXPECT_EQ(folder.count(), 5u);
  EXPECT_TRUE(std::filesystem::exists(folder / nobodys));
  EXPECT_TRUE(std::filesystem::exists(folder / ".world.0badf00d-1234567.part.obj"));
  EXPECT_TRUE(std::filesystem::exists(folder / ".notes.part.obj"));
}

}  // namespace
}  // namespace atlas
