#include "apps/atlas-pack/far_texcoord.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <fstream>
#include <optional>
#include <string>

#include "libatlas/files/file_extension.h"
#include "libatlas/scene/reader.h"

namespace atlas::app {
namespace {

bool too_far(const Vec2d& p) {
  return !(std::abs(p.x) < UvCharts::kFarthest && std::abs(p.y) < UvCharts::kFarthest);
}

// Returns the line and the number, both from 1, of the first `vt` with these coordinates.
std::string place_in_obj(const std::filesystem::path& path, const Vec2f& uv) {
  std::ifstream file(path);
  std::size_t line_number = 0, number = 0;
  for (std::string line; std::getline(file, line);) {
    ++line_number;
    float u = 0, v = 0;
    if (std::sscanf(line.c_str(), " vt %f %f", &u, &v) != 2) continue;
    ++number;
    if (u == uv.x && v == uv.y) return fmt::format("line {}: vt {}, ", line_number, number);
  }
  return {};
}

// The file is read once more, since the coordinates in memory are no longer those of the file.
std::optional<Vec2f> largest_texcoord(const PackCommand& command,
                                      const std::vector<std::uint32_t>& triangles,
                                      const Context& context) {
  ReadOptions read = command.read;
  read.load_textures = false;
  const Result<LoadedScene> loaded = read_scene(command.input, read, context);
  if (!loaded.ok()) return {};
  const Scene& scene = loaded->scene;
  const auto size = [](const Vec2f& uv) { return std::max(std::abs(uv.x), std::abs(uv.y)); };
  std::optional<Vec2f> largest;
  for (const std::uint32_t t : triangles) {
    for (std::size_t k = 3 * std::size_t{t}; k < 3 * std::size_t{t} + 3; ++k) {
      if (k >= scene.texcoord_indices.size()) return {};  // the file has changed since
      const Vec2f& uv = scene.texcoords[scene.texcoord_indices[k]];
      if (!largest || size(uv) > size(*largest)) largest = uv;
    }
  }
  return largest;
}

}  // namespace

Status check_corners(const PackCommand& command, const UvCharts& charts, const Context& context) {
  for (std::size_t c = 0; c < charts.corners.size(); ++c) {
    if (std::none_of(charts.corners[c].begin(), charts.corners[c].end(), too_far)) continue;
    std::string what = fmt::format("chart {} has a texture coordinate", c);
    if (const auto uv = largest_texcoord(command, charts.members[c], context)) {
      const std::string place =
          lower_extension(command.input) == ".obj" ? place_in_obj(command.input, *uv) : "";
      what = fmt::format("{}({}, {}) is a texture coordinate", place, uv->x, uv->y);
    }
    return {ErrorCode::bad_input,
            fmt::format("{}: {} so far from the others of its chart that no page holds it at "
                        "their size (mend it, or make new uvs with atlas-export --charts-only)",
                        command.input.string(), what)};
  }
  return {};
}

}  // namespace atlas::app
