// Internal: ColouredPoints, which divides points whose corners differ in colour.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <unordered_map>
#include <vector>

#include "libatlas/core/vec.h"

namespace atlas {

// Light and alpha of a vertex, a corner or a face.
struct VertexColour {
  Vec3f light{};
  float opacity = 1;

  bool operator==(const VertexColour&) const = default;
};

class ColouredPoints {
 public:
  explicit ColouredPoints(std::size_t points) : colours_(points), original_(points) {
    for (std::size_t i = 0; i < points; ++i) original_[i] = static_cast<std::uint32_t>(i);
  }

  // Returns the point that has the place of `point`, which must not be a copy, and this colour: the
  // point itself if it had none or the same, else a copy of it. Not a number equals itself here.
  std::uint32_t coloured(std::uint32_t point, const VertexColour& colour);

  // Points and copies behind them. Points that were not asked for have no colour.
  const std::vector<std::optional<VertexColour>>& colours() const { return colours_; }
  // The point of which each is a copy, or itself.
  const std::vector<std::uint32_t>& original() const { return original_; }

 private:
  struct Key {
    std::uint32_t words[5];  // the point, and the bits of its colour
    bool operator==(const Key&) const = default;
  };
  struct Hash {
    std::size_t operator()(const Key& key) const;
  };
  static Key key_of(std::uint32_t point, const VertexColour& colour);

  std::vector<std::optional<VertexColour>> colours_;
  std::vector<std::uint32_t> original_;
  std::unordered_map<Key, std::uint32_t, Hash> copies_;
};

}  // namespace atlas
