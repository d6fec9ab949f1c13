#include "apps/atlas-pack/frame_names.h"

#include <algorithm>
#include <map>

namespace atlas::app {
namespace {

bool is_digit(char c) {
  return c >= '0' && c <= '9';
}

// Returns the number at the front of a text, without leading zeros, and removes it from the text.
std::string_view take_number(std::string_view& text) {
  const auto count_front = [](std::string_view of, auto belongs) {
    return std::size_t(std::find_if_not(of.begin(), of.end(), belongs) - of.begin());
  };
  std::string_view number = text.substr(0, count_front(text, is_digit));
  text.remove_prefix(number.size());
  number.remove_prefix(count_front(number, [](char c) { return c == '0'; }));
  return number;
}

// Returns a number below, equal to or above 0, as the name a comes before, with or after b.
int compare_names(std::string_view a, std::string_view b) {
  while (!a.empty() && !b.empty()) {
    if (is_digit(a.front()) && is_digit(b.front())) {
      const std::string_view x = take_number(a), y = take_number(b);
      if (x.size() != y.size()) return x.size() < y.size() ? -1 : 1;
      if (const int by_digits = x.compare(y); by_digits != 0) return by_digits;
    } else if (a.front() != b.front()) {
      return static_cast<unsigned char>(a.front()) < static_cast<unsigned char>(b.front()) ? -1 : 1;
    } else {
      a.remove_prefix(1);
      b.remove_prefix(1);
    }
  }
  return int(!a.empty()) - int(!b.empty());
}

// Returns the name of the animation that an image belongs to; empty if it belongs to none.
std::string animation_of(std::string_view name) {
  const std::size_t slash = name.rfind('/');
  const std::size_t file = slash == std::string_view::npos ? 0 : slash + 1;
  if (const std::size_t dot = name.rfind('.'); dot != std::string_view::npos && dot > file)
    name = name.substr(0, dot);
  const std::size_t numbered = name.size();
  while (name.size() > file && is_digit(name.back())) name.remove_suffix(1);
  if (name.size() == numbered) return {};
  while (!name.empty() && std::string_view(" _-./").find(name.back()) != std::string_view::npos)
    name.remove_suffix(1);
  return std::string(name);
}

}  // namespace

bool natural_less(const std::filesystem::path& a, const std::filesystem::path& b) {
  const auto [x, y] = std::mismatch(a.begin(), a.end(), b.begin(), b.end());
  if (x == a.end() || y == b.end()) return x == a.end() && y != b.end();
  const int order = compare_names(x->string(), y->string());
  return order != 0 ? order < 0 : *x < *y;
}

std::vector<Animation> animations_of(const std::vector<std::string_view>& names) {
  std::vector<Animation> found;
  std::map<std::string, std::size_t> index;
  for (const std::string_view name : names) {
    const std::string animation = animation_of(name);
    if (animation.empty()) continue;
    const auto [at, fresh] = index.emplace(animation, found.size());
    if (fresh) found.push_back({animation, {}});
    found[at->second].frames.emplace_back(name);
  }
  std::erase_if(found, [](const Animation& a) { return a.frames.size() < 2; });
  return found;
}

}  // namespace atlas::app
