// Reads MTL: the diffuse part of materials, their opacity and emission, and their other lines. The
// builder lists or counts those lines for materials in use.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "libatlas/core/small_letters.h"
#include "libatlas/scene/building/formats.h"
#include "libatlas/scene/files/file_bytes.h"
#include "libatlas/scene/files/finite_float.h"
#include "libatlas/scene/files/mtl_names.h"
#include "libatlas/scene/files/text_scanner.h"

namespace atlas {
namespace fs = std::filesystem;
namespace {

// Returns a keyword as the format spells it if it is read here: some programs write kd and map_kd.
std::string_view spelled(std::string_view keyword) {
  const std::string wanted = small_letters(std::string(keyword));
  for (const std::string_view known :
       {"newmtl", "Kd", "map_Kd", "d", "map_d", "Ke", "map_Ke", "illum"}) {
    if (small_letters(std::string(known)) == wanted) return known;
  }
  return keyword;
}

class MtlParser {
 public:
  MtlParser(const fs::path& path, const FileBytes& bytes, SceneBuilder& builder)
      : path_(path), scan_(bytes.begin(), bytes.end()), builder_(builder) {}

  Status run() {
    while (!scan_.at_end()) {
      if (!scan_.at_line_end()) {
        line_ = scan_.line() + 1;
        if (Status s = parse_line(); !s.ok()) return s;
      }
      scan_.next_line();
    }
    return {};
  }

 private:
  std::string place() const { return fmt::format("{}:{}", path_.string(), line_); }
  Status malformed(std::string_view what) const {
    return {ErrorCode::bad_input, fmt::format("{}: {} (correct the line)", place(), what)};
  }

  Status parse_line() {
    const std::string_view word = scan_.word(), keyword = spelled(word);
    if (inside_ && keyword != "newmtl" && keyword != "Kd") keep_line(keyword, word.end());
    if (keyword == "newmtl") {
      builder_.materials.push_back({});
      builder_.materials.back().name = scan_.rest();
      inside_ = true;
      emission_given_ = constant_ = false;
      return {};
    }
    note_map(keyword);
    if (keyword == "illum") {
      if (inside_) parse_illumination_model();
      return {};
    }
    if (keyword == "d") return parse_opacity();
    if (keyword == "map_d") {
      if (inside_) builder_.materials.back().opacity_textured = true;
      return {};
    }
    if (keyword == "Ke" || keyword == "map_Ke") {
      if (inside_) parse_emission(keyword == "map_Ke");
      return {};
    }
    if (keyword != "Kd" && keyword != "map_Kd") return {};
    if (!inside_) return malformed(fmt::format("{} before the first newmtl", keyword));
    return keyword == "Kd" ? parse_colour() : parse_map();
  }

  // Keeps the line whose keyword has just been read and ends at `at`, without its indentation.
  void keep_line(std::string_view keyword, const char* at) {
    if (keyword.starts_with('#')) return;
    TextScanner rest = scan_;
    std::string& line = builder_.materials.back().mtl_lines.emplace_back(keyword);
    line.append(at, rest.rest_with_comment().end());
  }

  // Of `d -halo 0.5`, only notes that it is there if it lets anything through. Ignores a value that
  // is not a fraction. Tr is not read at all, since some programs write it for 1 - d and others for
  // d.
  Status parse_opacity() {
    if (!inside_) return {};
    RawMaterial& material = builder_.materials.back();
    TextScanner ahead = scan_;
    const bool halo = small_letters(std::string(ahead.word())) == "-halo";
    if (halo) scan_ = ahead;
    double share = 0;
    if (!scan_.number(share) || !(share >= 0 && share <= 1)) return {};
    material.opacity_by_view = halo && share < 1;
    if (halo) return {};
    material.opacity = static_cast<float>(share);
    material.alpha_mode = material.opacity < 1 ? AlphaMode::blend : AlphaMode::opaque;
    return {};
  }

  // An emission texture without Ke is taken with the factor 1. A value that is not a colour (`Ke
  // spectral a.rfl`) is ignored.
  void parse_emission(bool texture) {
    RawMaterial& material = builder_.materials.back();
    if (texture) {
      material.emission_textured = true;
      if (!emission_given_) material.emission = {1, 1, 1};
      return;
    }
    double c[3];
    int count = 0;
    while (count < 3 && scan_.number(c[count]) && c[count] >= 0 && c[count] <= kMostLight) ++count;
    if (count == 0 || count == 2) return;
    if (count == 1) c[1] = c[2] = c[0];
    material.emission = {float(c[0]), float(c[1]), float(c[2])};
    emission_given_ = true;
  }

  // Model 0 shows the colour as it is. A material without a texture is not taken as unlit: some
  // programs write 0 for all they do not know.
  void parse_illumination_model() {
    double model = 0;
    constant_ = scan_.number(model) && model == 0;
    note_unlit();
  }

  void note_unlit() {
    RawMaterial& material = builder_.materials.back();
    material.unlit = constant_ && material.texture >= 0;
  }

  // Returns whether a colour is given as a curve (`spectral FILE`) or as CIE XYZ.
  bool is_other_colour() const {
    TextScanner ahead = scan_;
    const std::string_view form = ahead.word();
    return form == "spectral" || form == "xyz";
  }

  Status parse_colour() {
    if (is_other_colour()) {
      builder_.defects.add(DefectKind::reflectance_unknown, [&] {
        return fmt::format("{}: material '{}'", place(), builder_.materials.back().name);
      });
      return {};
    }
    double c[3];
    int count = 0;
    for (; count < 3 && !scan_.at_line_end(); ++count) {
      TextScanner ahead = scan_;
      if (!scan_.number(c[count]) || !std::isfinite(c[count])) {
        return malformed(fmt::format("'{}' is not a number of Kd r g b", ahead.word()));
      }
    }
    if (count == 0 || count == 2) return malformed("Kd needs three numbers, or one");
    if (count == 1) c[1] = c[2] = c[0];
    RawMaterial& material = builder_.materials.back();
    material.diffuse = {finite_float(c[0]), finite_float(c[1]), finite_float(c[2])};
    if (!is_reflectance(material.diffuse)) {
      builder_.defects.add(DefectKind::reflectance_beyond_one, [&] {
        return fmt::format("{}: Kd of material '{}'", place(), material.name);
      });
    }
    return {};
  }

  // Returns the texture file that `name` means. Unless there is a file of the whole name, a '#'
  // after a blank begins a comment, and quotes enclose the name.
  fs::path texture_file(std::string_view name) const {
    const fs::path folder = path_.parent_path();
    const fs::path whole = builder_.named_files.file(folder, name);
    if (builder_.named_files.exists(whole)) return whole;
    const std::string_view quoted = quoted_name(name);
    return builder_.named_files.file(folder,
                                     quoted.empty() ? TextScanner::without_comment(name) : quoted);
  }

  // Notes the file of a map that is not read (map_Ks, bump, ...). Its options come first; they are
  // skipped word by word until the rest names a file.
  void note_map(std::string_view keyword) {
    const std::string name = small_letters(std::string(keyword));
    const bool other = name == "bump" || name == "disp" || name == "decal" || name == "norm" ||
                       name == "refl" || (name.starts_with("map_") && name != "map_kd");
    if (!other) return;
    constexpr int kMostWords = 40;  // of options
    std::string_view rest = scan_.rest_with_comment();
    const bool has_options = rest.starts_with('-');
    for (int skipped = 0; !rest.empty() && skipped < kMostWords; ++skipped, next_word(rest)) {
      fs::path file = texture_file(rest);
      if (builder_.named_files.is_file(file))
        return builder_.other_files.push_back(std::move(file));
      if (!has_options) return;
    }
  }

  // Options come first. The rest of the line is the name, which may contain blanks. A second
  // texture takes the place of the first one, with its own options.
  Status parse_map() {
    std::string_view rest = scan_.rest_with_comment();
    RawMaterial& material = builder_.materials.back();
    const RawMaterial plain;
    material.uv_u = plain.uv_u;
    material.uv_v = plain.uv_v;
    material.wrap_u = plain.wrap_u;
    material.wrap_v = plain.wrap_v;
    while (rest.size() > 1 && rest[0] == '-') {
      const std::string_view option = next_word(rest);
      if (Status s = parse_option(option, rest); !s.ok()) return s;
    }
    if (rest.empty() || rest[0] == '#') return malformed("map_Kd names no file");
    material.texture = builder_.texture_of(texture_file(rest), place());
    note_unlit();
    return {};
  }

  Status parse_option(std::string_view option, std::string_view& rest) {
    RawMaterial& material = builder_.materials.back();
    if (option == "-o" || option == "-s" || option == "-t") {
      double values[3] = {option == "-s" ? 1.0 : 0.0, option == "-s" ? 1.0 : 0.0, 0};
      if (!take_numbers(rest, values, 1, 3)) {
        return malformed(fmt::format("{} of map_Kd needs a number", option));
      }
      double& u = option == "-o" ? material.uv_u[2] : material.uv_u[0];
      double& v = option == "-o" ? material.uv_v[2] : material.uv_v[1];
      if (option != "-t") {
        u = values[0];
        v = values[1];
        return {};
      }
    } else if (option == "-mm") {
      double values[3];
      if (!take_numbers(rest, values, 2, 2)) return malformed("-mm of map_Kd needs two numbers");
      if (values[0] == 0 && values[1] == 1) return {};
    } else {  // one argument: on|off, a number, or a channel's letter
      const std::string_view argument = next_word(rest);
      if (argument == "off" || option == "-blendu" || option == "-blendv") return {};
      if (option == "-clamp" && argument == "on") {
        material.wrap_u = material.wrap_v = TextureWrap::clamp;
        return {};
      }
    }
    builder_.defects.add(DefectKind::texture_option_ignored,
                         [&] { return fmt::format("{}: {}", place(), option); });
    return {};
  }

  static std::string_view next_word(std::string_view& rest) {
    const std::string_view word = rest.substr(0, rest.find_first_of(" \t"));
    rest.remove_prefix(word.size());
    rest.remove_prefix(std::min(rest.find_first_not_of(" \t"), rest.size()));
    return word;
  }

  static bool take_numbers(std::string_view& rest, double* values, int least, int most) {
    int count = 0;
    while (count < most) {
      std::string_view left = rest;
      const std::string_view word = next_word(left);
      const char* end = word.data() + word.size();
      if (word.empty() || parse_number(word.data(), end, values[count]) != end) break;
      rest = left;
      ++count;
    }
    return count >= least;
  }

  fs::path path_;
  TextScanner scan_;
  SceneBuilder& builder_;
  std::uint32_t line_ = 1;
  bool inside_ = false;
  // Whether the current material has Ke, and illum 0.
  bool emission_given_ = false, constant_ = false;
};

}  // namespace

Status read_mtl(const fs::path& path, SceneBuilder& builder) {
  auto bytes = read_text_bytes(path);
  if (!bytes.ok()) return bytes.status();
  builder.files.push_back(path);
  return MtlParser(path, *bytes, builder).run();
}

}  // namespace atlas
