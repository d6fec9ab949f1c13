// Reads VRML97 worlds: the part of the language that this project's exporter writes, and similar
// files. Everything else is skipped by its brackets.
#include <fmt/format.h>

#include <algorithm>
#include <glm/gtc/quaternion.hpp>
#include <glm/mat4x4.hpp>

#include "libatlas/core/glm_bridge.h"
#include "libatlas/scene/file_bytes.h"
#include "libatlas/scene/formats.h"
#include "libatlas/scene/text_scanner.h"
#include "libatlas/scene/vrml_scanner.h"

namespace atlas {
namespace fs = std::filesystem;
namespace {

constexpr int kMaxDepth = 200;  // of nested nodes

// What a Shape holds, before its faces become triangles.
struct Shape {
  std::vector<Vec3d> points;
  std::vector<Vec2f> uvs;
  std::vector<double> corners, uv_corners;  // indices, with a -1 after each face
  std::string image;
  bool repeat_u = true, repeat_v = true;
};

class VrmlParser : VrmlScanner {
 public:
  VrmlParser(const std::string& text, SceneBuilder& builder, const Context& context)
      : VrmlScanner(text, context), builder_(builder), context_(context) {}

  Status run() {
    if (!text().starts_with("#VRML V2.0 utf8")) {
      return error("a VRML97 file begins with '#VRML V2.0 utf8'");
    }
    try {
      for (std::string_view token = next(); !token.empty(); token = next()) {
        node(token, glm::dmat4(1), 0);
      }
    } catch (const MalformedVrml&) {
      return context_.cancelled() ? Status::cancelled() : error(what());
    }
    finish();
    return {};
  }

 private:
  Status error(const std::string& what) const {
    return {ErrorCode::bad_input,
            fmt::format("{}:{}: {} (only worlds as this program writes them are "
                        "read; use the original scene)",
                        builder_.file, line(), what)};
  }

  std::string_view node_type(std::string_view token) {
    if (token == "DEF") {
      next();
      token = next();
    }
    if (token.empty() || token[0] < 'A' || token[0] > 'Z') {
      fail(fmt::format("'{}' where a node should be", start_of(token)));
    }
    return token;
  }

  void node(std::string_view token, const glm::dmat4& matrix, int depth) {
    if (depth > kMaxDepth) fail("nodes are nested too deeply");
    if (token == "USE" || token == "ROUTE" || token == "PROTO" || token == "EXTERNPROTO") {
      fail(fmt::format("{} is not supported", token));
    }
    token = node_type(token);
    if (token == "Shape") {
      shape(matrix);
    } else if (token == "Transform" || token == "Group" || token == "Collision" ||
               token == "Anchor") {
      group(matrix, depth);
    } else if (token == "WorldInfo") {
      world_info();
    } else {
      expect("{");
      skip_brackets();
    }
  }

  // Reads the exporter's note of an origin for which single-precision coordinates would not
  // suffice.
  void world_info() {
    constexpr std::string_view kNote = "\"origin ";
    fields([&](std::string_view name) {
      if (name != "info" || peek() != "[") return false;
      next();
      for (std::string_view token = next(); token != "]" && !token.empty(); token = next()) {
        if (!token.starts_with(kNote)) continue;
        const char* p = token.data() + kNote.size();
        glm::dvec3 origin(0);
        for (int i = 0; i < 3 && p; ++i)
          p = parse_number(p + (i > 0), token.data() + token.size(), origin[i]);
        if (p && *p == ':') origin_ = origin;
      }
      return true;
    });
  }

  // The children of a Transform may come before its translation, rotation and scale, so they are
  // read in a second pass.
  void group(const glm::dmat4& matrix, int depth) {
    glm::dvec3 translation(0), centre(0), scale(1);
    glm::dvec4 turn(0, 0, 1, 0);
    const char* children = nullptr;
    fields([&](std::string_view name) {
      if (name == "translation") return translation = glm::dvec3(row(3)), true;
      if (name == "center") return centre = glm::dvec3(row(3)), true;
      if (name == "scale") return scale = glm::dvec3(row(3)), true;
      if (name == "rotation") return turn = row(4), true;
      if (name == "children") children = place();
      return false;
    });
    if (!children) return;
    glm::dmat4 local(1);
    const double length = glm::length(glm::dvec3(turn));
    if (length > 0) local = glm::mat4_cast(glm::angleAxis(turn.w, glm::dvec3(turn) / length));
    for (int c = 0; c < 3; ++c) local[c] *= scale[c];
    local[3] = glm::dvec4(translation + centre - glm::dvec3(local * glm::dvec4(centre, 0)), 1);
    const char* after = place();
    go_to(children);
    if (peek() != "[") {
      node(next(), matrix * local, depth + 1);
    } else {
      next();
      for (auto token = next(); token != "]"; token = next())
        node(token, matrix * local, depth + 1);
    }
    go_to(after);
  }

  void shape(const glm::dmat4& matrix) {
    Shape result;
    bool has_faces = false;
    fields([&](std::string_view name) {
      if (name == "appearance") return appearance(result), true;
      if (name != "geometry") return false;
      if (node_type(next()) == "IndexedFaceSet") return face_set(result), has_faces = true;
      expect("{");
      skip_brackets();
      builder_.defects.add(DefectKind::element_ignored, [&] { return builder_.file; });
      return true;
    });
    if (!has_faces) return;
    const std::size_t base = builder_.positions.size();
    for (const Vec3d& p : result.points) {
      const glm::dvec3 q = glm::dvec3(matrix * glm::dvec4(to_glm(p), 1));
      builder_.positions.push_back(from_glm(q));
    }
    bases_.push_back({base, builder_.texcoords.size(), glm::determinant(glm::dmat3(matrix)) < 0});
    builder_.texcoords.insert(builder_.texcoords.end(), result.uvs.begin(), result.uvs.end());
    result.points = {};
    shapes_.push_back(std::move(result));
  }

  void appearance(Shape& shape) {
    if (node_type(next()) != "Appearance") fail("an Appearance expected");
    fields([&](std::string_view name) {
      if (name != "texture") return false;
      if (node_type(next()) != "ImageTexture") fail("an ImageTexture expected");
      fields([&](std::string_view field) {
        if (field == "repeatS") return shape.repeat_u = next() != "FALSE", true;
        if (field == "repeatT") return shape.repeat_v = next() != "FALSE", true;
        if (field != "url") return false;
        std::string_view token = next();
        const bool many = token == "[";
        if (many) token = next();
        if (token.size() < 2 || token[0] != '"') fail("a url in quotes expected");
        shape.image = token.substr(1, token.size() - 2);
        while (many && token != "]" && !token.empty()) token = next();
        return true;
      });
      return true;
    });
  }

  void face_set(Shape& shape) {
    fields([&](std::string_view name) {
      if (name == "coordIndex") return shape.corners = list(1), true;
      if (name == "texCoordIndex") return shape.uv_corners = list(1), true;
      if (name != "coord" && name != "texCoord") return false;
      const bool uv = name == "texCoord";
      node_type(next());
      fields([&](std::string_view field) {
        if (field != "point") return false;
        const auto values = list(uv ? 2 : 3);
        for (std::size_t i = 0; !uv && i < values.size(); i += 3) {
          shape.points.push_back({values[i], values[i + 1], values[i + 2]});
        }
        for (std::size_t i = 0; uv && i < values.size(); i += 2) {
          shape.uvs.push_back({float(values[i]), float(values[i + 1])});
        }
        return true;
      });
      return true;
    });
  }

  void finish() {
    for (Vec3d& p : builder_.positions) p = from_glm(origin_ + to_glm(p));
    builder_.check_positions(
        [&](std::size_t i) { return fmt::format("{}: vertex {}", builder_.file, i); });
    for (std::size_t i = 0; i < shapes_.size(); ++i) add_faces(shapes_[i], i);
  }

  void add_material(const Shape& shape, std::size_t number) {
    RawMaterial material;
    material.name = shape.image.empty() ? fmt::format("page{}", number) : shape.image;
    if (!shape.image.empty()) {
      const fs::path image = fs::path(builder_.file).parent_path() / shape.image;
      material.texture = static_cast<std::int32_t>(builder_.textures.size());
      if (!shape.repeat_u) material.wrap_u = TextureWrap::clamp;
      if (!shape.repeat_v) material.wrap_v = TextureWrap::clamp;
      builder_.textures.push_back({image, {}, builder_.file});
    }
    builder_.material = builder_.object = static_cast<std::uint32_t>(number);
    builder_.materials.push_back(std::move(material));
    builder_.objects.push_back(fmt::format("shape{}", number));
  }

  void add_faces(const Shape& shape, std::size_t number) {
    add_material(shape, number);
    const Base& base = bases_[number];
    const auto& own = shape.uv_corners.empty() ? shape.corners : shape.uv_corners;
    const bool textured = !shape.uvs.empty();
    std::vector<std::int64_t> vertices, uvs;
    std::size_t face = 0;
    for (std::size_t k = 0; k <= shape.corners.size(); ++k) {
      if (k < shape.corners.size() && shape.corners[k] != -1) {
        // An index beyond its own list must not reach into the next shape's.
        const std::size_t points = base.points(builder_, bases_, number);
        vertices.push_back(index(shape.corners[k], points, base.position));
        const double uv = textured && k < own.size() ? own[k] : -2;
        uvs.push_back(index(uv, shape.uvs.size(), base.texcoord));
        continue;
      }
      if (vertices.empty()) continue;
      if (base.mirrored) {
        std::reverse(vertices.begin(), vertices.end());
        std::reverse(uvs.begin(), uvs.end());
      }
      builder_.add_face(
          {vertices, std::span<const std::int64_t>(uvs).first(textured ? uvs.size() : 0)},
          [&] { return fmt::format("{}: shape {} face {}", builder_.file, number, face); });
      ++face;
      vertices.clear();
      uvs.clear();
    }
  }

  static std::int64_t index(double value, std::size_t count, std::size_t base) {
    return value >= 0 && value < double(count)
               ? static_cast<std::int64_t>(value) + std::int64_t(base)
               : -1;
  }

  struct Base {
    std::size_t position = 0, texcoord = 0;
    bool mirrored = false;

    std::size_t points(const SceneBuilder& builder, const std::vector<Base>& all,
                       std::size_t number) const {
      const std::size_t end =
          number + 1 < all.size() ? all[number + 1].position : builder.positions.size();
      return end - position;
    }
  };

  SceneBuilder& builder_;
  const Context& context_;
  glm::dvec3 origin_{0};
  std::vector<Shape> shapes_;
  std::vector<Base> bases_;
};

}  // namespace

Status read_vrml(const fs::path& path, SceneBuilder& builder, const Context& context) {
  auto text = read_text_or_gzip(path);
  if (!text.ok()) return text.status();
  return VrmlParser(*text, builder, context).run();
}

}  // namespace atlas
