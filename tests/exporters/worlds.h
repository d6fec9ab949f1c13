// Makes worlds to write.
#pragma once

#include <fmt/format.h>

#include <cmath>
#include <random>

#include "libatlas/exporters/world.h"

namespace atlas::test {

// Returns a wavy sheet of n x n vertices in `pages` pages, each with uvs of its own, so that page
// borders are seams: one position, two uvs.
inline World wavy_world(int n, int pages) {
  World world;
  world.title = "a \"wavy\" \\ sheet";
  world.info = {"first line", "second: caf\xc3\xa9"};
  std::mt19937 random(5);
  std::uniform_real_distribution<float> jitter(-0.3f, 0.3f);
  for (int j = 0; j < n; ++j) {
    for (int i = 0; i < n; ++i) {
      world.positions.push_back({float(i) + jitter(random), float(j) * 1e-3f,
                                 1e4f * std::sin(float(i * j)) + jitter(random)});
    }
  }
  world.positions[0] = {-0.f, 0.f, 1e-6f};  // close to the least that readers do not round to 0
  const int rows = n - 1;
  for (int p = 0; p < pages; ++p) {
    Page page;
    page.image = fmt::format("sheet_page{}.png", p);
    const int first = rows * p / pages, last = rows * (p + 1) / pages;
    const auto base = std::uint32_t(world.uvs.size());
    for (int j = first; j <= last; ++j) {
      for (int i = 0; i < n; ++i) {
        world.uvs.push_back({float(i) / float(n - 1), float(j - first) / float(last - first)});
      }
    }
    for (int j = first; j < last; ++j) {
      for (int i = 0; i + 1 < n; ++i) {
        const auto v = std::uint32_t(j * n + i), t = base + std::uint32_t((j - first) * n + i);
        const auto row = std::uint32_t(n);
        for (const std::uint32_t k : {0u, 1u, row + 1, 0u, row + 1, row}) {
          page.indices.push_back(v + k);
          page.uv_indices.push_back(t + k);
        }
      }
    }
    world.pages.push_back(std::move(page));
  }
  world.viewpoint.direction = {1, 0, 0};
  return world;
}

}  // namespace atlas::test
