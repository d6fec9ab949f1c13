#include "libatlas/scene/vrml/vrml_scanner.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <utility>

#include "libatlas/scene/files/text_scanner.h"

namespace atlas {

std::ptrdiff_t VrmlScanner::line_of(const char* place) const {
  return 1 + std::count(begin_, std::min(place, end_), '\n');
}

void VrmlScanner::fail(std::string what) {
  what_ = std::move(what);
  throw MalformedVrml();
}

void VrmlScanner::skip_blanks() {
  for (;;) {
    while (at_ < end_ &&
           (*at_ == ' ' || *at_ == '\n' || *at_ == ',' || *at_ == '\t' || *at_ == '\r')) {
      ++at_;
    }
    if (at_ >= end_ || *at_ != '#') return;
    while (at_ < end_ && *at_ != '\n') ++at_;
  }
}

bool VrmlScanner::breaks(char c) {
  return c == ' ' || c == '\n' || c == ',' || c == '\t' || c == '\r' || c == '{' || c == '}' ||
         c == '[' || c == ']' || c == '"' || c == '#';
}

std::string_view VrmlScanner::next() {
  skip_blanks();
  const char* start = at_;
  if (at_ >= end_) return {};
  if (*at_ == '"') {
    for (++at_; at_ < end_ && *at_ != '"'; ++at_) at_ += *at_ == '\\';
    if (at_ >= end_) fail("a string without an end");
    ++at_;
  } else if (breaks(*at_)) {
    ++at_;
  } else {
    while (at_ < end_ && !breaks(*at_)) ++at_;
  }
  return {start, std::size_t(at_ - start)};
}

std::string_view VrmlScanner::peek() {
  const char* before = at_;
  const std::string_view token = next();
  at_ = before;
  return token;
}

std::string_view VrmlScanner::start_of(std::string_view token) {
  return token.substr(0, std::min<std::size_t>(40, token.find('\n')));
}

void VrmlScanner::expect(std::string_view token) {
  if (next() != token) fail(fmt::format("'{}' expected", token));
}

bool VrmlScanner::number(double& value) {
  skip_blanks();
  const char* stop = at_ < end_ ? parse_number(at_, end_, value) : nullptr;
  if (!stop || (stop < end_ && !breaks(*stop))) return false;
  at_ = stop;
  return true;
}

bool VrmlScanner::integer(double& value) {
  skip_blanks();
  const bool sign = at_ < end_ && (*at_ == '-' || *at_ == '+');
  const char* digits = at_ + sign + 2;
  if (end_ - at_ < 3 + sign || digits[-2] != '0' || (digits[-1] | 32) != 'x') return number(value);
  std::uint32_t bits = 0;
  const auto [stop, error] = std::from_chars(digits, end_, bits, 16);
  if (stop == digits || error != std::errc() || (stop < end_ && !breaks(*stop))) return false;
  value = *at_ == '-' ? -double(bits) : double(static_cast<std::int32_t>(bits));
  at_ = stop;
  return true;
}

double VrmlScanner::integer() {
  double value = 0;
  if (!integer(value)) fail("an integer expected");
  return value;
}

std::vector<double> VrmlScanner::list(std::size_t width) {
  std::vector<double> values;
  numbers(&VrmlScanner::number, width, [&](double value) { values.push_back(value); });
  if (values.size() % width != 0) fail(fmt::format("a list of rows of {} with an odd end", width));
  return values;
}

std::vector<std::int32_t> VrmlScanner::indices() {
  constexpr std::int32_t kMost = std::numeric_limits<std::int32_t>::max();
  std::vector<std::int32_t> values;
  numbers(&VrmlScanner::integer, 1, [&](double value) {
    const bool usable = value == -1 || (value >= 0 && value <= kMost);
    values.push_back(usable ? static_cast<std::int32_t>(value) : kNoIndex);
  });
  return values;
}

void VrmlScanner::end_numbers() {
  if (peek() != "]") not_a_number();
  expect("]");
  tell();
}

void VrmlScanner::not_a_number() {
  fail(fmt::format("'{}' is not a number", start_of(peek())));
}

void VrmlScanner::tell() const {
  if (context_.cancelled()) throw MalformedVrml();
  const double done = double(at_ - begin_) / double(end_ - begin_);
  if (uses_ == 0) context_.report("reading", kScanned * done);
}

glm::dvec4 VrmlScanner::row(int width) {
  glm::dvec4 v(0);
  for (int i = 0; i < width; ++i) {
    if (!number(v[i])) fail("a number expected");
  }
  return v;
}

bool VrmlScanner::is_field(std::string_view token) {
  return !token.empty() && token[0] >= 'a' && token[0] <= 'z';
}

void VrmlScanner::skip_brackets() {
  constexpr std::ptrdiff_t kLong = 256;  // shorter ones are passed as fast as they are found
  std::vector<const char*> open{at_};
  while (!open.empty()) {
    const auto known = at_ == open.back() ? ends_.find(at_) : ends_.end();
    if (known != ends_.end()) {
      at_ = known->second;
      open.pop_back();
      continue;
    }
    const std::string_view token = next();
    if (token.empty()) fail("the file ends inside a node");
    if (token == "{" || token == "[") open.push_back(at_);
    if (token != "}" && token != "]") continue;
    if (at_ - open.back() >= kLong) ends_.emplace(open.back(), at_);
    open.pop_back();
  }
  if (context_.cancelled()) throw MalformedVrml();
}

void VrmlScanner::skip_node(std::string_view token) {
  if (token == "NULL") return;
  if (token == "USE") return void(next());
  std::string_view name;
  type_of(token, name);
  expect("{");
  skip_brackets();
}

void VrmlScanner::skip_route() {
  next();
  expect("TO");
  next();
}

// Nodes within are made where the name is used, and names that DEF gives them hold only within.
bool VrmlScanner::skip_prototype(std::string_view token) {
  const bool external = token == "EXTERNPROTO";
  if (token != "PROTO" && !external) return false;
  prototypes_.insert(next());
  expect("[");
  skip_brackets();
  if (external) {
    nodes([](std::string_view) {});  // its urls
  } else {
    expect("{");
    skip_brackets();
  }
  return true;
}

std::string_view VrmlScanner::type_of(std::string_view token, std::string_view& name) {
  if (token == "DEF") {
    name = next();
    token = next();
  }
  if (token.empty() || token[0] < 'A' || token[0] > 'Z') {
    fail(fmt::format("'{}' where a node should be", start_of(token)));
  }
  return token;
}

// Text counts once for each time that it is read, so that too much is refused before any of it is;
// USE in nodes that are not shown count, too. A USE within its own DEF counts nothing: it is
// refused when it is read.
void VrmlScanner::find_definitions() {
  struct Open {
    std::vector<Definition>* list;
    std::size_t number;
    int depth;        // of brackets around it
    double repeated;  // bytes that USE repeats within
  };
  std::vector<Open> open;
  int depth = 0;
  const char* before = at_;
  at_ = begin_;
  for (std::string_view token = next(); !token.empty(); token = next()) {
    if (skip_prototype(token)) continue;
    if (token == "DEF") {
      std::vector<Definition>& list = definitions_[next()];
      list.push_back({token.data(), 0});
      open.push_back({&list, list.size() - 1, depth, 0});
    } else if (token == "USE") {
      const auto found = definitions_.find(next());
      if (found != definitions_.end() && !open.empty())
        open.back().repeated += found->second.back().bytes;
    } else if (token == "{") {
      ++depth;
    } else if (token == "}") {
      for (--depth; !open.empty() && depth <= open.back().depth; open.pop_back()) {
        Definition& definition = (*open.back().list)[open.back().number];
        definition.bytes = double(at_ - definition.place) + open.back().repeated;
        if (open.size() > 1) open[open.size() - 2].repeated += open.back().repeated;
      }
    }
  }
  at_ = before;
  definitions_found_ = true;
}

void VrmlScanner::count_repeated(double bytes) {
  repeated_ += bytes;
  if (repeated_ > most_repeated_)
    fail(fmt::format(
        "USE repeats more than the {:.0f} MiB of text that are read of this file (make "
        "several files of it, or show less by USE; ReadOptions::limits lifts the limit)",
        most_repeated_ / (1 << 20)));
}

void VrmlScanner::count_uses() {
  expect("{");
  for (int open = 1; open > 0;) {
    const std::string_view token = next();
    if (token.empty()) fail("the file ends inside a node");
    open += token == "{" || token == "[" ? 1 : token == "}" || token == "]" ? -1 : 0;
    if (token == "USE") count_repeated(definition_of(next(), token.data()).bytes);
  }
}

const VrmlScanner::Definition& VrmlScanner::definition_of(std::string_view name, const char* use) {
  if (!definitions_found_) find_definitions();
  const auto found = definitions_.find(name);
  if (found != definitions_.end()) {
    const auto& places = found->second;
    const auto after =
        std::lower_bound(places.begin(), places.end(), use,
                         [](const Definition& d, const char* place) { return d.place < place; });
    if (after != places.begin()) return after[-1];
  }
  fail(fmt::format("USE of '{}', which no DEF before it names", start_of(name)));
}

void VrmlScanner::skip_value() {
  const auto ends = [](std::string_view token) {
    return token == "}" || token == "ROUTE" || token == "PROTO" || token == "EXTERNPROTO" ||
           is_field(token);
  };
  for (std::string_view token = peek(); !ends(token); token = peek()) {
    if (token.empty()) fail("the file ends inside a node");
    const bool names = token == "DEF" || token == "USE";
    next();
    if (names) next();
    if (token == "{" || token == "[") skip_brackets();
  }
}

void VrmlScanner::check_field(std::string_view token) {
  if (!is_field(token)) fail(fmt::format("'{}' where a field should be", start_of(token)));
}

}  // namespace atlas
