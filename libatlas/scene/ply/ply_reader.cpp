// Reads PLY: ascii and both binary byte orders.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "libatlas/scene/building/formats.h"
#include "libatlas/scene/ply/ply_header.h"
#include "libatlas/scene/ply/ply_losses.h"
#include "libatlas/scene/ply/ply_numbers.h"

namespace atlas {
namespace fs = std::filesystem;
namespace {

// Unsigned bytes and words are fractions of their largest value; other numbers are values.
double colour_scale(PlyType type) {
  return type == PlyType::u8 ? 1 / 255.0 : type == PlyType::u16 ? 1 / 65535.0 : 1;
}

class PlyParser {
 public:
  PlyParser(const FileBytes& bytes, const PlyHeader& header, SceneBuilder& builder)
      : header_(header), numbers_(bytes, header), builder_(builder), all_bytes_(bytes.size) {
    builder.objects.push_back({});
    for (const std::string& name : header.texture_files) {
      const fs::path path = fs::path(builder.file).parent_path() / name;
      builder.materials.push_back({});
      builder.materials.back().name = name;
      builder.materials.back().texture = static_cast<std::int32_t>(builder.textures.size());
      builder.textures.push_back({path, {}, builder.file});
    }
    if (builder.materials.empty()) builder.materials.push_back({});
  }

  // Faces that come before their vertices are passed over, and read at the end.
  Status run(const Context& context) {
    std::vector<std::pair<const PlyElement*, PlyNumbers>> early;
    for (const PlyElement& element : header_.elements) {
      if (element.properties.empty()) continue;
      element_ = &element;
      if (element.count > numbers_.bytes_left() / element.least_bytes(header_.format) + 1) {
        return short_file(
            fmt::format("{} of element {} are announced", element.count, element.name));
      }
      const bool faces = element.name == "face" || element.name == "tristrips";
      const bool is_early = faces && builder_.positions.empty() && vertices_follow();
      if (is_early) early.emplace_back(&element, numbers_);
      if (Status s = is_early ? pass(context) : read(context); !s.ok()) return s;
    }
    for (const auto& [element, numbers] : early) {
      element_ = element;
      numbers_ = numbers;
      if (Status s = read(context); !s.ok()) return s;
    }
    return {};
  }

 private:
  // Reads all of the current element.
  Status read(const Context& context) {
    if (element_->name == "vertex")
      return builder_.positions.empty() ? read_vertices(context) : more_vertices();
    if (element_->name == "face") return read_faces(context);
    if (element_->name == "tristrips") return read_strips(context);
    return skip(context);
  }

  Status short_file(std::string_view what) const {
    return {
        ErrorCode::bad_input,
        fmt::format("{}: {}, but the file ends before (it was cut short: copy or export it again)",
                    builder_.file, what)};
  }

  std::string place() const {
    return header_.format == PlyFormat::ascii
               ? fmt::format("{}:{}", builder_.file, line_)
               : fmt::format("{}: {} {}", builder_.file, element_->name, index_);
  }

  Status bad_number(const PlyProperty& property) const {
    if (numbers_.at_end() || header_.format != PlyFormat::ascii) {
      return short_file(
          fmt::format("{} {} of {} is incomplete", element_->name, index_ + 1, element_->count));
    }
    return {ErrorCode::bad_input,
            fmt::format("{}: no number for '{}' of {} {} (correct the line or export again)",
                        place(), property.name, element_->name, index_)};
  }

  // Reads one element: scalars into scalars_, lists into lists_.
  Status read_element(const Context& context) {
    if (index_ % 16384 == 0) {
      if (context.cancelled()) return Status::cancelled();
      context.report("reading", 1 - double(numbers_.bytes_left()) / double(all_bytes_));
    }
    numbers_.begin_element();
    line_ = numbers_.line();
    for (std::size_t i = 0; i < element_->properties.size(); ++i) {
      const PlyProperty& property = element_->properties[i];
      double& value = scalars_[i];
      if (!numbers_.next(property.list ? property.length_type : property.type, value)) {
        return bad_number(property);
      }
      if (!property.list) continue;
      if (!(value >= 0 && value == std::floor(value))) {
        return {ErrorCode::bad_input, fmt::format("{}: list '{}' has length {} (export again)",
                                                  place(), property.name, value)};
      }
      lists_[i].clear();
      for (double k = 0; k < value; ++k) {
        double item;
        if (!numbers_.next(property.type, item)) return bad_number(property);
        lists_[i].push_back(item);
      }
    }
    numbers_.end_element();
    return {};
  }

  void begin() {
    scalars_.assign(element_->properties.size(), 0);
    lists_.assign(element_->properties.size(), {});
    index_ = 0;
  }

  Status skip(const Context& context) {
    begin();
    for (; index_ < element_->count; ++index_) {
      if (Status s = read_element(context); !s.ok()) return s;
      builder_.defects.add(DefectKind::element_ignored, [&] { return place(); });
    }
    return {};
  }

  Status pass(const Context& context) {
    begin();
    for (; index_ < element_->count; ++index_)
      if (Status s = read_element(context); !s.ok()) return s;
    return {};
  }

  // Returns the properties of the first group whose names the element has in full, or none.
  std::vector<int> find_group(std::initializer_list<std::vector<const char*>> groups) const {
    for (const auto& group : groups) {
      std::vector<int> found;
      for (const char* name : group) {
        const int at = element_->find(name);
        if (at >= 0 && !element_->properties[at].list) found.push_back(at);
      }
      if (found.size() == group.size()) return found;
    }
    return {};
  }

  // Returns the properties that hold the light of vertices or faces, three or none.
  std::vector<int> find_light() const {
    auto rgb = find_group({{"illuminance_r", "illuminance_g", "illuminance_b"},
                           {"illumination_r", "illumination_g", "illumination_b"},
                           {"illuminance"},
                           {"r", "g", "b"},
                           {"red", "green", "blue"},
                           {"diffuse_red", "diffuse_green", "diffuse_blue"}});
    if (rgb.size() == 1) rgb = {rgb[0], rgb[0], rgb[0]};
    return rgb;
  }

  bool is_linear(const std::vector<int>& light) const {
    return !light.empty() && element_->properties[light[0]].name.starts_with("illumin");
  }

  // Returns a property of the current element as a share, if it is an integer without a sign.
  float share(int property) const {
    return float(scalars_[property] * colour_scale(element_->properties[property].type));
  }

  Vec3f light_of(const std::vector<int>& rgb) const {
    return {share(rgb[0]), share(rgb[1]), share(rgb[2])};
  }

  Status read_vertices(const Context& context) {
    const auto xyz = find_group({{"x", "y", "z"}});
    if (xyz.empty()) {
      return {ErrorCode::bad_input,
              fmt::format("{}: its vertices have no x, y and z (export positions)", builder_.file)};
    }
    const auto rgb = find_light();
    builder_.linear_light = is_linear(rgb);
    const auto uv = find_group(
        {{"s", "t"}, {"u", "v"}, {"texture_u", "texture_v"}, {"texture_s", "texture_t"}});
    const auto given_normal = find_group({{"nx", "ny", "nz"}});
    const auto normal = builder_.wants_normals ? given_normal : std::vector<int>();
    const auto alpha = builder_.wants_rest ? find_group({{"alpha"}}) : std::vector<int>();
    begin();
    std::vector<int> read;
    for (const std::vector<int>& group : {xyz, rgb, uv, normal, alpha})
      read.insert(read.end(), group.begin(), group.end());
    if (!builder_.wants_rest) read.insert(read.end(), given_normal.begin(), given_normal.end());
    PlyLosses losses(*element_, read, "vertices");
    std::vector<std::string> bad;  // places of the first unusable positions
    builder_.positions.reserve(element_->count);
    builder_.illumination.reserve(rgb.empty() ? 0 : element_->count);
    builder_.texcoords.reserve(uv.empty() ? 0 : element_->count);
    builder_.normals.reserve(normal.empty() ? 0 : element_->count);
    for (; index_ < element_->count; ++index_) {
      if (Status s = read_element(context); !s.ok()) return s;
      const auto& s = scalars_;
      losses.take(s);
      builder_.positions.push_back({s[xyz[0]], s[xyz[1]], s[xyz[2]]});
      if (!rgb.empty()) builder_.illumination.push_back(light_of(rgb));
      if (!alpha.empty()) builder_.vertex_opacity.push_back(share(alpha[0]));
      if (!uv.empty()) builder_.texcoords.push_back({float(s[uv[0]]), float(s[uv[1]])});
      if (!normal.empty()) {
        builder_.normals.push_back({float(s[normal[0]]), float(s[normal[1]]), float(s[normal[2]])});
      }
      if (!usable_position(builder_.positions.back()) && bad.size() < DefectReport::kMaxPlaces) {
        bad.push_back(place());
      }
    }
    count(losses);
    // What else there is may be the light under another name.
    if (rgb.empty() && !builder_.wants_rest) losses.add_to(builder_.not_read);
    vertex_uvs_ = !uv.empty();
    auto next_bad = bad.begin();
    builder_.check_positions([&](std::size_t) { return *next_bad++; });
    return {};
  }

  // Faces do not say to which of several vertex elements their indices refer.
  Status more_vertices() const {
    if (element_->count == 0) return {};
    return {ErrorCode::bad_input,
            fmt::format("{}: a second element 'vertex', of {} (export all vertices as one element)",
                        builder_.file, element_->count)};
  }

  // Returns whether a later element has vertices. If none has, the file has no vertices at all.
  bool vertices_follow() const {
    const PlyElement* end = header_.elements.data() + header_.elements.size();
    return std::any_of(element_ + 1, end,
                       [](const PlyElement& e) { return e.name == "vertex" && e.count > 0; });
  }

  Status read_faces(const Context& context) {
    if (element_->count == 0) return {};
    int list = element_->find("vertex_indices");
    if (list < 0) list = element_->find("vertex_index");
    if (list < 0 || !element_->properties[list].list) {
      return {
          ErrorCode::bad_input,
          fmt::format("{}: its faces have no list vertex_indices (export faces)", builder_.file)};
    }
    const int wedge = element_->find("texcoord"), number = element_->find("texnumber");
    begin();
    std::vector<int> read{list, wedge, header_.texture_files.empty() ? -1 : number};
    const auto rgb = find_face_light();
    const auto alpha =
        rgb.empty() || !builder_.wants_rest ? std::vector<int>() : find_group({{"alpha"}});
    for (const std::vector<int>& group : {rgb, alpha})
      read.insert(read.end(), group.begin(), group.end());
    PlyLosses losses(*element_, read, "faces");
    builder_.reserve_triangles(element_->count, vertex_uvs_ || wedge >= 0);
    std::vector<std::int64_t> corners, uvs;
    for (; index_ < element_->count; ++index_) {
      if (Status s = read_element(context); !s.ok()) return s;
      losses.take(scalars_);
      corners.clear();
      for (const double v : lists_[list]) corners.push_back(to_index(v));
      uvs.clear();
      if (wedge >= 0 && lists_[wedge].size() == 2 * corners.size()) {
        add_wedges(lists_[wedge], uvs);
      } else if (vertex_uvs_) {
        uvs = corners;
      }
      builder_.material = number < 0 ? 0 : material_of(number);
      if (!rgb.empty()) builder_.face_colour = {light_of(rgb), alpha.empty() ? 1 : share(alpha[0])};
      builder_.add_face({corners, uvs, normals_of(corners)}, [&] { return place(); });
    }
    builder_.face_colour.reset();
    count(losses);
    return {};
  }

  // Returns the properties that hold the light of faces, which is used if vertices have none.
  std::vector<int> find_face_light() {
    const auto rgb = find_light();
    if (rgb.empty() || builder_.illumination.empty()) {
      if (!rgb.empty()) builder_.linear_light = is_linear(rgb);
      return rgb;
    }
    builder_.defects.add(
        DefectKind::element_ignored,
        [&] {
          return fmt::format("{}: colours of faces, as its vertices have some", builder_.file);
        },
        element_->count);
    return {};
  }

  void count(const PlyLosses& losses) {
    if (builder_.wants_rest) losses.add_to(builder_.not_read);
  }

  // Returns the material of the current face, whose texture number is property `number`. Programs
  // that write every property of a face as a list give one value, or the same one at each corner.
  // MeshLab writes -1 where a face has no texture.
  std::uint32_t material_of(int number) {
    const std::size_t count = header_.texture_files.size();
    if (count == 0) return 0;
    double value = scalars_[number];
    if (element_->properties[number].list) {
      const std::vector<double>& list = lists_[number];
      if (list.empty()) return white();  // it names no texture
      value = list[0];
      if (std::count(list.begin(), list.end(), value) != std::ptrdiff_t(list.size())) {
        return unknown([] { return "texnumber has different values (give the face one)"; });
      }
    }
    if (value == -1) return white();
    if (!(value >= 0 && value < double(count))) {
      return unknown([&] {
        return fmt::format("texnumber {}, but the textures are 0 to {} (name all in the header)",
                           value, count - 1);
      });
    }
    return static_cast<std::uint32_t>(value);
  }

  // Counts the current face among those of unknown materials, and returns the white one.
  template <typename Reason>
  std::uint32_t unknown(Reason reason) {
    builder_.defects.add(DefectKind::material_unknown,
                         [&] { return fmt::format("{}: {}", place(), reason()); });
    return white();
  }

  // Returns the material without a texture behind those of the textures.
  std::uint32_t white() {
    const std::size_t count = header_.texture_files.size();
    if (builder_.materials.size() == count) builder_.materials.push_back({});
    return static_cast<std::uint32_t>(count);
  }

  // Reads triangle strips, which follow each other in one list, with a -1 after each.
  Status read_strips(const Context& context) {
    const int list = element_->find("vertex_indices");
    if (list < 0 || !element_->properties[list].list) return skip(context);
    begin();
    for (; index_ < element_->count; ++index_) {
      if (Status s = read_element(context); !s.ok()) return s;
      const std::vector<double>& strip = lists_[list];
      std::size_t first = 0;
      for (std::size_t k = 0; k < strip.size(); ++k) {
        if (strip[k] == -1) {
          first = k + 1;
        } else if (k >= first + 2) {
          const std::size_t odd = (k - first) % 2;  // every other triangle is reversed
          const std::int64_t corners[3] = {to_index(strip[k - 2 + odd]),
                                           to_index(strip[k - 1 - odd]), to_index(strip[k])};
          const std::span<const std::int64_t> all(corners);
          builder_.add_face({all, vertex_uvs_ ? all : all.first(0), normals_of(all)},
                            [&] { return place(); });
        }
      }
    }
    return {};
  }

  // Normals are given per vertex.
  std::span<const std::int64_t> normals_of(std::span<const std::int64_t> corners) const {
    return corners.first(builder_.normals.empty() ? 0 : corners.size());
  }

  static std::int64_t to_index(double v) {
    return v >= 0 && v <= 4294967295.0 ? static_cast<std::int64_t>(v) : -1;
  }

  void add_wedges(const std::vector<double>& list, std::vector<std::int64_t>& uvs) {
    for (std::size_t k = 0; k + 1 < list.size(); k += 2) {
      uvs.push_back(static_cast<std::int64_t>(builder_.texcoords.size()));
      builder_.texcoords.push_back({float(list[k]), float(list[k + 1])});
    }
  }

  const PlyHeader& header_;
  PlyNumbers numbers_;
  SceneBuilder& builder_;
  std::size_t all_bytes_;
  const PlyElement* element_ = nullptr;
  std::uint64_t index_ = 0;
  std::uint32_t line_ = 0;  // of the current element, in ascii files
  std::vector<double> scalars_;
  std::vector<std::vector<double>> lists_;
  bool vertex_uvs_ = false;
};

}  // namespace

Status read_ply(const fs::path& path, SceneBuilder& builder, const Context& context) {
  auto bytes = read_file_bytes(path);
  if (!bytes.ok()) return bytes.status();
  auto header = read_ply_header(*bytes, builder.file);
  if (!header.ok()) return header.status();
  return PlyParser(*bytes, *header, builder).run(context);
}

}  // namespace atlas
