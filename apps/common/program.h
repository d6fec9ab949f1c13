// What every application does around its own work: it handles exceptions, signals and standard
// streams.
#pragma once

#include <cstdio>
#include <filesystem>
#include <string>
#include <string_view>

namespace atlas::app {

// Runs `body` and returns the exit code of the program. An exception (out of memory, ...) becomes
// one line on stderr and exit code 1, after what was begun has been cleaned up. Standard streams
// that are closed are opened on /dev/null, so that no file that is written takes their place. A
// reader that closes its end of a pipe does not end the program; other failures to write to stdout
// turn exit code 0 into 1.
int run_program(const char* name, int argc, char** argv, int (*body)(int argc, char** argv));

// Sets the file that is being worked on, which run_program() names if memory runs out.
void name_input(const std::filesystem::path& file);

// Writes to stdout or stderr; never throws. A failure on stdout is reported when the program ends.
void print(std::FILE* stream, std::string_view text);

// Returns whether a byte of UTF-8 goes on with a character that an earlier byte has begun.
bool continues_character(char c);

// Returns a text, which may quote the contents of files, so that a terminal can show it: control
// characters except line ends, which could change how everything after them looks, become '?', and
// words longer than any path lose their middle.
std::string printable(std::string_view text);

// The same with spaces instead of line ends, which messages of image libraries contain.
std::string one_line(std::string_view text);

// Prints "program: error: text" as one line on stderr.
void print_error(std::string_view program, std::string_view text);

}  // namespace atlas::app
