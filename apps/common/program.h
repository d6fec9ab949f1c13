// What every application does around its own work: exceptions, and output that nobody takes.
#pragma once

#include <cstdio>
#include <string>
#include <string_view>

namespace atlas::app {

// Runs `body` and gives the exit code of the program. What it throws (no memory is left, ...) is
// one line on stderr and 1, and what was begun is cleaned up. Standard streams that are closed
// are opened on /dev/null, so that no file written takes their place. A reader that leaves does
// not end the program; other failures to write to stdout make an exit code of 0 a 1.
int run_program(const char* name, int argc, char** argv, int (*body)(int argc, char** argv));

// To stdout or stderr; never throws. A failure on stdout is told when the program ends.
void print(std::FILE* stream, std::string_view text);

// Text for a terminal that may quote what files hold: control characters but line ends, which could
// change how all that follows looks, become '?', and words longer than a path can be lose their
// middle.
std::string printable(std::string_view text);

// The same with spaces for line ends, as messages of image libraries bring them.
std::string one_line(std::string_view text);

// "program: error: text" as one line on stderr.
void print_error(std::string_view program, std::string_view text);

}  // namespace atlas::app
