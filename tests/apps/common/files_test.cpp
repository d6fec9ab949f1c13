// The checks of outputs, and the reading of lists.
#include "apps/common/files.h"

#include <gtest/gtest.h>
#include <sys/stat.h>

#include <atomic>
#include <chrono>
#include <filesystem>
#include <fstream>
#include <string>
#include <thread>
#include <utility>

#include "tests/support/temp_folder.h"

namespace atlas::app {
namespace {

namespace fs = std::filesystem;
using test::TempFolder;

TEST(Outputs, AreNoFileThatIsRead) {
  const TempFolder folder;
  const fs::path in = folder.write("in.obj", "v"), other = folder.write("other.obj", "v");
  fs::create_directories(folder / "sub");
  fs::create_symlink(in, folder / "link.obj");
  fs::create_hard_link(in, folder / "hard.obj");
  fs::create_directory_symlink(folder.path(), folder / "sub/up");
  for (const fs::path& output :
       {in, folder / "./in.obj", folder / "sub/../in.obj", folder / "link.obj", folder / "hard.obj",
        folder / "sub/up/in.obj"}) {
    const Status s = check_output(output, {other, in});
    EXPECT_EQ(s.code(), ErrorCode::bad_option) << output;
    EXPECT_TRUE(s.message().starts_with(output.string() + ": would overwrite ")) << s.message();
  }
  EXPECT_TRUE(check_output(other, {in}).ok());
  EXPECT_TRUE(check_output(folder / "new.obj", {in, other}).ok());
  EXPECT_TRUE(check_output("", {in}).ok());
  EXPECT_TRUE(check_output(in, {"", ""}).ok());
}

// Two outputs that do not exist yet may still be one file.
TEST(Outputs, ThatAreNotThereYetAreComparedByNameAndFolder) {
  const TempFolder folder;
  fs::create_directories(folder / "sub");
  const fs::path a = folder / "a.wrl";
  EXPECT_FALSE(check_output(a, {folder / "sub/../a.wrl"}).ok());
  EXPECT_TRUE(check_output(a, {folder / "sub/a.wrl"}).ok());
  EXPECT_TRUE(check_output(a, {folder / "b.wrl"}).ok());
  EXPECT_TRUE(check_output(a, {folder / "gone/a.wrl"}).ok());
  fs::create_symlink("sub/../a.wrl", folder / "link.wrl");
  EXPECT_FALSE(check_output(a, {folder / "link.wrl"}).ok());
  EXPECT_FALSE(check_output(folder / "link.wrl", {a}).ok());
  EXPECT_TRUE(check_output(folder / "link.wrl", {folder / "b.wrl"}).ok());
  const fs::path before = fs::current_path();
  fs::current_path(folder.path());
  EXPECT_FALSE(check_output("a.wrl", {"./a.wrl"}).ok());
  EXPECT_FALSE(check_output(a, {"a.wrl"}).ok());
  EXPECT_TRUE(check_output("a.wrl", {"sub/a.wrl"}).ok());
  fs::current_path(before);
}

TEST(Outputs, ThatCannotBeWrittenAreRefused) {
  const TempFolder folder;
  EXPECT_EQ(check_output(folder / "gone/a.wrl", {}).code(), ErrorCode::io);
  const Status dash = check_output("-", {});
  EXPECT_EQ(dash.code(), ErrorCode::bad_option);
  EXPECT_NE(dash.message().find("/dev/stdout"), std::string::npos);
}

// Longer than what one call reads.
TEST(Lists, AreReadWhole) {
  const TempFolder folder;
  std::string text;
  for (int i = 0; i < 40'000; ++i) text += std::to_string(i) + '\n';
  ASSERT_GT(text.size(), 3u << 16);
  const Result<std::string> read = read_text(folder.write("l", text), {});
  ASSERT_TRUE(read.ok());
  EXPECT_EQ(*read, text);
  const Result<std::string> empty = read_text(folder.write("e", ""), {});
  ASSERT_TRUE(empty.ok());
  EXPECT_EQ(*empty, "");
}

TEST(Lists, ThatCannotBeReadSayWhy) {
  const TempFolder folder;
  folder.write("f", "");
  const auto why = [](const fs::path& path) {
    const Result<std::string> read = read_text(path, {});
    EXPECT_FALSE(read.ok()) << path;
    return std::pair(read.status().code(), read.status().message());
  };
  const auto gone = folder / "gone", below = folder / "f/below";
  EXPECT_EQ(why(gone),
            std::pair(ErrorCode::not_found, gone.string() + ": no such file (check the name)"));
  EXPECT_EQ(why(folder.path()).first, ErrorCode::bad_input);
  EXPECT_EQ(why(below),
            std::pair(ErrorCode::io, below.string() + ": cannot be read: Not a directory"));
}

// The writer comes late and pauses, and nobody waits for one after the context is cancelled.
TEST(Lists, MayComeFromAPipe) {
  const TempFolder folder;
  const fs::path pipe = folder / "pipe";
  ASSERT_EQ(::mkfifo(pipe.c_str(), 0600), 0);
  const auto soon = std::chrono::milliseconds(150);
  std::thread writer([&] {
    std::this_thread::sleep_for(soon);
    std::ofstream stream(pipe);
    stream << "5,6\n" << std::flush;
    std::this_thread::sleep_for(soon);
    stream << "7,8\n";
  });
  const Result<std::string> read = read_text(pipe, {});
  writer.join();
  ASSERT_TRUE(read.ok());
  EXPECT_EQ(*read, "5,6\n7,8\n");
  std::atomic<bool> cancel{false};
  std::thread user([&] {
    std::this_thread::sleep_for(soon);
    cancel = true;
  });
  Context context;
  context.cancel = &cancel;
  const Result<std::string> none = read_text(pipe, context);
  user.join();
  EXPECT_EQ(none.status().code(), ErrorCode::cancelled);
}

}  // namespace
}  // namespace atlas::app
