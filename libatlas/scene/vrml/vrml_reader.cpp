// Reads VRML97 worlds: the part of the language that this project's exporter writes, and similar
// files. Everything else is skipped by its brackets.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <glm/gtc/quaternion.hpp>
#include <glm/mat4x4.hpp>
#include <iterator>
#include <set>
#include <string>

#include "libatlas/core/glm_bridge.h"
#include "libatlas/scene/building/formats.h"
#include "libatlas/scene/files/file_bytes.h"
#include "libatlas/scene/files/text_scanner.h"
#include "libatlas/scene/vrml/vrml_appearance.h"
#include "libatlas/scene/vrml/vrml_scanner.h"
#include "libatlas/scene/vrml/vrml_shapes.h"

namespace atlas {
namespace fs = std::filesystem;
namespace {

constexpr int kMaxDepth = 200;  // of nested nodes

// Limits on the text that a file unpacks to, and on what its USE repeat: a few nested USE can stand
// for more nodes than there are bytes in any memory. A scene takes up to eight times the bytes of
// its text. Worlds compress to a fifth up to a thirtieth.
constexpr std::uint64_t kFewText = std::uint64_t{64} << 20, kMostExpansion = 128;
constexpr std::uint64_t kAnyText = std::uint64_t{1} << 50;

glm::dmat4 rotation(const glm::dvec4& axis_and_angle) {
  const glm::dvec3 axis(axis_and_angle);
  const double length = glm::length(axis);
  return length > 0 ? glm::mat4_cast(glm::angleAxis(axis_and_angle.w, axis / length))
                    : glm::dmat4(1);
}

bool is_group(std::string_view type) {
  return type == "Transform" || type == "Group" || type == "Collision" || type == "Anchor" ||
         type == "Billboard";
}

class VrmlParser : VrmlScanner {
 public:
  VrmlParser(const std::string& text, double most_repeated, SceneBuilder& builder,
             const Context& context)
      : VrmlScanner(text, most_repeated, context), builder_(builder), context_(context) {}

  Status run() {
    if (!text().starts_with("#VRML V2.0 utf8")) {
      return error("a VRML97 file begins with '#VRML V2.0 utf8'");
    }
    try {
      if (text().find("USE") != std::string_view::npos) count_repetitions();
      world();
    } catch (const MalformedVrml&) {
      return context_.cancelled() ? Status::cancelled() : error(what());
    }
    finish();
    const bool any = builder_.triangle_count() + builder_.defects.triangles_left_out > 0;
    return any || context_.cancelled() ? Status() : without_faces();
  }

 private:
  void world() {
    for (std::string_view token = next(); !token.empty(); token = next())
      node(token, glm::dmat4(1), 0);
  }

  // Refuses a file that repeats too much before any of it is copied. What is malformed ends the
  // counting, and is told when it is read.
  void count_repetitions() {
    const char* const begin = place();
    set_counting(true);
    try {
      world();
    } catch (const MalformedVrml&) {
      if (repeats_too_much() || context_.cancelled()) throw;
    }
    set_counting(false);
    go_to(begin);
  }

  Status error(const std::string& what) const {
    const bool remedied = what.ends_with(')');
    return {ErrorCode::bad_input,
            fmt::format(
                "{}:{}: {}{}", builder_.file, line(), what,
                remedied ? "" : " (not all of VRML97 is read; give the scene in another format)")};
  }

  // Says why a world without faces has none, if it holds what would show something. Otherwise
  // SceneBuilder::finish() says that there is nothing.
  Status without_faces() const {
    const auto names = [](const auto& all) {
      constexpr std::size_t kMostNamed = 5;
      const auto end = std::next(all.begin(), std::ptrdiff_t(std::min(all.size(), kMostNamed)));
      return fmt::format("{}{}", fmt::join(all.begin(), end, ", "),
                         all.size() > kMostNamed ? ", ..." : "");
    };
    std::vector<std::string> why;
    if (!unread_.empty())
      why.push_back("of what shows faces only IndexedFaceSet is read, not " + names(unread_));
    if (!prototypes().empty())
      why.push_back("PROTO is not supported, and it declares " + names(prototypes()));
    const char* remedy =
        why.empty() ? "set their whichChoice" : "export the scene as a triangle mesh";
    if (const auto hidden = builder_.defects.count(DefectKind::node_hidden); hidden > 0)
      why.push_back(fmt::format("it shows none of the children of {} Switch nodes", hidden));
    if (why.empty()) return {};
    return {ErrorCode::bad_input, fmt::format("{}: no triangle to work on: {} ({})", builder_.file,
                                              fmt::join(why, "; "), remedy)};
  }

  void node(std::string_view token, const glm::dmat4& matrix, int depth) {
    if (depth > kMaxDepth) fail("nodes are nested too deeply");
    if (token == "ROUTE") return ignored(token), skip_route();  // the world at rest is read
    if (skip_prototype(token)) return;
    read_node(token, [&](std::string_view type, std::string_view) {
      if (is_group(type)) return group(matrix, depth);
      if (type == "Switch" || type == "LOD") return choice(type == "LOD", matrix, depth);
      if (counting()) return count_uses();
      if (type == "Shape") return shape(matrix);
      if (type == "WorldInfo") return world_info();
      if (type == "Viewpoint") return viewpoint(matrix);
      if (type == "Inline")  // the shapes of another file
        return unread(type), note_vrml_files(*this, builder_);
      if (prototypes().contains(type)) ignored(type);
      skip();
    });
  }

  // Skips a node after its type.
  void skip() {
    expect("{");
    skip_brackets();
  }

  void ignored(std::string_view type) {
    if (counting()) return;
    builder_.defects.add(DefectKind::element_ignored, [&] { return place_of(place(), type); });
  }
  // Does the same for a node that would show something.
  void unread(std::string_view type) {
    ignored(type);
    unread_.insert(std::string(start_of(type)));
  }
  std::string place_of(const char* at, std::string_view type) const {
    return fmt::format("{}:{}: {}", builder_.file, line_of(at), type);
  }

  // Reads the exporter's notes of the pages' shapes, and of an origin for which single-precision
  // coordinates would not suffice.
  void world_info() {
    constexpr std::string_view kNote = "\"origin ";
    fields([&](std::string_view name) {
      if (name != "info") return false;
      nodes([&](std::string_view token) {
        builder_.uv_pages.take(token);
        if (!token.starts_with(kNote)) return;
        const char* p = token.data() + kNote.size();
        glm::dvec3 origin(0);
        for (int i = 0; i < 3 && p; ++i)
          p = parse_number(p + (i > 0), token.data() + token.size(), origin[i]);
        if (p && *p == ':') origin_ = origin;
      });
      return true;
    });
  }

  void viewpoint(const glm::dmat4& matrix) {
    glm::dvec3 position(0, 0, 10);
    glm::dvec4 turn(0, 0, 1, 0);
    std::string_view description;
    fields([&](std::string_view name) {
      if (name == "description") return description = next(), true;
      if (name == "position") return position = glm::dvec3(row(3)), true;
      if (name == "orientation") return turn = row(4), true;
      return false;
    });
    const glm::dmat4 axes = matrix * rotation(turn);
    builder_.take_view(from_glm(glm::dvec3(matrix * glm::dvec4(position, 1))),
                       from_glm(-glm::dvec3(axes[2])), unquoted(description));
  }

  // Returns a string without its quotes.
  static std::string unquoted(std::string_view token) {
    if (token.starts_with('"')) token.remove_prefix(1);
    if (token.ends_with('"')) token.remove_suffix(1);
    return std::string(token);
  }

  // The children of a Transform may come before its translation, rotation and scale, so they are
  // read in a second pass.
  void group(const glm::dmat4& matrix, int depth) {
    glm::dvec3 translation(0), centre(0), scale(1);
    glm::dvec4 turn(0, 0, 1, 0), scale_axes(0, 0, 1, 0);
    const char* children = nullptr;
    fields([&](std::string_view name) {
      if (name == "translation") return translation = glm::dvec3(row(3)), true;
      if (name == "center") return centre = glm::dvec3(row(3)), true;
      if (name == "scale") return scale = glm::dvec3(row(3)), true;
      if (name == "scaleOrientation") return scale_axes = row(4), true;
      if (name == "rotation") return turn = row(4), true;
      if (name == "children") children = place();
      return false;
    });
    if (!children) return;
    const glm::dmat4 axes = rotation(scale_axes);
    glm::dmat4 local = rotation(turn) * axes;
    for (int c = 0; c < 3; ++c) local[c] *= scale[c];
    local = local * glm::transpose(axes);
    local[3] = glm::dvec4(translation + centre - glm::dvec3(local * glm::dvec4(centre, 0)), 1);
    const char* after = place();
    go_to(children);
    nodes([&](std::string_view token) { node(token, matrix * local, depth + 1); });
    go_to(after);
  }

  // Reads the child of a Switch that whichChoice names, or the first level of an LOD, which is the
  // finest.
  void choice(bool lod, const glm::dmat4& matrix, int depth) {
    const char *begin = place(), *children = nullptr;
    double chosen = lod ? 0 : -1;
    fields([&](std::string_view name) {
      if (name == "whichChoice" && !lod) return chosen = integer(), true;
      if (name == (lod ? "level" : "choice")) children = place();
      return false;
    });
    if (!children) return;
    const char* after = place();
    go_to(children);
    double count = 0;
    bool shown = false;
    nodes([&](std::string_view token) {
      if (count++ != chosen) return skip_node(token);
      shown = true;
      node(token, matrix, depth + 1);
    });
    if (count > 0 && !shown && !counting()) {
      builder_.defects.add(DefectKind::node_hidden, [&] {
        return place_of(begin, fmt::format("Switch with whichChoice {}", chosen));
      });
    }
    go_to(after);
  }

  void shape(const glm::dmat4& matrix) {
    VrmlShape result;
    RawMaterial material;
    bool has_faces = false;
    fields([&](std::string_view name) {
      if (name == "appearance")
        return material = read_vrml_appearance(next(), *this, builder_), true;
      if (name != "geometry") return false;
      read_node(next(), [&](std::string_view type, std::string_view) {
        if (type == "IndexedFaceSet") return face_set(result), void(has_faces = true);
        unread(type);
        skip();
      });
      return true;
    });
    if (has_faces) shapes_.add(std::move(result), std::move(material), matrix);
  }

  void face_set(VrmlShape& shape) {
    fields([&](std::string_view name) {
      if (name == "coordIndex") return shape.corners = indices(), true;
      if (name == "texCoordIndex") return shape.uv_corners = indices(), true;
      if (name == "colorIndex") return shape.colour_corners = indices(), true;
      if (name == "colorPerVertex") return shape.colour_per_vertex = next() != "FALSE", true;
      if (name == "ccw") return shape.clockwise = next() == "FALSE", true;
      if (name == "solid") return shape.solid = next() == "TRUE", true;
      if (name == "coord") {
        return rows("point", 3, [&](const double* v) {
          shape.points.push_back({v[0], v[1], v[2]});
        });
      }
      if (name == "texCoord") {
        return rows("point", 2, [&](const double* v) {
          shape.uvs.push_back({float(v[0]), float(v[1])});
        });
      }
      if (name == "color") {
        return rows("color", 3, [&](const double* v) {
          shape.colours.push_back({float(v[0]), float(v[1]), float(v[2])});
        });
      }
      return false;
    });
  }

  // Reads a node, and calls add(numbers) for each row of the list in one of its fields.
  template <class Add>
  bool rows(std::string_view wanted, std::size_t width, const Add& add) {
    read_node(next(), [&](std::string_view, std::string_view) {
      fields([&](std::string_view field) {
        if (field != wanted) return false;
        const auto values = list(width);
        for (std::size_t i = 0; i < values.size(); i += width) add(&values[i]);
        return true;
      });
    });
    return true;
  }

  void finish() {
    for (Vec3d& p : builder_.positions) p = from_glm(origin_ + to_glm(p));
    if (auto& view = builder_.view) view->position = from_glm(origin_ + to_glm(view->position));
    for (FileView& view : builder_.further_views)
      view.position = from_glm(origin_ + to_glm(view.position));
    shapes_.add_faces(kScanned, context_);
  }

  SceneBuilder& builder_;
  const Context& context_;
  glm::dvec3 origin_{0};
  std::set<std::string> unread_;  // what would have shown something
  VrmlShapes shapes_{builder_};
};

}  // namespace

Status read_vrml(const fs::path& path, SceneBuilder& builder, const Context& context) {
  std::error_code error;  // reading tells
  const std::uintmax_t bytes = fs::file_size(path, error);
  const std::uint64_t most = builder.limits ? std::max(kFewText, kMostExpansion * bytes) : kAnyText;
  auto text = read_text_or_gzip(path, most);
  if (!text.ok()) return text.status();
  return VrmlParser(*text, double(most), builder, context).run();
}

}  // namespace atlas
