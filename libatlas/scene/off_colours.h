// Internal: the colours of an OFF file's vertices and faces.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

#include "libatlas/scene/building/scene_builder.h"

namespace atlas {

// Takes the colours of all vertices, or of all faces, before any is scaled. If all are whole
// numbers and the largest is above 1 and at most 255, they are divided by 255, as most programs
// write them. Otherwise they are used unchanged, as Geomview and simulations write them. So is
// alpha, by itself.
class OffColourScale {
 public:
  // `rgba` are 3 or 4 numbers, `whole` says whether the first three are written as whole numbers.
  VertexColour take(std::span<const double> rgba, bool whole) {
    whole_ &= whole;
    for (int c = 0; c < 3; ++c) largest_ = std::max(largest_, rgba[c]);
    if (rgba.size() > 3) largest_alpha_ = std::max(largest_alpha_, rgba[3]);
    return {{float(rgba[0]), float(rgba[1]), float(rgba[2])},
            rgba.size() > 3 ? float(rgba[3]) : kNoAlpha};
  }

  // Returns what a colour that take() has returned stands for.
  VertexColour scaled(const VertexColour& taken) const {
    const float by = are_bytes(largest_) ? 255 : 1, alpha_by = are_bytes(largest_alpha_) ? 255 : 1;
    const Vec3f& c = taken.light;
    return {{c.x / by, c.y / by, c.z / by},
            taken.opacity == kNoAlpha ? 1 : taken.opacity / alpha_by};
  }

 private:
  static constexpr float kNoAlpha = -1;  // of colours of three numbers

  bool are_bytes(double largest) const { return whole_ && largest > 1 && largest <= 255; }

  bool whole_ = true;
  double largest_ = 0, largest_alpha_ = 0;
};

// Collects the colours of vertices as illumination, and those of faces, which are used if vertices
// have none.
class OffColours {
 public:
  explicit OffColours(SceneBuilder& builder) : builder_(builder) {}

  // `rgba` are 3 or 4 numbers. So are they below.
  void add_vertex(std::span<const double> rgba, bool whole) {
    const VertexColour taken = vertices_.take(rgba, whole);
    builder_.illumination.push_back(taken.light);
    if (builder_.wants_rest) builder_.vertex_opacity.push_back(taken.opacity);
  }
  void finish_vertices() {
    for (std::size_t i = 0; i < builder_.illumination.size(); ++i) {
      const bool rest = builder_.wants_rest;
      const VertexColour scaled =
          vertices_.scaled({builder_.illumination[i], rest ? builder_.vertex_opacity[i] : 1});
      builder_.illumination[i] = scaled.light;
      if (rest) builder_.vertex_opacity[i] = scaled.opacity;
    }
  }

  // Takes the colour of the next face.
  void next_face(std::span<const double> rgba, bool whole) {
    if (builder_.illumination.empty()) {
      builder_.face_colour = faces_.take(rgba, whole);
    } else {
      ++unused_;
    }
  }
  void finish_faces() {
    for (std::optional<VertexColour>& colour : builder_.triangle_colours)
      if (colour) colour = faces_.scaled(*colour);
    if (unused_ > 0)
      builder_.defects.add(
          DefectKind::element_ignored,
          [&] { return builder_.file + ": colours of faces, as its vertices have some"; }, unused_);
  }

 private:
  SceneBuilder& builder_;
  OffColourScale vertices_, faces_;
  std::uint64_t unused_ = 0;
};

}  // namespace atlas
