#include "libatlas/scene/vrml/vrml_appearance.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "libatlas/scene/files/decode_uri.h"
#include "libatlas/scene/files/finite_float.h"

namespace atlas {
namespace fs = std::filesystem;
namespace {

// Urls are percent-encoded, but some programs write file names as they are.
fs::path vrml_file(const std::string& url, const SceneBuilder& builder) {
  const fs::path folder = fs::path(builder.file).parent_path();
  const fs::path plain = folder / url;
  return builder.named_files.exists(plain) ? plain : folder / decode_uri(url);
}

class AppearanceParser {
 public:
  AppearanceParser(VrmlScanner& scan, SceneBuilder& builder) : scan_(scan), builder_(builder) {}

  RawMaterial run(std::string_view token) {
    scan_.read_node(token, [&](std::string_view type, std::string_view name) {
      if (!is("Appearance", type)) return;
      scan_.fields([&](std::string_view field) {
        if (field == "material") return material(), true;
        if (field == "texture") return texture(), true;
        if (field == "textureTransform") return transform(), true;
        return false;
      });
      if (material_.name.empty()) material_.name = name;
    });
    if (material_.texture >= 0) {
      material_.unlit = !has_material_;
      material_.diffuse = {1, 1, 1};  // colours of a texture take its place
      if (material_.name.empty()) material_.name = image_;
    }
    return std::move(material_);
  }

 private:
  glm::dvec4 finite_row(int width) {
    const glm::dvec4 v = scan_.row(width);
    for (int i = 0; i < width; ++i) {
      if (!std::isfinite(v[i])) scan_.fail("a finite number expected");
    }
    return v;
  }

  static float limited(double light) {
    return static_cast<float>(std::clamp(light, 0.0, double(kMostLight)));
  }

  // Without a Material, a shape is unlit and white.
  void material() {
    scan_.read_node(scan_.next(), [&](std::string_view type, std::string_view name) {
      if (!is("Material", type)) return;
      has_material_ = true;
      material_.name = name;
      material_.diffuse = {0.8f, 0.8f, 0.8f};
      scan_.fields([&](std::string_view field) {
        if (field == "diffuseColor") {
          const glm::dvec4 c = finite_row(3);
          material_.diffuse = {finite_float(c.x), finite_float(c.y), finite_float(c.z)};
        } else if (field == "emissiveColor") {
          const glm::dvec4 c = finite_row(3);
          material_.emission = {limited(c.x), limited(c.y), limited(c.z)};
        } else if (field == "transparency") {
          material_.opacity = float(1 - std::clamp(finite_row(1).x, 0.0, 1.0));
          material_.alpha_mode = material_.opacity < 1 ? AlphaMode::blend : AlphaMode::opaque;
        } else {
          return false;
        }
        return true;
      });
    });
  }

  void texture() {
    scan_.read_node(scan_.next(), [&](std::string_view type, std::string_view) {
      if (type == "MovieTexture" || type == "PixelTexture") return other_texture(type);
      if (!is("ImageTexture", type)) return;
      scan_.fields([&](std::string_view field) {
        if (field == "repeatS") return material_.wrap_u = wrap(), true;
        if (field == "repeatT") return material_.wrap_v = wrap(), true;
        if (field == "url") return image(), true;
        return false;
      });
    });
  }

  // Returns whether a node is of the type that belongs here. A node of a PROTO may be one, too, but
  // it is not read. Others are malformed.
  bool is(std::string_view wanted, std::string_view type) {
    if (type == wanted) return true;
    if (!scan_.prototypes().contains(type)) {
      const bool vowel = wanted[0] == 'A' || wanted[0] == 'I';
      scan_.fail(fmt::format("{} {} expected", vowel ? "an" : "a", wanted));
    }
    builder_.defects.add(DefectKind::element_ignored, [&] {
      return fmt::format("{}:{}: {}", builder_.file, scan_.line(), type);
    });
    note_vrml_files(scan_, builder_);
    return false;
  }

  // Leaves the shape its plain colour.
  void other_texture(std::string_view type) {
    builder_.defects.add(DefectKind::texture_unreadable, [&] {
      return fmt::format("{}:{}: {}", builder_.file, scan_.line(), type);
    });
    note_vrml_files(scan_, builder_);
  }

  // Takes the first of the urls that is a file here, or the first of all.
  void image() {
    fs::path file;
    scan_.nodes([&](std::string_view token) {
      if (token.size() < 2 || token[0] != '"') scan_.fail("a url in quotes expected");
      const std::string url(token.substr(1, token.size() - 2));
      const fs::path found = url.empty() ? fs::path() : vrml_file(url, builder_);
      builder_.other_files.push_back(found);
      const NamedFiles& files = builder_.named_files;
      if (!file.empty() && (files.exists(file) || !files.exists(found))) return;
      file = found;
      image_ = url;
    });
    if (!file.empty()) material_.texture = builder_.texture_of(file, builder_.file);
  }

  TextureWrap wrap() { return scan_.next() == "FALSE" ? TextureWrap::clamp : TextureWrap::repeat; }

  // Moves coordinates by the translation, then turns and scales them about minus the centre, as the
  // format says.
  void transform() {
    scan_.read_node(scan_.next(), [&](std::string_view type, std::string_view) {
      if (!is("TextureTransform", type)) return;
      glm::dvec4 centre(0), scale(1), move(0);
      double angle = 0;
      scan_.fields([&](std::string_view field) {
        if (field == "center") return centre = finite_row(2), true;
        if (field == "scale") return scale = finite_row(2), true;
        if (field == "translation") return move = finite_row(2), true;
        if (field == "rotation") return angle = finite_row(1).x, true;
        return false;
      });
      const double c = std::cos(angle), s = std::sin(angle);
      const glm::dvec4 to = move + centre;
      material_.uv_u = {scale.x * c, -scale.x * s, scale.x * (c * to.x - s * to.y) - centre.x};
      material_.uv_v = {scale.y * s, scale.y * c, scale.y * (s * to.x + c * to.y) - centre.y};
    });
  }

  VrmlScanner& scan_;
  SceneBuilder& builder_;
  RawMaterial material_;
  std::string image_;
  bool has_material_ = false;
};

}  // namespace

void note_vrml_files(VrmlScanner& scan, SceneBuilder& builder) {
  scan.fields([&](std::string_view field) {
    if (field != "url") return false;
    scan.nodes([&](std::string_view token) {
      if (token.size() > 2 && token[0] == '"')
        builder.other_files.push_back(
            vrml_file(std::string(token.substr(1, token.size() - 2)), builder));
    });
    return true;
  });
}

RawMaterial read_vrml_appearance(std::string_view token, VrmlScanner& scan, SceneBuilder& builder) {
  return AppearanceParser(scan, builder).run(token);
}

}  // namespace atlas
