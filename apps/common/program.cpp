#include "apps/common/program.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <csignal>
#include <cstring>
#include <exception>
#include <new>

namespace atlas::app {
namespace {

int g_stdout_error = 0;  // errno of the first failure
std::string g_input;     // of name_input(); made before memory runs out

void note_stdout(bool written) {
  if (!written && g_stdout_error == 0) g_stdout_error = errno ? errno : EIO;
}

void open_closed_streams() {
  for (const int stream : {STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO}) {
    // open() returns the lowest free number, which is the stream's own.
    if (::fcntl(stream, F_GETFD) == -1 && errno == EBADF && ::open("/dev/null", O_RDWR) < 0) return;
  }
}

int complain(const char* name, std::string_view what) {
  print_error(name, what);
  return 1;
}

std::string shortened(std::string_view word) {
  constexpr std::size_t kLongest = 4096, kShown = 100;  // bytes
  if (word.size() <= kLongest) return std::string(word);
  std::size_t head = kShown, tail = word.size() - kShown;
  while (head > 0 && continues_character(word[head])) --head;
  while (tail < word.size() && continues_character(word[tail])) ++tail;
  return fmt::format("{}...{}", word.substr(0, head), word.substr(tail));
}

// Replaces control characters except line feeds by '?'. Unicode has two ranges of them; UTF-8
// encodes the second one in two bytes.
std::string without_controls(std::string_view text) {
  std::string plain;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const auto c = static_cast<unsigned char>(text[i]);
    const bool second =
        c == 0xc2 && i + 1 < text.size() && static_cast<unsigned char>(text[i + 1]) < 0xa0;
    if (second) ++i;
    plain += (c < 0x20 && c != '\n') || c == 0x7f || second ? '?' : text[i];
  }
  return plain;
}

}  // namespace

bool continues_character(char c) {
  return (static_cast<unsigned char>(c) & 0xc0) == 0x80;
}

void print(std::FILE* stream, std::string_view text) {
  errno = 0;
  const bool written = std::fwrite(text.data(), 1, text.size(), stream) == text.size();
  if (stream == stdout) note_stdout(written && std::fflush(stream) == 0);
}

std::string printable(std::string_view text) {
  const std::string plain = without_controls(text);
  std::string out;
  for (std::size_t at = 0; at < plain.size();) {
    const std::size_t end = std::min(plain.find_first_of(" \n", at), plain.size());
    out += shortened(std::string_view(plain).substr(at, end - at));
    if (end < plain.size()) out += plain[end];
    at = end + 1;
  }
  return out;
}

std::string one_line(std::string_view text) {
  while (!text.empty() && text.back() == '\n') text.remove_suffix(1);
  std::string line = printable(text);
  std::replace(line.begin(), line.end(), '\n', ' ');
  return line;
}

void print_error(std::string_view program, std::string_view text) {
  print(stderr, fmt::format("{}: error: {}\n", program, one_line(text)));
}

void name_input(const std::filesystem::path& file) {
  g_input = file.string() + ": ";
}

int run_program(const char* name, int argc, char** argv, int (*body)(int, char**)) {
  open_closed_streams();
  // A reader that has left, and a limit on the size of files, become errors of writing, which are
  // reported.
  std::signal(SIGPIPE, SIG_IGN);
  std::signal(SIGXFSZ, SIG_IGN);
  int code = 1;
  try {
    code = body(argc, argv);
  } catch (const std::bad_alloc&) {
    code = complain(name,
                    g_input + "out of memory (fewer --threads, smaller pages or a smaller input)");
  } catch (const std::exception& error) {
    code = complain(name, error.what());
  }
  errno = 0;
  note_stdout(std::fflush(stdout) == 0 && !std::ferror(stdout));
  if (code == 0 && g_stdout_error != 0 && g_stdout_error != EPIPE)
    code = complain(name, fmt::format("standard output: {}", std::strerror(g_stdout_error)));
  return code;
}

}  // namespace atlas::app
