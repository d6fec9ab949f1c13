// Reports what is wrong with a file that can still be used: counted by kind, with the first places.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace atlas {

// Readers distinguish two cases. *Malformed*: the file breaks the grammar of its format (a line of
// a known keyword that cannot be parsed, a header that contradicts itself, data that ends early) or
// holds no usable triangle; reading fails with a Status that names file and line. *Defective*:
// every element parses, but some cannot be used; they are left out or replaced as said below,
// and each is counted here.
enum class DefectKind : std::uint8_t {
  index_out_of_range,       // triangle left out: a corner names a vertex that does not exist
  too_few_corners,          // face left out: fewer than three corners
  bad_position_used,        // triangle left out: a corner's position is not a finite float
  position_not_finite,      // vertex with a NaN, infinite or beyond-float coordinate
  position_rounded,         // vertex that rounding to floats moves by over 1e-3 of the typical edge
  triangle_closed,          // triangle kept: corners that differ in double become equal as floats
  polygon_repeated,         // face left out: it names its vertices more often than outlines can
  polygon_too_large,        // concave polygon beyond the limits of ear clipping: cut as a fan
  texcoord_out_of_range,    // triangle kept without texture coordinates: no such coordinate
  texcoord_partial,         // triangle kept without texture coordinates: some corners lack one
  texcoord_not_finite,      // texture coordinate replaced by (0, 0)
  normal_out_of_range,      // triangle kept without normals: no such normal
  normal_partial,           // triangle kept without normals: some corners lack one
  normal_unusable,          // normal of length 0 or not finite: replaced by that of its triangles
  illumination_not_finite,  // not finite or beyond kMostLight (scene.h): value replaced by 0
  illumination_negative,    // value kept as it is
  illumination_missing,     // vertex without a value where others have one: 0 is used
  illumination_elsewhere,   // vertex lies elsewhere in the illumination's file: value used
  lightmap_unusable,        // lightmap whose data or images cannot be used: it is left out
  lightmap_clipped,         // linear image of a lightmap not usable: those of 8 bits are used
  lightmap_absent,        // primitive or face that is not on the lightmap: its vertices' light or 0
  material_file_missing,  // material library not found: its materials are white
  material_unknown,       // material not defined: white is used
  reflectance_unknown,    // colour not given as RGB: white, or the material's former colour
  reflectance_beyond_one,  // a component is below 0 or above 1: value kept as it is
  texture_missing,         // image not found: the material's plain diffuse colour is used
  texture_unreadable,      // image that cannot be decoded: likewise
  texture_clipped,         // image of linear values with some beyond 0 to 1: these are clipped
  texture_option_ignored,  // a texture option that has no counterpart here
  node_hidden,             // node that its file hides: left out
  node_shared,             // glTF node of several parents, which glTF forbids: shown at each
  skin_repeated,           // node or instance whose joints put its mesh where another one is: kept
  text_not_utf8,           // byte of a glTF file's JSON that is not UTF-8: replaced by '?'
  element_ignored,         // lines, points, curves, unknown keywords: nothing to bake
};

// One line of text for people: what the kind means and what was done about it.
std::string_view describe(DefectKind kind);
// The enumerator's name, for reports.
std::string_view name_of(DefectKind kind);

struct Defect {
  DefectKind kind{};
  std::uint64_t count = 0;
  std::vector<std::string> first_places = {};  // "file:line" or "file: face 12", at most 5
};

struct DefectReport {
  std::vector<Defect> defects = {};      // one per kind met, in the order of DefectKind
  std::uint64_t triangles_left_out = 0;  // elements that would have been triangles or polygons

  static constexpr std::size_t kMaxPlaces = 5;

  bool empty() const { return defects.empty(); }
  std::uint64_t count(DefectKind kind) const;

  // Counts `times` more. Calls `place` only while places are still collected.
  template <class Place>
  void add(DefectKind kind, const Place& place, std::uint64_t times = 1) {
    Defect& defect = find_or_insert(kind);
    defect.count += times;
    if (defect.first_places.size() < kMaxPlaces) defect.first_places.push_back(place());
  }

  // Returns "12 x description (first at a, b, ...)", one string for each kind.
  std::vector<std::string> lines() const;

 private:
  Defect& find_or_insert(DefectKind kind);
};

}  // namespace atlas
