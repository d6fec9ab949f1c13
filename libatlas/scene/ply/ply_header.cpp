#include "libatlas/scene/ply/ply_header.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <optional>

#include "libatlas/scene/files/text_scanner.h"

namespace atlas {
namespace {

std::optional<PlyType> type_named(std::string_view name) {
  constexpr struct {
    std::string_view name;
    PlyType type;
  } kTypes[] = {{"char", PlyType::i8},    {"uchar", PlyType::u8},   {"short", PlyType::i16},
                {"ushort", PlyType::u16}, {"int", PlyType::i32},    {"uint", PlyType::u32},
                {"float", PlyType::f32},  {"double", PlyType::f64}, {"int8", PlyType::i8},
                {"uint8", PlyType::u8},   {"int16", PlyType::i16},  {"uint16", PlyType::u16},
                {"int32", PlyType::i32},  {"uint32", PlyType::u32}, {"float32", PlyType::f32},
                {"float64", PlyType::f64}};
  for (const auto& entry : kTypes) {
    if (entry.name == name) return entry.type;
  }
  return {};
}

// Turns lone carriage returns that end lines into newlines; Rhinoceros 6 writes them even in binary
// files. The first line decides, because the data after the line end of `end_header` may begin with
// any byte, even a newline.
void turn_line_ends(FileBytes& bytes) {
  char *line = bytes.data.get(), *end = line + bytes.size;
  if (begins_with_mark(bytes)) std::fill_n(line, 3, ' ');
  const auto ends_line = [](char c) { return c == '\n' || c == '\r'; };
  char* stop = std::find_if(line, end, ends_line);
  if (*std::find_if(stop, end, [](char c) { return c != '\r'; }) == '\n') return;
  bool ascii = false;
  for (; stop != end; stop = std::find_if(line, end, ends_line)) {
    const std::string_view text(line, std::size_t(stop - line));
    ascii |= text.starts_with("format ascii");
    *stop = '\n';
    if (text.starts_with("end_header") && !ascii) return;
    line = stop + 1;
  }
}

class HeaderParser {
 public:
  HeaderParser(const FileBytes& bytes, const std::string& file)
      : bytes_(bytes),
        file_(file),
        scan_(bytes.begin(), bytes.end(), TextScanner::Lines::never_joined) {}

  Result<PlyHeader> run() {
    if (scan_.word() != "ply") return malformed("a PLY file begins with the line 'ply'");
    bool has_format = false;
    for (;;) {
      scan_.next_line();
      line_ = scan_.line();
      if (scan_.at_end()) return malformed("the file ends inside the header");
      const std::string_view keyword = scan_.word();
      if (keyword == "end_header") break;
      Status status;
      if (keyword == "format") {
        status = parse_format();
        has_format = true;
      } else if (keyword == "element") {
        status = parse_element();
      } else if (keyword == "property") {
        status = parse_property();
      } else if (keyword == "comment") {
        if (scan_.word() == "TextureFile")
          header_.texture_files.emplace_back(scan_.rest_with_comment());
      } else if (!carries_nothing(keyword)) {
        status =
            malformed(fmt::format("unknown keyword '{}' in the header", keyword.substr(0, 40)));
      }
      if (!status.ok()) return status;
    }
    if (!has_format) return malformed("the header has no format line");
    scan_.next_line();
    header_.bytes = static_cast<std::size_t>(scan_.position() - bytes_.begin());
    header_.lines = scan_.line();
    return std::move(header_);
  }

 private:
  // Blender 2.4 wrote the line `Created by Blender3D ...` without `comment` before it.
  static bool carries_nothing(std::string_view keyword) {
    return keyword.empty() || keyword == "obj_info" || keyword == "Created";
  }

  Status malformed(std::string_view what) const {
    return {ErrorCode::bad_input,
            fmt::format("{}:{}: {} (is it a PLY file? export it again)", file_, line_ + 1, what)};
  }

  Status parse_format() {
    const std::string_view name = scan_.word();
    if (name == "ascii") {
      header_.format = PlyFormat::ascii;
    } else if (name == "binary_little_endian") {
      header_.format = PlyFormat::little;
    } else if (name == "binary_big_endian") {
      header_.format = PlyFormat::big;
    } else {
      return malformed(fmt::format("unknown format '{}'", name.substr(0, 40)));
    }
    return {};
  }

  Status parse_element() {
    PlyElement element;
    element.name = scan_.word();
    const std::string_view count = scan_.word();
    const auto [stop, error] =
        std::from_chars(count.data(), count.data() + count.size(), element.count);
    if (element.name.empty() || error != std::errc{} || stop != count.data() + count.size()) {
      return malformed("an element line needs a name and a count");
    }
    header_.elements.push_back(std::move(element));
    return {};
  }

  Status parse_property() {
    if (header_.elements.empty()) return malformed("a property before the first element");
    PlyProperty property;
    std::string_view word = scan_.word();
    if (word == "list") {
      property.list = true;
      const auto length_type = type_named(scan_.word());
      if (!length_type || *length_type >= PlyType::f32) {
        return malformed("the length of a list needs an integer type");
      }
      property.length_type = *length_type;
      word = scan_.word();
    }
    const auto type = type_named(word);
    if (!type) return malformed(fmt::format("unknown type '{}'", word.substr(0, 40)));
    property.type = *type;
    property.name = scan_.word();
    if (property.name.empty()) return malformed("a property without a name");
    header_.elements.back().properties.push_back(std::move(property));
    return {};
  }

  const FileBytes& bytes_;
  const std::string& file_;
  TextScanner scan_;
  PlyHeader header_;
  std::uint32_t line_ = 0;
};

}  // namespace

int PlyElement::find(std::string_view property) const {
  for (std::size_t i = 0; i < properties.size(); ++i) {
    if (properties[i].name == property) return static_cast<int>(i);
  }
  return -1;
}

std::size_t PlyElement::least_bytes(PlyFormat format) const {
  std::size_t bytes = 0;
  for (const PlyProperty& p : properties) {
    bytes += format == PlyFormat::ascii ? 2 : ply_size(p.list ? p.length_type : p.type);
  }
  return bytes;
}

Result<PlyHeader> read_ply_header(FileBytes& bytes, const std::string& file) {
  turn_line_ends(bytes);
  return HeaderParser(bytes, file).run();
}

}  // namespace atlas
