#include "libatlas/scene/defects.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

namespace atlas {
namespace {

struct Names {
  std::string_view name, description;
};

constexpr Names kNames[] = {
    {"index_out_of_range", "triangles left out: a corner names a vertex that does not exist"},
    {"too_few_corners", "faces left out: fewer than three corners"},
    {"bad_position_used", "triangles left out: a corner's position is not finite"},
    {"position_not_finite", "vertices whose position is not a finite number"},
    {"position_rounded",
     "vertices that rounding to single precision moves by more than a thousandth of the typical "
     "edge, since the scene lies in parts far from each other (remove stray parts, or export the "
     "parts one by one)"},
    {"triangle_closed",
     "triangles that rounding to single precision closes: corners that differ become one"},
    {"polygon_repeated",
     "faces left out: they name the same vertices again and again, as no outline does"},
    {"polygon_too_large",
     "concave polygons cut as fans, since they are very large or cross themselves again and again"},
    {"texcoord_out_of_range",
     "triangles without texture: a corner names a texture coordinate that does not exist"},
    {"texcoord_partial", "triangles without texture: only some corners have texture coordinates"},
    {"texcoord_not_finite", "texture coordinates that are not finite, replaced by 0"},
    {"normal_out_of_range", "faces without normals: a corner names a normal that does not exist"},
    {"normal_partial", "faces without normals: only some corners have one"},
    {"normal_unusable", "normals without length or not finite, taken from their triangles"},
    {"illumination_not_finite",
     "illumination values that are not finite or beyond 1e36, replaced by 0"},
    {"illumination_negative", "negative illumination values, kept"},
    {"illumination_missing", "vertices without illumination where others have it, taken as 0"},
    {"illumination_elsewhere",
     "vertices that lie elsewhere in the file of the illumination, which is used in its order "
     "(give "
     "both files the same vertices in one order)"},
    {"lightmap_unusable",
     "lightmaps that cannot be used, the scene is taken as one without (export it again, and keep "
     "the images beside it)"},
    {"lightmap_clipped",
     "lightmaps whose linear images cannot be used, those of 8 bits are, which clip bright light"},
    {"lightmap_absent",
     "primitives or faces without a place on the lightmap, their light is that of their vertices "
     "or 0"},
    {"material_file_missing", "material files not found, their materials are white"},
    {"material_unknown", "materials used but not defined, taken as white"},
    {"reflectance_unknown",
     "colours of materials that are a spectrum, xyz or a shader's, taken as white (write Kd r g b, "
     "or glTF's baseColorFactor)"},
    {"reflectance_beyond_one",
     "colours of materials beyond 0 to 1, used as they are (write shares: 0.8, not 204)"},
    {"texture_missing", "textures not found, plain diffuse colour used"},
    {"texture_unreadable", "textures that cannot be decoded, plain diffuse colour used"},
    {"texture_clipped",
     "textures of linear values with some beyond 0 to 1, clipped (no surface reflects more light "
     "than falls on it)"},
    {"texture_option_ignored", "texture options ignored"},
    {"node_hidden", "hidden nodes left out"},
    {"node_shared",
     "nodes of several parents, which glTF does not allow, shown at each; animations move one of "
     "them (give each parent a node of its own)"},
    {"skin_repeated",
     "nodes and instances of skinned meshes that lie upon another one, since joints place them "
     "wherever their node is (give each a skin with joints of its own)"},
    {"text_not_utf8", "bytes of names that are not UTF-8, replaced by '?'"},
    {"element_ignored", "elements ignored (not a surface, or an unknown keyword)"},
};

const Names& names(DefectKind kind) {
  return kNames[static_cast<std::size_t>(kind)];
}

}  // namespace

std::string_view describe(DefectKind kind) {
  return names(kind).description;
}
std::string_view name_of(DefectKind kind) {
  return names(kind).name;
}

std::uint64_t DefectReport::count(DefectKind kind) const {
  for (const Defect& defect : defects) {
    if (defect.kind == kind) return defect.count;
  }
  return 0;
}

Defect& DefectReport::find_or_insert(DefectKind kind) {
  const auto at = std::lower_bound(defects.begin(), defects.end(), kind,
                                   [](const Defect& d, DefectKind k) { return d.kind < k; });
  if (at != defects.end() && at->kind == kind) return *at;
  return *defects.insert(at, Defect{kind, 0, {}});
}

std::vector<std::string> DefectReport::lines() const {
  std::vector<std::string> result;
  for (const Defect& defect : defects) {
    result.push_back(fmt::format("{} x {} (first at {})", defect.count, describe(defect.kind),
                                 fmt::join(defect.first_places, ", ")));
  }
  return result;
}

}  // namespace atlas
