// Internal: what of a scene an export that keeps it has to leave out.
#pragma once

#include <fmt/format.h>

#include <cstddef>
#include <map>
#include <string>
#include <vector>

namespace atlas {

class Losses {
 public:
  // `what` in the plural, for example "animations".
  void add(const std::string& what, std::size_t times = 1) {
    if (times > 0) counts_[what] += times;
  }

  // "2 x animations", one string a kind, by name (WorldFile::not_kept).
  std::vector<std::string> lines() const {
    std::vector<std::string> result;
    for (const auto& [what, count] : counts_) result.push_back(fmt::format("{} x {}", count, what));
    return result;
  }

 private:
  std::map<std::string, std::size_t> counts_;
};

}  // namespace atlas
