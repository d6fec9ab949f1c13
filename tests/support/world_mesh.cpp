#include "tests/support/world_mesh.h"

#include <cctype>
#include <charconv>
#include <cmath>
#include <fstream>
#include <glm/gtc/matrix_transform.hpp>
#include <glm/mat4x4.hpp>
#include <glm/vec4.hpp>
#include <map>
#include <stdexcept>
#include <string>
#include <string_view>

#include "libatlas/image/image_io.h"
#include "tests/support/html_page.h"
#include "tests/support/vrml_nodes.h"

namespace atlas::test {
namespace {

namespace fs = std::filesystem;

std::string read_text(const fs::path& path) {
  std::ifstream file(path, std::ios::binary);
  if (!file) throw std::runtime_error(path.string() + ": cannot be opened");
  std::string text(fs::file_size(path), '\0');
  file.read(text.data(), std::streamsize(text.size()));
  return text;
}

int load_image(WorldMesh& mesh, std::map<std::string, int>& known, const fs::path& path) {
  const auto [it, fresh] = known.emplace(path.string(), int(mesh.images.size()));
  if (fresh) {
    auto image = read_image8(path);
    if (!image.ok()) throw std::runtime_error(image.status().message());
    mesh.images.push_back(std::move(*image));
  }
  return it->second;
}

// Splits a text at white space into words, with line ends as separate events.
class Words {
 public:
  explicit Words(std::string_view text) : text_(text) {}
  bool next_line() {
    while (at_ < text_.size() && text_[at_] != '\n') ++at_;
    if (at_ < text_.size()) ++at_;
    return at_ < text_.size();
  }
  std::string_view word() {  // empty at the end of a line
    while (at_ < text_.size() && (text_[at_] == ' ' || text_[at_] == '\t' || text_[at_] == '\r'))
      ++at_;
    const std::size_t first = at_;
    while (at_ < text_.size() && !std::isspace(static_cast<unsigned char>(text_[at_]))) ++at_;
    return text_.substr(first, at_ - first);
  }
  bool number(float& value) {
    const std::string_view w = word();
    return !w.empty() && std::from_chars(w.data(), w.data() + w.size(), value).ec == std::errc();
  }

 private:
  std::string_view text_;
  std::size_t at_ = 0;
};

void read_mtl(const fs::path& path, WorldMesh& mesh, std::map<std::string, std::uint32_t>& names,
              std::map<std::string, int>& images) {
  const std::string text = read_text(path);
  Words words(text);
  do {
    const std::string_view key = words.word();
    if (key == "newmtl") {
      names[std::string(words.word())] = std::uint32_t(mesh.surfaces.size());
      mesh.surfaces.emplace_back();
    } else if (key == "Kd") {
      glm::vec3& d = mesh.surfaces.back().diffuse;
      words.number(d.x) && words.number(d.y) && words.number(d.z);
    } else if (key == "map_Kd") {
      mesh.surfaces.back().image = load_image(mesh, images, path.parent_path() / words.word());
    }
  } while (words.next_line());
}

std::pair<std::uint32_t, std::uint32_t> obj_corner(std::string_view word, const WorldMesh& mesh) {
  long v = 0, t = 0;
  const char* end = word.data() + word.size();
  const char* at = std::from_chars(word.data(), end, v).ptr;
  if (at != end && *at == '/') std::from_chars(at + 1, end, t);
  if (v < 0) v += long(mesh.positions.size()) + 1;
  if (t < 0) t += long(mesh.texcoords.size()) + 1;
  if (v < 1 || v > long(mesh.positions.size()) || t < 0 || t > long(mesh.texcoords.size()))
    throw std::runtime_error("OBJ index out of range: " + std::string(word));
  return {std::uint32_t(v - 1), t > 0 ? std::uint32_t(t - 1) : WorldMesh::kNoTexcoord};
}

void read_obj(const fs::path& path, WorldMesh& mesh) {
  const std::string text = read_text(path);
  std::map<std::string, std::uint32_t> names;
  std::map<std::string, int> images;
  mesh.surfaces.emplace_back();
  std::uint32_t surface = 0;
  Words words(text);
  std::vector<std::pair<std::uint32_t, std::uint32_t>> corners;
  do {
    const std::string_view key = words.word();
    if (key == "v") {
      glm::vec3 p, e(1);
      words.number(p.x) && words.number(p.y) && words.number(p.z);
      words.number(e.x) && words.number(e.y) && words.number(e.z);
      mesh.positions.push_back(p);
      mesh.light.push_back(e);
    } else if (key == "vt") {
      glm::vec2 t;
      words.number(t.x) && words.number(t.y);
      mesh.texcoords.push_back(t);
    } else if (key == "mtllib") {
      read_mtl(path.parent_path() / words.word(), mesh, names, images);
    } else if (key == "usemtl") {
      surface = names[std::string(words.word())];
    } else if (key == "f") {
      corners.clear();
      for (std::string_view w = words.word(); !w.empty(); w = words.word())
        corners.push_back(obj_corner(w, mesh));
      for (std::size_t k = 2; k < corners.size(); ++k) {
        mesh.triangles.push_back({corners[0].first, corners[k - 1].first, corners[k].first});
        mesh.triangle_texcoords.push_back(
            {corners[0].second, corners[k - 1].second, corners[k].second});
        mesh.triangle_surface.push_back(surface);
      }
    }
  } while (words.next_line());
}

// Adds the triangles of a page of HTML in the coordinates of its scene.
void read_html(const fs::path& path, WorldMesh& mesh) {
  const HtmlPage page(read_text(path));
  for (std::size_t i = 0; i < page.world["pages"].size(); ++i) {
    const std::string bytes = page.data("page" + std::to_string(i));
    auto image = decode_image8({reinterpret_cast<const std::uint8_t*>(bytes.data()), bytes.size()},
                               path.string());
    if (!image.ok()) throw std::runtime_error(image.status().message());
    mesh.images.push_back(std::move(*image));
    mesh.surfaces.push_back({glm::vec3(1), int(i)});
  }
  const bool z_up = page.world["up"] == "z";
  const double metres = page.world["metresPerUnit"];
  const auto& origin = page.world["origin"];
  const auto in_scene = [&](const std::array<double, 3>& p) {
    const glm::dvec3 turned = z_up ? glm::dvec3(p[0], -p[2], p[1]) : glm::dvec3(p[0], p[1], p[2]);
    return glm::vec3(turned / metres + glm::dvec3(origin[0].get<double>(), origin[1].get<double>(),
                                                  origin[2].get<double>()));
  };
  for (const HtmlPage::Part& part : page.parts)
    for (const auto& triangle : part.triangles) {
      const auto first = std::uint32_t(mesh.positions.size());
      for (const HtmlPage::Corner& corner : triangle) {
        mesh.positions.push_back(in_scene(corner.position));
        mesh.light.emplace_back(1);
        mesh.texcoords.emplace_back(corner.uv[0], corner.uv[1]);
      }
      mesh.triangles.push_back({first, first + 1, first + 2});
      mesh.triangle_texcoords.push_back({first, first + 1, first + 2});
      mesh.triangle_surface.push_back(std::uint32_t(part.page));
    }
}

glm::dmat4 transform_of(const vrml::Node& node) {
  const auto numbers = [&](const char* name, std::vector<double> otherwise) {
    const auto& n = node.field(name).numbers;
    return n.size() == otherwise.size() ? n : otherwise;
  };
  const auto t = numbers("translation", {0, 0, 0}), r = numbers("rotation", {0, 0, 1, 0}),
             s = numbers("scale", {1, 1, 1});
  glm::dmat4 m = glm::translate(glm::dmat4(1), {t[0], t[1], t[2]});
  if (r[3] != 0) m = glm::rotate(m, r[3], glm::dvec3(r[0], r[1], r[2]));
  return glm::scale(m, {s[0], s[1], s[2]});
}

// Collects the Shapes under a node.
class Gatherer {
 public:
  Gatherer(WorldMesh& mesh, fs::path folder) : mesh_(mesh), folder_(std::move(folder)) {}

  void gather(const vrml::Node* node, glm::dmat4 transform) {
    if (!node) return;
    if (node->type == "Transform") transform = transform * transform_of(*node);
    if (node->type == "Shape") return add_shape(*node, transform);
    for (const auto& [name, value] : node->fields)
      for (const vrml::Node* child : value.nodes) gather(child, transform);
  }

 private:
  void add_shape(const vrml::Node& shape, const glm::dmat4& transform) {
    const vrml::Node* faces = shape.node("geometry");
    if (!faces || faces->type != "IndexedFaceSet") return;
    WorldMesh::Surface surface;
    if (const vrml::Node* appearance = shape.node("appearance"))
      if (const vrml::Node* texture = appearance->node("texture"))
        if (!texture->field("url").strings.empty())
          surface.image = load_image(mesh_, images_, folder_ / texture->field("url").strings[0]);
    mesh_.surfaces.push_back(surface);
    const vrml::Node* coord = faces->node("coord");
    const vrml::Node* texcoord = faces->node("texCoord");
    if (!coord) return;
    const auto first = std::uint32_t(mesh_.positions.size()),
               first_uv = std::uint32_t(mesh_.texcoords.size());
    const auto& points = coord->field("point").numbers;
    for (std::size_t i = 0; i + 2 < points.size(); i += 3) {
      mesh_.positions.push_back(
          glm::vec3(transform * glm::dvec4(points[i], points[i + 1], points[i + 2], 1)));
      mesh_.light.emplace_back(1);
    }
    if (texcoord) {
      const auto& uvs = texcoord->field("point").numbers;
      for (std::size_t i = 0; i + 1 < uvs.size(); i += 2)
        mesh_.texcoords.emplace_back(uvs[i], uvs[i + 1]);
    }
    add_faces(*faces, first, first_uv, texcoord != nullptr);
  }

  void add_faces(const vrml::Node& faces, std::uint32_t first, std::uint32_t first_uv,
                 bool textured) {
    const auto& index = faces.field("coordIndex").numbers;
    const auto& given = faces.field("texCoordIndex").numbers;
    const auto& uv_index = given.empty() ? index : given;
    std::vector<std::size_t> polygon;
    for (std::size_t i = 0; i <= index.size(); ++i) {
      if (i < index.size() && index[i] >= 0) {
        polygon.push_back(i);
        continue;
      }
      for (std::size_t k = 2; k < polygon.size(); ++k) {
        std::array<std::uint32_t, 3> v, t;
        for (int c = 0; c < 3; ++c) {
          const std::size_t at = polygon[c == 0 ? 0 : k - 2 + c];
          v[c] = first + std::uint32_t(index[at]);
          t[c] = textured && at < uv_index.size() ? first_uv + std::uint32_t(uv_index[at])
                                                  : WorldMesh::kNoTexcoord;
          if (v[c] >= mesh_.positions.size() || (textured && t[c] >= mesh_.texcoords.size()))
            throw std::runtime_error("VRML index out of range");
        }
        mesh_.triangles.push_back(v);
        mesh_.triangle_texcoords.push_back(t);
        mesh_.triangle_surface.push_back(std::uint32_t(mesh_.surfaces.size() - 1));
      }
      polygon.clear();
    }
  }

  WorldMesh& mesh_;
  fs::path folder_;
  std::map<std::string, int> images_;
};

}  // namespace

Result<WorldMesh> read_world(const fs::path& path) {
  WorldMesh mesh;
  try {
    if (path.extension() == ".obj") {
      read_obj(path, mesh);
    } else if (path.extension() == ".wrl") {
      const vrml::Nodes nodes = vrml::read_nodes(read_text(path));
      Gatherer gatherer(mesh, path.parent_path());
      for (const vrml::Node* root : nodes.roots) gatherer.gather(root, glm::dmat4(1));
    } else if (path.extension() == ".html") {
      read_html(path, mesh);
    } else {
      return Status(ErrorCode::unsupported, path.string() + ": neither .obj, .wrl nor .html");
    }
  } catch (const std::exception& error) {
    return Status(ErrorCode::bad_input, path.string() + ": " + error.what());
  }
  if (mesh.triangles.empty()) return Status(ErrorCode::bad_input, path.string() + ": no triangles");
  return mesh;
}

}  // namespace atlas::test
