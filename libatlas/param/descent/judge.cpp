#include "libatlas/param/descent/judge.h"

#include <algorithm>

namespace atlas::param {
namespace {

void scale_to_surface_area(ParamResult& r) {
  const double scale = area_preserving_scale(r.distortion);
  if (!(scale > 0) || scale == 1) return;
  for (Vec2d& p : r.uvs) p = {p.x * scale, p.y * scale};
  r.distortion.uv_area *= scale * scale;
}

// Returns flipped triangles first, then those at crossings, then those beyond the bound.
std::vector<std::uint32_t> list_offenders(const LocalMesh& mesh, const Injectivity& check,
                                          std::span<const std::uint32_t> beyond) {
  std::vector<std::uint32_t> offenders = check.flipped;
  std::vector<bool> listed(mesh.triangles.size(), false);
  for (const std::uint32_t t : offenders) listed[t] = true;
  const auto add = [&](std::uint32_t t) {
    if (!listed[t]) offenders.push_back(t);
    listed[t] = true;
  };
  for (const BorderCrossing& c : check.crossings) {
    add(c.triangle_a);
    add(c.triangle_b);
  }
  for (const std::uint32_t t : beyond) add(t);
  return offenders;
}

}  // namespace

bool is_within(const Distortion& distortion, double bound) {
  return distortion.stretch_999 <= bound && distortion.stretch_l2 <= bound;  // false for NaN
}

std::vector<std::uint32_t> beyond_bound(std::span<const double> stretch, double bound) {
  std::vector<std::uint32_t> beyond;
  for (std::uint32_t t = 0; t < stretch.size(); ++t) {
    if (stretch[t] > bound) beyond.push_back(t);
  }
  std::stable_sort(beyond.begin(), beyond.end(),
                   [&](std::uint32_t a, std::uint32_t b) { return stretch[a] > stretch[b]; });
  return beyond;
}

void judge(const LocalMesh& mesh, const ParamOptions& options, ParamResult& r,
           const Distortion* known) {
  std::vector<double> stretch;
  if (known && is_within(*known, options.max_stretch)) {
    r.distortion = *known;
  } else {
    stretch.resize(mesh.triangles.size());
    r.distortion = measure_distortion(mesh, r.uvs, stretch);
  }
  scale_to_surface_area(r);
  const Injectivity check = check_injectivity(mesh, r.uvs);
  r.injective = check.injective;
  r.within_bound = is_within(r.distortion, options.max_stretch);
  r.crossings = check.crossings;
  std::vector<std::uint32_t> beyond;
  if (!r.within_bound) beyond = beyond_bound(stretch, options.max_stretch);
  r.offenders = list_offenders(mesh, check, beyond);
}

}  // namespace atlas::param
