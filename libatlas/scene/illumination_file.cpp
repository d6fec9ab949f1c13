// Reads illumination from a second file.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>

#include "libatlas/core/bounds.h"
#include "libatlas/core/glm_bridge.h"
#include "libatlas/scene/building/formats.h"
#include "libatlas/scene/files/file_bytes.h"
#include "libatlas/scene/files/text_scanner.h"

namespace atlas {
namespace fs = std::filesystem;
namespace {

// Reads one `r g b`, or one grey value, per line; skips blank lines and # comments.
Result<std::vector<Vec3f>> read_text(const fs::path& path) {
  auto bytes = read_text_bytes(path);
  if (!bytes.ok()) return bytes.status();
  if (std::find(bytes->begin(), bytes->end(), '\0') != bytes->end()) {
    return Status(ErrorCode::bad_input,
                  fmt::format("{}: is no text with one `r g b` a line (give that, or the same "
                              "vertices as .obj, .ply, .off, .gltf or .glb)",
                              path.string()));
  }
  TextScanner scan(bytes->begin(), bytes->end());
  std::vector<Vec3f> values;
  for (; !scan.at_end(); scan.next_line()) {
    if (scan.at_line_end()) continue;
    const std::uint32_t line = scan.line() + 1;
    double n[3];
    int count = 0;
    while (count < 3 && !scan.at_line_end() && scan.number(n[count])) ++count;
    if ((count != 1 && count != 3) || !scan.at_line_end()) {
      return Status(
          ErrorCode::bad_input,
          fmt::format("{}:{}: not an illumination value (write `r g b` with blanks between, or "
                      "one number, for each vertex)",
                      path.string(), line));
    }
    if (count == 1) n[1] = n[2] = n[0];
    values.push_back({float(n[0]), float(n[1]), float(n[2])});
  }
  return values;
}

bool of_illumination(const Defect& defect) {
  return defect.kind == DefectKind::illumination_not_finite ||
         defect.kind == DefectKind::illumination_negative ||
         defect.kind == DefectKind::illumination_missing;
}

// Returns the file's illumination. If the file is a mesh, fills `other` with it.
Result<std::vector<Vec3f>> read_values(const fs::path& path, const Context& context,
                                       SceneBuilder& other) {
  const Status status = read_by_extension(path, other, context);
  if (status.code() == ErrorCode::unsupported && !known_extension(path)) return read_text(path);
  if (!status.ok()) return status;
  if (other.illumination.empty()) {
    const bool faces = !other.triangle_colours.empty();
    return Status(
        ErrorCode::bad_input,
        fmt::format("{}: its {} (name the file that holds the simulation's result)", path.string(),
                    faces ? "colours are those of faces, not of vertices"
                          : "vertices carry no illumination"));
  }
  return std::move(other.illumination);
}

Bounds<glm::dvec3> box_of(const std::vector<Vec3d>& points) {
  Bounds<glm::dvec3> box;
  for (const Vec3d& p : points)
    if (usable_position(p)) box.add(to_glm(p));
  return box;
}

double distance(const glm::dvec3& a, const glm::dvec3& b) {
  return std::hypot(a.x - b.x, a.y - b.y, a.z - b.z);
}

// Reports vertices that lie elsewhere in the other file, since illumination in another order of
// vertices would land on the wrong ones. Positions are only compared if both files have the same
// bounding box and number of vertices: a file in another unit, or without positions, tells nothing.
void check_order(const SceneBuilder& other, SceneBuilder& builder) {
  constexpr double kSameBox = 1e-3, kSamePlace = 1e-2;  // relative to the diagonal
  if (other.positions.size() != builder.positions.size()) return;
  const auto own = box_of(builder.positions), theirs = box_of(other.positions);
  const double diagonal = distance(own.low, own.high);
  if (!(distance(own.low, theirs.low) <= kSameBox * diagonal &&
        distance(own.high, theirs.high) <= kSameBox * diagonal))
    return;
  for (std::size_t i = 0; i < builder.positions.size(); ++i)
    if (distance(to_glm(builder.positions[i]), to_glm(other.positions[i])) > kSamePlace * diagonal)
      builder.defects.add(DefectKind::illumination_elsewhere,
                          [&] { return fmt::format("{}: vertex {}", other.file, i + 1); });
}

}  // namespace

Status read_illumination(const ReadOptions& options, SceneBuilder& builder,
                         const Context& context) {
  const fs::path& path = options.illumination_file;
  SceneBuilder other(path);
  if (options.confine) other.named_files.confine_to(path.parent_path());
  other.limits = options.limits;
  other.wants_textures = false;
  auto values = read_values(path, context, other);
  if (!values.ok()) return values.status();
  if (values->size() != builder.positions.size()) {
    return {
        ErrorCode::bad_input,
        fmt::format("{}: {} values for the {} vertices of {} (both files must come from the same "
                    "mesh)",
                    path.string(), values->size(), builder.positions.size(), builder.file)};
  }
  builder.files.insert(builder.files.end(), other.files.begin(), other.files.end());
  for (const RawTexture& texture : other.textures) other.other_files.push_back(texture.path);
  builder.other_files.insert(builder.other_files.end(), other.other_files.begin(),
                             other.other_files.end());
  // Defects of the illumination are now those of this file, since the mesh's own is not used.
  auto& defects = builder.defects.defects;
  std::erase_if(defects, of_illumination);
  std::copy_if(other.defects.defects.begin(), other.defects.defects.end(),
               std::back_inserter(defects), of_illumination);
  std::sort(defects.begin(), defects.end(),
            [](const Defect& a, const Defect& b) { return a.kind < b.kind; });
  check_order(other, builder);
  builder.illumination = std::move(*values);
  builder.linear_light = other.linear_light;
  builder.illumination_file = path.string();
  return {};
}

}  // namespace atlas
