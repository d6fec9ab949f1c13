// VRML97 (ISO/IEC 14772-1:1997), limited to the subset that all readers agree on.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "libatlas/core/glm_bridge.h"
#include "libatlas/exporters/viewing/camera.h"
#include "libatlas/exporters/viewing/visitor.h"
#include "libatlas/exporters/world.h"
#include "libatlas/exporters/writing/compact_page.h"
#include "libatlas/exporters/writing/far_origin.h"
#include "libatlas/exporters/writing/page_sides.h"
#include "libatlas/exporters/writing/text_output.h"
#include "libatlas/files/file_extension.h"

namespace atlas {
namespace fs = std::filesystem;
namespace {

// Returns the text as an SFString: in quotes, with other characters than ASCII replaced by '?', and
// quotes and backslashes escaped.
std::string quoted(const std::string& text) {
  std::string result = "\"";
  for (const char c : text) {
    if (c == '"' || c == '\\') result += '\\';
    result += c >= ' ' && c <= '~' ? c : '?';
  }
  return result + '"';
}

// X_ITE draws no farther than this, in units of the file, unless a world says how far it is seen.
// The limit leaves room for walking away from it.
constexpr double kUsualFar = 1e5, kFarFactor = 4;

std::string note_of(const Vec3d& origin) {
  return fmt::format("origin {} {} {}: to be added to every coordinate", origin.x, origin.y,
                     origin.z);
}

void vector(TextBuffer& out, const glm::dvec3& v) {
  for (int i = 0; i < 3; ++i) {
    if (i > 0) out.character(' ');
    out.number(static_cast<float>(v[i]));
  }
}

// Writes the rotation to `direction` as axis and angle.
void orientation(TextBuffer& out, const glm::dvec3& direction) {
  const std::array<double, 4> q = camera_rotation(direction);
  const glm::dvec3 axis(q[0], q[1], q[2]);
  const double sine = glm::length(axis);
  vector(out, sine > 0 ? axis / sine : glm::dvec3(0, 1, 0));
  out.character(' ');
  out.number(static_cast<float>(2 * std::atan2(sine, q[3])));
}

// Returns whether a page has an image. If none has, viewers light the world: without a light it
// would be a silhouette.
bool carries_light(const World& world) {
  return std::any_of(world.pages.begin(), world.pages.end(),
                     [](const Page& page) { return !page.image.empty(); });
}

std::string header(const World& world, const Vec3d& origin_left_out) {
  TextBuffer out;
  out.text("#VRML V2.0 utf8\n");
  out.text("WorldInfo {\n  title " + quoted(world.title) + "\n  info [\n");
  for (const std::string& line : world.info) out.text("    " + quoted(line) + "\n");
  if (world.up == Up::z) out.text("    " + quoted(kZUpNote) + "\n");
  if (origin_left_out != Vec3d{}) out.text("    " + quoted(note_of(origin_left_out)) + "\n");
  out.text("  ]\n}\nNavigationInfo {\n  headlight ");
  out.text(carries_light(world) ? "FALSE" : "TRUE");
  out.text("\n  type [ ");
  out.text(world.viewpoint.inside ? "\"WALK\", \"ANY\" ]\n" : "\"EXAMINE\", \"ANY\" ]\n");
  // Viewers draw from half of the avatar's width on. However small or large the unit is, these
  // lengths must stay floats above 0.
  const Visitor visitor = visitor_of(world);
  const auto number = [&](double length) {
    out.number(static_cast<float>(std::clamp(length, 1e-30, 1e30)));
  };
  out.text("  avatarSize [ ");
  for (const double length : {visitor.width, visitor.height, visitor.step}) {
    number(length);
    out.character(' ');
  }
  out.text("]\n  speed ");
  number(visitor.speed);
  if (kFarFactor * visitor.farthest > kUsualFar) {
    out.text("\n  visibilityLimit ");
    number(kFarFactor * visitor.farthest);
  }
  out.text("\n}\n");
  return out.bytes();
}

// Viewers use the +Y axis of a Viewpoint's own coordinate system as up, also when walking, so a
// Transform turns it.
std::string viewpoint(const World& world, const Vec3d& origin) {
  glm::dvec3 position = to_glm(origin) + to_glm(world.viewpoint.position);
  glm::dvec3 direction = to_glm(world.viewpoint.direction);
  TextBuffer out;
  out.text("Transform {\n");
  if (world.up == Up::z) {
    out.text("  rotation 1 0 0 1.5707964\n");  // takes +Y to +Z
    position = z_up_to_y_up(position);
    direction = z_up_to_y_up(direction);
  }
  out.text("  children Viewpoint {\n    description \"start\"\n    position ");
  vector(out, position);
  out.text("\n    orientation ");
  orientation(out, direction);
  out.text("\n    fieldOfView ");
  out.number(static_cast<float>(world.viewpoint.fov));
  out.text("\n  }\n}\n");
  return out.bytes();
}

void write_triangles(TextFile& file, const std::vector<std::uint32_t>& indices,
                     const Context& context) {
  file.write_items(indices.size() / 3, context, [&](TextBuffer& out, std::size_t t) {
    for (int c = 0; c < 3; ++c) {
      out.number(indices[3 * t + c]);
      out.character(' ');
    }
    out.text("-1\n");
  });
}

// The geometry of a Shape: its corners, what is added to their positions, and whether viewers skip
// its triangles where they see their back.
struct Part {
  Compactor::Compact points, uvs;
  Vec3d origin;
  bool one_sided;
};

void write_part(TextFile& file, const World& world, const Part& part, const Context& context) {
  const Compactor::Compact &points = part.points, &uvs = part.uvs;
  if (!carries_light(world)) file.write("    creaseAngle 0.7\n");  // smooths round surfaces
  file.write(part.one_sided ? "    solid TRUE\n" : "    solid FALSE\n");
  file.write("    coord Coordinate { point [\n");
  file.write_items(points.used.size(), context, [&](TextBuffer& out, std::size_t i) {
    out.position(part.origin, world.positions[points.used[i]]);
    out.character('\n');
  });
  file.write("    ] }\n    coordIndex [\n");
  write_triangles(file, points.indices, context);
  file.write("    ]\n    texCoord TextureCoordinate { point [\n");
  file.write_items(uvs.used.size(), context, [&](TextBuffer& out, std::size_t i) {
    out.uv(world.uvs[uvs.used[i]]);
    out.character('\n');
  });
  file.write("    ] }\n    texCoordIndex [\n");
  write_triangles(file, uvs.indices, context);
  file.write("    ]\n");
}

std::string appearance(const Page& page, bool lit) {
  if (!lit) return "  appearance Appearance { material Material { } }\n";
  if (page.image.empty()) return "  appearance Appearance { }\n";
  return fmt::format(
      "  appearance Appearance {{\n    texture ImageTexture {{\n      url {}\n"
      "      repeatS FALSE\n      repeatT FALSE\n    }}\n  }}\n",
      '"' + encode_uri(page.image) + '"');
}

}  // namespace

Result<WorldFile> write_vrml(const World& world, const fs::path& path, AtomicFiles& files,
                             const Context& context) {
  if (Status s = check_world(world); !s.ok()) return s;
  if (Status s = check_only_triangles(world); !s.ok()) return s;
  if (world.scene != nullptr) {
    return Status(ErrorCode::bad_option,
                  path.string() +
                      ": VRML cannot keep a scene beside new uvs (write .gltf, .glb or "
                      ".obj)");
  }
  WorldFile result;
  const bool gzip = lower_extension(path) == ".wrz";
  const fs::path temporary = files.path_for(path);
  TextFile file(temporary, path, gzip);
  if (too_far_for_floats(world)) result.origin_left_out = world.origin;
  const Vec3d origin = result.origin_left_out == Vec3d{} ? world.origin : Vec3d{};
  file.write(header(world, result.origin_left_out));
  file.write(viewpoint(world, origin));
  Compactor positions(world.positions.size()), texcoords(world.uvs.size());
  for (std::size_t i = 0; i < world.pages.size(); ++i) {
    const Page& page = world.pages[i];
    if (page.indices.empty()) continue;  // viewers warn of an IndexedFaceSet without faces
    const PageSides both(page);
    for (const PageSides::Side& side : both.sides()) {
      const Part part{positions.compact(side.indices), texcoords.compact(side.uv_indices), origin,
                      side.one_sided};
      file.write(fmt::format("DEF Page_{}{} Shape {{\n", i, side.one_sided ? "_OneSided" : ""));
      file.write(appearance(page, carries_light(world)));
      file.write("  geometry IndexedFaceSet {\n");
      write_part(file, world, part, context);
      file.write("  }\n}\n");
      result.triangles += side.indices.size() / 3;
      result.vertices += part.points.used.size();
      result.uvs += part.uvs.used.size();
    }
    context.report("writing the world", double(i + 1) / double(world.pages.size()));
  }
  if (Status s = file.finish(); !s.ok()) return s;
  std::error_code error;  // a pipe has no size
  const auto bytes = fs::file_size(temporary, error);
  result.bytes = error ? file.bytes() : static_cast<std::int64_t>(bytes);
  return result;
}

}  // namespace atlas
