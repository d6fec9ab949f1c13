#include "libatlas/param/solvers/stiffness.h"

#include <algorithm>

#include "libatlas/core/no_index.h"
#include "libatlas/core/wide_vectors.h"

namespace atlas::param {

namespace {

constexpr double relative_floor = 1e-9;

// The shear that is kept decreases by 1 / (1 + much_shear |B|²), where B is the shearing part of
// the map: with singular values 1.2 and 1 / 1.2 by a fourth, with 2 and 1/2 by six sevenths.
constexpr double much_shear = 10;

Element element_of(const RestShape& s, double min_altitude) {
  return {s.v, 1, s.length, s.foot,
          std::max({s.altitude, relative_floor * s.length, min_altitude})};
}

}  // namespace

void Elements::build(const LocalMesh& mesh, double min_altitude) {
  triangles_ = mesh.triangles;
  const std::size_t count = triangles_.size();
  whole_.resize(count < large ? count : 0);
  shapes_.resize(count < large ? 0 : count);
  base_.resize(shapes_.size());
  weights_.clear();
  // The floor depends on the whole mesh's size, since several zero-length triangles must not make
  // the matrix overflow.
  double longest = 0;
  for (std::size_t t = 0; t < whole_.size(); ++t) {
    whole_[t] = element_of(rest_shape(mesh, t), min_altitude);
    longest = std::max(longest, whole_[t].length);
  }
  for (std::size_t t = 0; t < shapes_.size(); ++t) {
    const RestShape s = rest_shape(mesh, t);
    const Element e = element_of(s, min_altitude);
    shapes_[t] = {e.length, e.foot, e.altitude};
    base_[t] = s.base;
    longest = std::max(longest, s.length);
  }
  if (!(longest > 0)) longest = 1;  // only points: any size will do
  const double speck = std::max(min_altitude, relative_floor * longest);
  const auto widen = [&](auto& e) {
    if (e.length >= speck) return;
    e.length = speck;
    e.foot = std::min(e.foot, speck);
    e.altitude = std::max(e.altitude, min_altitude > 0 ? speck : relative_floor * speck);
  };
  for (Element& e : whole_) widen(e);
  for (Shape& s : shapes_) widen(s);
}

void Elements::give_back() {
  triangles_ = {};
  param::give_back(whole_);
  param::give_back(shapes_);
  param::give_back(base_);
  param::give_back(weights_);
}

void Elements::set_weight(std::size_t t, float weight) {
  if (!whole_.empty()) {
    whole_[t].weight = weight;
    return;
  }
  if (weights_.empty()) weights_.assign(size(), 1);
  weights_[t] = weight;
}

void Elements::reset_weights() {
  for (Element& e : whole_) e.weight = 1;
  weights_.clear();
}

void CornerLists::build(const Elements& elements, std::size_t vertices) {
  first.assign(vertices + 1, 0);
  elements.visit([&](const auto& each) {
    for (std::size_t t = 0; t < elements.size(); ++t) {
      const Element& e = each[t];
      for (const std::uint32_t v : e.v) ++first[v + 1];
    }
  });
  for (std::size_t v = 1; v < first.size(); ++v) first[v] += first[v - 1];
  corner.resize(3 * elements.size());
  elements.visit([&](const auto& each) {
    for (std::uint32_t t = 0; t < elements.size(); ++t) {
      const Element& e = each[t];
      for (std::uint32_t k = 0; k < 3; ++k) corner[first[e.v[k]]++] = 3 * t + k;
    }
  });
  for (std::size_t v = first.size() - 1; v > 0; --v) first[v] = first[v - 1];
  first[0] = 0;
}

namespace {

template <class Each>
void fill_stiffness(const Each& each, std::size_t count, const CornerLists& corners,
                    SymmetricMatrix& out) {
  const std::size_t n = corners.first.size() - 1;
  out.diagonal.resize(n);
  out.first.resize(n + 1);
  // Two entries per edge. A disc has one edge less than vertices and triangles together.
  const auto reserve = [&](std::size_t entries) {
    if (entries <= out.column.size()) return;
    out.column.resize(entries);
    out.value.resize(entries);
  };
  out.column.clear();
  out.value.clear();
  reserve(2 * (n + count));
  std::vector<std::uint32_t>& place = out.scratch;  // of a column within the current row
  place.assign(n, kNoIndex);
  std::uint32_t end = 0;
  for (std::uint32_t row = 0; row < n; ++row) {
    const std::uint32_t begin = end;
    double diagonal = 0;
    out.first[row] = begin;
    const std::size_t most = end + 2 * std::size_t{corners.first[row + 1] - corners.first[row]};
    if (most > out.column.size()) reserve(most + most / 8);
    for (std::uint32_t i = corners.first[row]; i < corners.first[row + 1]; ++i) {
      const Element& e = each[corners.corner[i] / 3];
      const std::uint32_t k = corners.corner[i] % 3;
      const ElementStiffness s = e.stiffness();
      diagonal += s.own[k];
      for (const std::uint32_t other : {(k + 1) % 3, (k + 2) % 3}) {
        const std::uint32_t column = e.v[other];
        std::uint32_t& at = place[column];
        const double v = s.across[3 - k - other];
        if (at == kNoIndex || at < begin) {
          at = end++;
          out.column[at] = column;
          out.value[at] = v;
        } else {
          out.value[at] += v;
        }
      }
    }
    out.diagonal[row] = diagonal;
  }
  out.first[n] = end;
  out.column.resize(end);
  out.value.resize(end);
}

}  // namespace

void build_stiffness(const Elements& elements, const CornerLists& corners, SymmetricMatrix& out) {
  elements.visit([&](const auto& each) { fill_stiffness(each, elements.size(), corners, out); });
}

namespace {

// Adds the loads of an element with the given map (by columns) on its vertices.
ATLAS_INLINE void add_load(const Element& e, const Pair& x, const Pair& y,
                           std::span<glm::dvec2> out) {
  const Pair along = x * double(e.weight), across = y * double(e.weight);
  const auto g = e.area_gradients();
  for (int k = 0; k < 3; ++k) {
    Pair& load = reinterpret_cast<Pair&>(out[e.v[k]]);
    load += along * g[k].x + across * g[k].y;
  }
}

// Uvs are where callers store them, which need not be aligned to 16 bytes.
Pair pair_at(std::span<const Vec2d> uvs, std::uint32_t v) {
  using PairInPlace = double __attribute__((vector_size(16), aligned(8), may_alias));
  return *reinterpret_cast<const PairInPlace*>(&uvs[v]);
}

}  // namespace

double update_rotations(const Elements& elements, const LocalStep& step, Rotations& rotations,
                        std::span<glm::dvec2> load) {
  const std::span<const Vec2d> uvs = step.uvs;
  const double kept_shear = 1 - step.shear_weight;
  double fall = 0;
  std::fill(load.begin(), load.end(), glm::dvec2(0));
  elements.visit([&](const auto& each) {
    for (std::size_t t = 0; t < elements.size(); ++t) {
      const Element& e = each[t];
      const Pair u0 = pair_at(uvs, e.v[0]);
      // The Jacobian's columns, times twice the area: its nearest rotation needs no division.
      const Pair base = pair_at(uvs, e.v[1]) - u0, x = e.altitude * base;
      const Pair y = e.length * (pair_at(uvs, e.v[2]) - u0) - e.foot * base;
      const double c = x[0] + y[1], s = x[1] - y[0], norm = std::sqrt(c * c + s * s);
      const Pair r = norm > 0 ? Pair{c, s} * (1 / norm) : Pair{1, 0};
      const Pair change = r - Pair{rotations[t].x, rotations[t].y}, squared = change * change;
      fall += e.weight * norm * (squared[0] + squared[1]);
      rotations[t] = {r[0], r[1]};
      Pair shear = Pair{x[0] - y[1], x[1] + y[0]} * (0.5 / (e.length * e.altitude));
      shear *= kept_shear / (1 + much_shear * (shear[0] * shear[0] + shear[1] * shear[1]));
      add_load(e, r + shear, Pair{shear[1] - r[1], r[0] - shear[0]}, load);
    }
  });
  return 0.5 * fall;
}

void rotation_load(const Elements& elements, const Rotations& rotations,
                   std::span<glm::dvec2> out) {
  std::fill(out.begin(), out.end(), glm::dvec2(0));
  elements.visit([&](const auto& each) {
    for (std::size_t t = 0; t < elements.size(); ++t) {
      const Pair r{rotations[t].x, rotations[t].y};
      add_load(each[t], r, Pair{-r[1], r[0]}, out);
    }
  });
}

namespace {

// Adds the energy of one element. Returns the determinant of its map.
double add_energy(const Element& e, std::span<const Vec2d> uvs, double& energy) {
  const Jacobian j = e.jacobian(to_glm(uvs[e.v[0]]), to_glm(uvs[e.v[1]]), to_glm(uvs[e.v[2]]));
  const glm::dvec2 r = nearest_rotation(j);
  const glm::dvec2 dx = j.x - r, dy = j.y - glm::dvec2(-r.y, r.x);
  energy += e.area() * (glm::dot(dx, dx) + glm::dot(dy, dy));
  return j.det();
}

}  // namespace

MapEnergy measure_energy(const Elements& elements, std::span<const Vec2d> uvs) {
  MapEnergy out;
  for (std::size_t t = 0; t < elements.size(); ++t) {
    out.flips += !(add_energy(elements[t], uvs, out.energy) > 0);
  }
  return out;
}

bool energy_exceeds(double limit, const Elements& elements, std::span<const Vec2d> uvs) {
  double energy = 0;
  for (std::size_t t = 0; t < elements.size(); ++t) {
    add_energy(elements[t], uvs, energy);
    if (energy > limit) return true;
  }
  return false;
}

}  // namespace atlas::param
