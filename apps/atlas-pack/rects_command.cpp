#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <nlohmann/json.hpp>
#include <optional>
#include <set>
#include <sstream>
#include <utility>

#include "apps/atlas-pack/commands.h"
#include "apps/atlas-pack/preview.h"
#include "apps/common/files.h"
#include "libatlas/core/counted.h"
#include "libatlas/files/atomic_file.h"
#include "libatlas/files/file_extension.h"

namespace atlas::app {
namespace {

Status bad_line(const PackCommand& c, std::size_t line, const std::string& what) {
  return {ErrorCode::bad_input, fmt::format("{}:{}: {}", c.input.string(), line, what)};
}

bool to_side(std::string field, std::int32_t& side) {
  const auto first = field.find_first_not_of(" \t\r"), last = field.find_last_not_of(" \t\r");
  if (first == std::string::npos) return false;
  field = field.substr(first, last - first + 1);
  const auto [end, error] = std::from_chars(field.data(), field.data() + field.size(), side);
  return error == std::errc() && end == field.data() + field.size();
}

bool has_digit(const std::string& field) {
  return field.find_first_of("0123456789") != std::string::npos;
}

// Returns what separates the fields of a line: commas, or semicolons, tabs or spaces (in this
// order) if it has none. Those inside quotes do not count.
char separator_of(const std::string& line) {
  bool quoted = false, semicolon = false, tab = false;
  for (const char ch : line) {
    if (ch == '"') quoted = !quoted;
    if (quoted) continue;
    if (ch == ',') return ch;
    semicolon |= ch == ';';
    tab |= ch == '\t';
  }
  return semicolon ? ';' : tab ? '\t' : ' ';
}

std::vector<std::string> split(const std::string& line) {
  const char separator = separator_of(line);
  std::vector<std::string> fields{""};
  bool quoted = false;
  for (std::size_t i = 0; i < line.size(); ++i) {
    const char ch = line[i];
    if (ch == '"' && quoted && i + 1 < line.size() && line[i + 1] == '"') {
      fields.back() += line[++i];
    } else if (ch == '"') {
      quoted = !quoted;
    } else if (ch == separator && !quoted) {
      if (separator != ' ' || !fields.back().empty()) fields.emplace_back();
    } else {
      fields.back() += ch;
    }
  }
  if (separator == ' ' && fields.back().empty()) fields.pop_back();
  return fields;
}

// Removes the comment. A '#' begins one at the line's start and after two numbers; inside a name it
// is a letter. After a few of those the search ends, since each takes time in proportion to the
// line.
std::string without_comment(const std::string& line) {
  constexpr int kMostTried = 64;
  const std::size_t start = line.find_first_not_of(" \t");
  if (start != std::string::npos && line[start] == '#') return {};
  int tried = 0;
  for (std::size_t i = 0; tried < kMostTried && (i = line.find('#', i)) != line.npos; ++i) {
    if (line[i - 1] != ' ' && line[i - 1] != '\t') continue;
    ++tried;
    const std::string before = line.substr(0, i);
    const std::vector<std::string> f = split(before.substr(0, before.find_last_not_of(" \t") + 1));
    std::int32_t side = 0;
    if ((f.size() == 2 || f.size() == 3) && to_side(f.back(), side) &&
        to_side(f[f.size() - 2], side))
      return before;
  }
  return line;
}

// The contents of a file of rectangles.
struct RectList {
  std::vector<PackedItem> items;
  std::optional<Extent> page;  // the page of an instance
};

struct CsvLine {
  std::size_t number = 0;
  std::vector<std::string> fields;
};

// Makes all lines end with line feeds. They may end with carriage returns, with line feeds or
// alone.
std::string with_line_feeds(std::string text) {
  std::size_t to = 0;
  for (std::size_t i = 0; i < text.size(); ++i)
    if (text[i] != '\r')
      text[to++] = text[i];
    else if (i + 1 == text.size() || text[i + 1] != '\n')
      text[to++] = '\n';
  text.resize(to);
  return text;
}

Result<std::vector<CsvLine>> csv_lines(const PackCommand& c, const std::string& text) {
  std::vector<CsvLine> result;
  std::istringstream lines(with_line_feeds(text));
  std::string line;
  bool header_seen = false;
  for (std::size_t number = 1; std::getline(lines, line); ++number) {
    line = without_comment(line);
    line.resize(line.find_last_not_of(" \t") + 1);
    if (line.empty()) continue;
    std::vector<std::string> f = split(line);
    const std::size_t n = f.size();
    if (n != 2 && n != 3)
      return bad_line(c, number,
                      fmt::format("{} (expected width,height or "
                                  "name,width,height)",
                                  counted(n, "field")));
    const bool header = !has_digit(f[n - 2]) && !has_digit(f[n - 1]);
    if (header && result.empty() && !std::exchange(header_seen, true)) continue;
    result.push_back({number, std::move(f)});
  }
  return result;
}

// Reads the head of published instances. Their first line is `width height count` with the sides of
// the page (height 0: a strip); then each line is a rectangle without a name. Leaves other lists as
// they are.
Status read_instance_head(const PackCommand& c, std::vector<CsvLine>& lines, RectList& list) {
  const auto unnamed = [](const CsvLine& line) { return line.fields.size() == 2; };
  std::int32_t width = 0, height = 0, count = 0;
  if (lines.size() < 2 || unnamed(lines[0]) ||
      !std::all_of(lines.begin() + 1, lines.end(), unnamed) ||
      !to_side(lines[0].fields[0], width) || !to_side(lines[0].fields[1], height) ||
      !to_side(lines[0].fields[2], count) || width < 1 || height < 0)
    return {};
  if (std::size_t(std::max(count, 0)) != lines.size() - 1)
    return bad_line(c, lines[0].number,
                    fmt::format("a page of {} x {} and {} rectangles, but {} lines follow (or name "
                                "all rectangles, if this is one)",
                                width, height, count, lines.size() - 1));
  list.page = Extent{width, height};
  lines.erase(lines.begin());
  return {};
}

Status read_csv(const PackCommand& c, const std::string& text, RectList& list) {
  Result<std::vector<CsvLine>> lines = csv_lines(c, text);
  if (!lines.ok()) return lines.status();
  if (Status s = read_instance_head(c, *lines, list); !s.ok()) return s;
  for (const auto& [number, f] : *lines) {
    PackedItem item;
    const std::size_t n = f.size();
    if (!to_side(f[n - 2], item.size.width) || !to_side(f[n - 1], item.size.height))
      return bad_line(c, number,
                      fmt::format("'{}' and '{}' are not two whole numbers (sides in "
                                  "texels, at most 2147483647)",
                                  f[n - 2], f[n - 1]));
    if (item.size.width < 0 || item.size.height < 0)
      return bad_line(c, number, "a side is negative (sides are 0 or more)");
    item.name = n == 3 ? f[0] : std::to_string(list.items.size());
    list.items.push_back(std::move(item));
  }
  return {};
}

Status read_json(const PackCommand& c, const std::string& text, std::vector<PackedItem>& items) {
  const auto bad = [&](const std::string& what) {
    return Status(ErrorCode::bad_input, fmt::format("{}: {}", c.input.string(), what));
  };
  nlohmann::json root;
  try {
    root = nlohmann::json::parse(text);
  } catch (const nlohmann::json::parse_error& error) {
    const auto end = text.begin() + std::ptrdiff_t(std::min(error.byte, text.size()));
    return bad_line(c, std::size_t(std::count(text.begin(), end, '\n')) + 1,
                    "not valid JSON (was it cut short?)");
  } catch (const nlohmann::json::exception&) {
    return bad("holds a number beyond all bounds (sides are whole numbers up to 2147483647)");
  }
  const nlohmann::json& list = root.is_object() && root.contains("rects") ? root["rects"] : root;
  if (!list.is_array())
    return bad("holds no list (write an array of [w, h] or {\"name\", \"w\", \"h\"})");
  for (std::size_t i = 0; i < list.size(); ++i) {
    const nlohmann::json& e = list[i];
    // Elements are not copied: a copy calls itself for each level, so a million brackets would
    // overflow the stack.
    const auto side = [&](std::size_t at, const char* brief, const char* full) -> std::int64_t {
      const nlohmann::json* v = e.is_array() && e.size() == 2 ? &e[at] : nullptr;
      for (const char* name : {full, brief})
        if (e.is_object() && e.contains(name)) v = &e[name];
      return v && v->is_number_integer() ? v->get<std::int64_t>() : -1;
    };
    const std::int64_t w = side(0, "w", "width"), h = side(1, "h", "height");
    if (w < 0 || h < 0 || w > INT32_MAX || h > INT32_MAX)
      return bad(
          fmt::format("element {} has no whole sides of 0 or more (as [w, h] or \"w\", "
                      "\"h\")",
                      i));
    PackedItem item;
    item.size = {static_cast<std::int32_t>(w), static_cast<std::int32_t>(h)};
    item.name = e.is_object() && e.contains("name") && e["name"].is_string()
                    ? e["name"].get<std::string>()
                    : std::to_string(i);
    items.push_back(std::move(item));
  }
  return {};
}

// Refuses equal names if the output is a JSON object, which holds only one item per name.
Status check_names(const PackCommand& c, const std::vector<PackedItem>& items) {
  if (lower_extension(c.output) != ".json" || c.format != DataFormat::hash) return {};
  std::set<std::string> names;
  for (const PackedItem& item : items)
    if (!names.insert(name_in_json(item.name)).second)
      return {ErrorCode::bad_input,
              fmt::format("{}: two items are called '{}' (name them apart, or use --data array)",
                          c.input.string(), item.name)};
  return {};
}

// Reads the list from a file or a pipe.
Status read_list(const PackCommand& c, const Context& context, RectList& list) {
  Result<std::string> read = read_text(c.input, context);
  if (!read.ok()) return read.status();
  std::string& text = *read;
  // Spreadsheets write a byte order mark.
  if (text.starts_with("\xef\xbb\xbf")) text.erase(0, 3);
  const bool json = lower_extension(c.input) == ".json" && !text.empty();
  if (Status s = json ? read_json(c, text, list.items) : read_csv(c, text, list); !s.ok()) return s;
  if (list.items.empty())
    return {ErrorCode::bad_input,
            fmt::format("{}: holds no rectangle (write width,height or name,width,height a line, "
                        "or a JSON array)",
                        c.input.string())};
  return check_names(c, list.items);
}

// Reports the first few unplaced items in a line each, and all others in one line.
void tell_unplaced(std::span<const UnplacedItem> unplaced, std::span<const PackedItem> items,
                   const Context& context) {
  constexpr std::size_t kTold = 10;
  for (const UnplacedItem& u : unplaced.first(std::min(kTold, unplaced.size()))) {
    const PackedItem& item = items[u.item];
    context.say(fmt::format(
        "{} ({} x {}) {}", item.name, item.source.width, item.source.height,
        u.reason == UnplacedReason::too_large ? "is larger than the page" : "has no room left"));
  }
  if (unplaced.size() > kTold)
    context.say(
        fmt::format("and {} more of {} are not placed", unplaced.size() - kTold, items.size()));
}

}  // namespace

Result<PackedAtlas> run_rects(const PackCommand& c, const Context& context) {
  const std::string ending = lower_extension(c.output);
  if (ending != ".csv" && ending != ".json")
    return Status(ErrorCode::bad_option,
                  fmt::format("{}: unknown format (use .csv or .json)", c.output.string()));
  if (Status s = check_output(c.output, {c.input, c.preview}); !s.ok()) return s;
  if (Status s = check_preview(c); !s.ok()) return s;
  RectList list;
  if (Status s = read_list(c, context, list); !s.ok()) return s;
  PackOptions options = c.options;
  if (list.page && !c.page_given) options.page = *list.page;
  std::vector<PackedItem>& items = list.items;
  std::vector<Extent> sizes;
  for (PackedItem& item : items) {
    item.source = item.size;
    sizes.push_back(item.size);
  }
  Result<PackResult> packed = pack_rects(sizes, options, context);
  if (!packed.ok()) return packed.status();
  tell_unplaced(packed->unplaced, items, context);
  PackedAtlas atlas = make_atlas(std::move(items), *packed);
  const std::string placed =
      ending == ".json" ? to_json(atlas, c.format, kAllPages) : to_csv(atlas);
  AtomicFiles files;
  if (Status s = files.write(c.output, placed); !s.ok()) return s;
  if (!c.preview.empty())
    if (Status s = write_preview(c.preview, atlas, files); !s.ok()) return s;
  atlas.files = {c.output};
  if (Status s = files.commit(); !s.ok()) return s;
  return atlas;
}

}  // namespace atlas::app
