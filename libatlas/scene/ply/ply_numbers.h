// Internal: the numbers of a PLY file, in any of its formats.
#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>
#include <cstring>

#include "libatlas/scene/files/file_bytes.h"
#include "libatlas/scene/files/text_scanner.h"
#include "libatlas/scene/ply/ply_header.h"

namespace atlas {

// Reads numbers one after the other, whatever the format. A double holds every type exactly.
class PlyNumbers {
 public:
  PlyNumbers(const FileBytes& bytes, const PlyHeader& header)
      : format_(header.format),
        at_(bytes.begin() + header.bytes),
        end_(bytes.end()),
        scan_(at_, end_, TextScanner::Lines::never_joined),
        first_line_(header.lines) {}

  std::size_t bytes_left() const {
    return static_cast<std::size_t>(end_ - (format_ == PlyFormat::ascii ? scan_.position() : at_));
  }
  // Returns whether nothing but blanks and line ends follows.
  bool at_end() const {
    if (format_ != PlyFormat::ascii) return bytes_left() == 0;
    TextScanner ahead = scan_;
    while (!ahead.at_end() && ahead.at_line_end()) ahead.next_line();
    return ahead.at_end();
  }
  std::uint32_t line() const { return first_line_ + scan_.line() + 1; }  // ascii only

  void begin_element() {
    if (format_ != PlyFormat::ascii) return;
    while (!scan_.at_end() && scan_.at_line_end()) scan_.next_line();
  }
  void end_element() {
    if (format_ == PlyFormat::ascii) scan_.next_line();
  }

  bool next(PlyType type, double& value) {
    if (format_ == PlyFormat::ascii) return scan_.number(value);
    const std::size_t size = ply_size(type);
    if (static_cast<std::size_t>(end_ - at_) < size) return false;
    std::uint64_t bits = 0;
    std::memcpy(&bits, at_, size);
    if (format_ == PlyFormat::big) bits = __builtin_bswap64(bits) >> (64 - 8 * size);
    value = interpret(bits, type);
    at_ += size;
    return true;
  }

 private:
  static double interpret(std::uint64_t bits, PlyType type) {
    switch (type) {
      case PlyType::i8:
        return static_cast<std::int8_t>(bits);
      case PlyType::i16:
        return static_cast<std::int16_t>(bits);
      case PlyType::i32:
        return static_cast<std::int32_t>(bits);
      case PlyType::f32:
        return std::bit_cast<float>(static_cast<std::uint32_t>(bits));
      case PlyType::f64:
        return std::bit_cast<double>(bits);
      default:
        return static_cast<double>(bits);
    }
  }

  PlyFormat format_;
  const char *at_, *end_;
  TextScanner scan_;
  std::uint32_t first_line_;
};

}  // namespace atlas
