// A mesh whose charts are chosen by hand or at random, before any is flattened.
#pragma once

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <map>
#include <random>
#include <utility>
#include <vector>

#include "libatlas/charts/seams/straighten.h"
#include "libatlas/core/glm_bridge.h"
#include "tests/charts/chart_checks.h"

namespace atlas::test {

struct RaggedCharts {
  Topology topology;
  Partition partition;
  Frames frames;

  explicit RaggedCharts(const Shape& shape) {
    const Mesh mesh(shape);
    Result<Topology> built = build_topology(mesh.view(), {}, {});
    EXPECT_TRUE(built.ok());
    topology = std::move(*built);
    const std::size_t n = topology.triangle_count();
    partition.chart.assign(n, kNoIndex);
    partition.seams.assign(n, 0);
    partition.local.assign(n, 0);
    frames.resize(n);
    for (std::uint32_t t = 0; t < n; ++t) frames.put(t, frame_of(t));
  }

  // Returns two perpendicular directions in the plane of triangle t.
  std::array<Vec3f, 2> frame_of(std::uint32_t t) const {
    const glm::dvec3 n = to_dvec(topology.normals[t]);
    const glm::dvec3 u = glm::normalize(
        glm::cross(n, std::abs(n.x) < 0.6 ? glm::dvec3(1, 0, 0) : glm::dvec3(0, 1, 0)));
    return {from_glm(glm::vec3(u)), from_glm(glm::vec3(glm::cross(n, u)))};
  }

  // Grows `count` charts from random triangles at random speeds. They are ragged, but each is
  // connected.
  void grow(std::uint32_t count, std::uint64_t seed) {
    std::mt19937_64 random(seed);
    std::vector<std::uint32_t> front;
    for (std::uint32_t k = 0; k < count; ++k) {
      const auto t = std::uint32_t(random() % topology.triangle_count());
      if (partition.chart[t] != kNoIndex) continue;
      partition.chart[t] = k;
      front.push_back(t);
    }
    while (!front.empty()) {
      const std::size_t i = random() % front.size();
      const std::uint32_t t = front[i];
      front[i] = front.back();
      front.pop_back();
      for (std::uint32_t h = 3 * t; h < 3 * t + 3; ++h) {
        const std::uint32_t o = topology.opposite[h];
        if (o == kNoIndex || partition.chart[o / 3] != kNoIndex) continue;
        partition.chart[o / 3] = partition.chart[t];
        front.push_back(o / 3);
      }
    }
  }

  // Cuts about one in `rate` of the edges within charts.
  void cut_at_random(unsigned rate, std::uint64_t seed) {
    std::mt19937_64 random(seed);
    for (std::uint32_t h = 0; h < topology.opposite.size(); ++h) {
      const std::uint32_t o = topology.opposite[h];
      if (o == kNoIndex || partition.chart[h / 3] != partition.chart[o / 3]) continue;
      if (h < o || random() % rate != 0) continue;
      partition.cut(h);
      partition.cut(o);
    }
  }

  // Returns the number of sides of seams whose other side is no seam, or in another chart.
  std::size_t seam_faults() const {
    std::size_t faults = 0;
    for (std::uint32_t h = 0; h < topology.opposite.size(); ++h) {
      if (!partition.seam(h)) continue;
      const std::uint32_t o = topology.opposite[h];
      faults +=
          o == kNoIndex || !partition.seam(o) || partition.chart[h / 3] != partition.chart[o / 3];
    }
    return faults;
  }

  double border_length() const {
    double length = 0;
    for (std::uint32_t h = 0; h < topology.opposite.size(); ++h) {
      const std::uint32_t o = topology.opposite[h];
      if (o == kNoIndex || o < h || partition.chart[h / 3] == partition.chart[o / 3]) continue;
      length += edge_length(topology, h);
    }
    return length / topology.scale;
  }

  // Returns the number of pieces and the Euler characteristic of each chart.
  std::map<std::uint32_t, std::pair<std::uint32_t, int>> topologies() {
    std::map<std::uint32_t, std::vector<std::uint32_t>> lists;
    for (std::uint32_t t = 0; t < partition.chart.size(); ++t) {
      lists[partition.chart[t]].push_back(t);
    }
    std::map<std::uint32_t, std::pair<std::uint32_t, int>> result;
    for (const auto& [k, list] : lists) {
      LocalChart chart;
      chart.build(topology, partition, list);
      result[k] = {chart.component_count, chart.euler()};
    }
    return result;
  }

  void straighten(std::uint8_t rings, double crease_degrees = 40) {
    const std::vector<std::uint8_t> of_chart(64, rings);
    straighten_borders(topology, {{crease_degrees, {}}, of_chart}, partition, {});
  }
};

}  // namespace atlas::test
