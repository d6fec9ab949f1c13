#include "tests/unwrap/polygon_shapes.h"

#include <map>
#include <utility>

#include "libatlas/core/half_edge.h"

namespace atlas::test {

void PolygonShape::add(const std::vector<std::uint32_t>& corners) {
  indices.insert(indices.end(), corners.begin(), corners.end());
  sizes.push_back(std::uint32_t(corners.size()));
}

StridedMesh PolygonShape::view() const {
  return {.positions = {positions.data(), positions.size(), 0},
          .indices = {indices.data(), indices.size(), 4},
          .polygon_sizes = sizes};
}

PolygonShape quads_of(const Shape& shape) {
  PolygonShape out;
  out.positions = shape.positions;
  const std::vector<std::uint32_t>& v = shape.indices;
  for (std::size_t i = 0; i < v.size(); i += 3) {
    const bool quad = i + 3 < v.size() && v[i + 3] == v[i] && v[i + 4] == v[i + 2];
    if (quad) {
      out.add({v[i], v[i + 1], v[i + 2], v[i + 5]});
      i += 3;
    } else {
      out.add({v[i], v[i + 1], v[i + 2]});
    }
  }
  return out;
}

PolygonShape dual_of(const Shape& shape) {
  PolygonShape out;
  std::map<std::pair<std::uint32_t, std::uint32_t>, std::uint32_t> half_edge;
  std::vector<std::uint32_t> leaving(shape.positions.size());
  for (std::uint32_t h = 0; h < shape.indices.size(); ++h) {
    half_edge[{shape.indices[h], shape.indices[next_half_edge(h)]}] = h;
    leaving[shape.indices[h]] = h;
    if (h % 3 != 0) continue;
    Vec3f sum{};
    for (std::uint32_t c = h; c < h + 3; ++c) {
      const Vec3f p = shape.positions[shape.indices[c]];
      sum = {sum.x + p.x / 3, sum.y + p.y / 3, sum.z + p.z / 3};
    }
    out.positions.push_back(sum);
  }
  for (const std::uint32_t start : leaving) {
    std::vector<std::uint32_t> around;
    std::uint32_t h = start;
    do {
      around.push_back(h / 3);
      const std::uint32_t back = previous_half_edge(h);
      h = half_edge.at({shape.indices[h], shape.indices[back]});
    } while (h != start);
    out.add(around);
  }
  return out;
}

PolygonShape comb(std::uint32_t teeth) {
  PolygonShape out;
  std::vector<std::uint32_t> corners;
  const auto corner = [&](float x, float y) {
    corners.push_back(std::uint32_t(out.positions.size()));
    out.positions.push_back({x, y, 0});
  };
  corner(0, 0);
  corner(float(2 * teeth - 1), 0);
  for (std::uint32_t k = teeth; k-- > 0;) {
    corner(float(2 * k + 1), 3);
    corner(float(2 * k), 3);
    if (k == 0) break;
    corner(float(2 * k), 1);
    corner(float(2 * k - 1), 1);
  }
  out.add(corners);
  return out;
}

PolygonShape bricks(std::uint32_t rows, std::uint32_t columns) {
  PolygonShape out;
  std::map<std::pair<std::uint32_t, std::uint32_t>, std::uint32_t> number;
  // Around a tube, in half bricks; joints of a row lie in the middle of the bricks of the next one.
  const std::uint32_t around = 2 * columns;
  const auto corner = [&](std::uint32_t half, std::uint32_t row) {
    half %= around;
    const auto [known, added] =
        number.try_emplace({half, row}, std::uint32_t(out.positions.size()));
    if (added) {
      const std::uint32_t side = half / (around / 4), along = half % (around / 4);
      const float s = float(along), w = float(around / 4);
      const std::pair<float, float> at[] = {{s, 0.f}, {w, s}, {w - s, w}, {0.f, w - s}};
      out.positions.push_back({at[side].first, at[side].second, float(row)});
    }
    return known->second;
  };
  for (std::uint32_t row = 0; row < rows; ++row) {
    for (std::uint32_t k = 0; k < columns; ++k) {
      const std::uint32_t left = 2 * k + row % 2;
      std::vector<std::uint32_t> brick{corner(left, row)};
      if (row > 0) brick.push_back(corner(left + 1, row));
      brick.push_back(corner(left + 2, row));
      brick.push_back(corner(left + 2, row + 1));
      if (row + 1 < rows) brick.push_back(corner(left + 1, row + 1));
      brick.push_back(corner(left, row + 1));
      out.add(brick);
    }
  }
  return out;
}

PolygonShape frame() {
  PolygonShape out;
  for (const float r : {2.0f, 1.0f})
    for (const auto& [x, y] : {std::pair(-r, -r), {r, -r}, {r, r}, {-r, r}})
      out.positions.push_back({x, y, 0});
  out.add({0, 1, 2, 3, 0, 4, 7, 6, 5, 4});
  return out;
}

}  // namespace atlas::test
