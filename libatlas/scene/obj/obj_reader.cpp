// Reads OBJ: cuts the file into chunks at line ends, parses them in parallel, and merges them in
// file order.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <mutex>
#include <optional>
#include <set>

#include "libatlas/core/parallel.h"
#include "libatlas/scene/building/formats.h"
#include "libatlas/scene/files/file_bytes.h"
#include "libatlas/scene/files/mtl_names.h"
#include "libatlas/scene/obj/obj_chunk.h"
#include "libatlas/scene/obj/obj_lightmap.h"

namespace atlas {
namespace fs = std::filesystem;
namespace {

constexpr std::size_t kChunkBytes = std::size_t{1} << 20;
constexpr double kParsing = 0.7;  // share of the time, on two threads

// Returns the boundaries of chunks of about kChunkBytes. A line that a backslash continues is not
// cut.
std::vector<const char*> cut(const FileBytes& bytes) {
  std::vector<const char*> borders{bytes.begin()};
  for (;;) {
    const char* at = borders.back();
    if (static_cast<std::size_t>(bytes.end() - at) <= kChunkBytes) break;
    for (at += kChunkBytes; at < bytes.end(); ++at) {
      if (at[-1] != '\n') continue;
      const char* before = at - 2;
      if (*before == '\r') --before;
      if (*before != '\\') break;
    }
    if (at >= bytes.end()) break;
    borders.push_back(at);
  }
  borders.push_back(bytes.end());
  return borders;
}

class Merger {
 public:
  Merger(const fs::path& path, SceneBuilder& builder, const Context& context)
      : path_(path), builder_(builder), context_(context) {
    builder_.materials.push_back({});  // for faces before the first usemtl
    builder_.objects.push_back({});
    material_id_[""] = object_id_[""] = 0;
  }

  Status merge(std::vector<ObjChunk>& chunks) {
    if (Status s = merge_vertices(chunks); !s.ok()) return s;
    if (Status s = read_libraries(chunks); !s.ok()) return s;
    line_ = 1;
    Counts before;
    for (ObjChunk& chunk : chunks) {
      make_absolute(chunk.position, before.positions);
      make_absolute(chunk.texcoord, before.texcoords);
      make_absolute(chunk.normal, before.normals);
      const Counts& own = counts_[&chunk - chunks.data()];
      before = {before.positions + own.positions, before.texcoords + own.texcoords,
                before.normals + own.normals};
      merge_faces(chunk);
      line_ += chunk.lines;
      chunk = {};
      if (context_.cancelled()) return Status::cancelled();
      const double done = double(&chunk - chunks.data() + 1) / double(chunks.size());
      context_.report("reading", kParsing + (1 - kParsing) * done);
    }
    if (builder_.wants_rest) count_not_read();
    return {};
  }

 private:
  // A scene holds neither smoothing groups nor groups within objects.
  void count_not_read() {
    if (!smoothing_groups_.empty())
      builder_.not_read["smoothing groups (s) of faces without normals"] = smoothing_groups_.size();
    if (!inner_groups_.empty())
      builder_.not_read["groups (g) within objects"] = inner_groups_.size();
  }

  struct Counts {
    std::size_t positions = 0, texcoords = 0, normals = 0;
  };

  static void make_absolute(ObjChunk::Corners& corners, std::size_t before) {
    for (const std::uint32_t k : corners.relative)
      corners.index[k] += static_cast<std::int32_t>(before);
  }

  std::string place(std::uint32_t line) const {
    return fmt::format("{}:{}", builder_.file, line_ + line);
  }

  Status merge_vertices(std::vector<ObjChunk>& chunks) {
    Counts all;
    std::size_t faces = 0;
    bool coloured = false;
    for (const ObjChunk& chunk : chunks) {
      if (!chunk.error.empty()) {
        return {ErrorCode::bad_input, fmt::format("{}: {} (correct the line or export again)",
                                                  place(chunk.error_line), chunk.error)};
      }
      line_ += chunk.lines;
      counts_.push_back({chunk.positions.size(), chunk.texcoords.size(), chunk.normals.size()});
      all.positions += counts_.back().positions;
      all.texcoords += counts_.back().texcoords;
      all.normals += counts_.back().normals;
      faces += chunk.face_end.size();
      coloured |= !chunk.colours.empty();
    }
    if (std::max({all.positions, all.texcoords, all.normals}) > 0x7fffffff) {
      return {ErrorCode::unsupported, builder_.file + ": more than 2^31 vertices (split the file)"};
    }
    builder_.positions.reserve(all.positions);
    builder_.texcoords.reserve(all.texcoords);
    builder_.normals.reserve(all.normals);
    if (coloured) builder_.illumination.reserve(all.positions);
    builder_.reserve_triangles(faces, all.texcoords != 0);
    line_ = 1;
    for (ObjChunk& chunk : chunks) {
      append_vertices(chunk, coloured);
      line_ += chunk.lines;
    }
    auto bad = bad_places_.begin();  // in the order of the vertices
    builder_.check_positions([&](std::size_t) { return *bad++; });
    return {};
  }

  void append_vertices(ObjChunk& chunk, bool coloured) {
    SceneBuilder& b = builder_;
    b.positions.insert(b.positions.end(), chunk.positions.begin(), chunk.positions.end());
    b.texcoords.insert(b.texcoords.end(), chunk.texcoords.begin(), chunk.texcoords.end());
    b.normals.insert(b.normals.end(), chunk.normals.begin(), chunk.normals.end());
    if (coloured) {
      chunk.colours.resize(chunk.positions.size(), {NAN, 0, 0});
      for (Vec3f& value : chunk.colours) {
        if (std::isnan(value.x)) {
          const std::size_t vertex = b.illumination.size() + 1;
          b.defects.add(DefectKind::illumination_missing,
                        [&] { return fmt::format("{}: vertex {}", b.file, vertex); });
          value = {};
        }
        b.illumination.push_back(value);
      }
    }
    for (const std::uint32_t line : chunk.bad_positions) {
      if (bad_places_.size() < DefectReport::kMaxPlaces) bad_places_.push_back(place(line));
    }
    for (const std::uint32_t line : chunk.bad_values) {
      b.defects.add(DefectKind::illumination_not_finite, [&] { return place(line); });
    }
    for (const std::uint32_t line : chunk.ignored) {
      b.defects.add(DefectKind::element_ignored, [&] { return place(line); });
    }
    std::vector<Vec3d>().swap(chunk.positions);
    std::vector<Vec3f>().swap(chunk.colours);
    std::vector<Vec2f>().swap(chunk.texcoords);
    std::vector<Vec3f>().swap(chunk.normals);
  }

  Status read_libraries(const std::vector<ObjChunk>& chunks) {
    line_ = 1;
    for (const ObjChunk& chunk : chunks) {
      for (const ObjEvent& event : chunk.events) {
        has_objects_ |= event.kind == ObjEvent::object;
        if (event.kind != ObjEvent::library) continue;
        if (Status s = read_library_list(event); !s.ok()) return s;
      }
      line_ += chunk.lines;
    }
    for (std::size_t i = 1; i < builder_.materials.size(); ++i) {
      material_id_.try_emplace(builder_.materials[i].name, static_cast<std::uint32_t>(i));
    }
    return {};
  }

  // Some programs name a library before each object. It is read only once.
  Status read_library_list(const ObjEvent& event) {
    for (const LibraryFile& file :
         builder_.named_files.library_files(path_.parent_path(), event.text)) {
      if (!libraries_.insert(file.path).second) continue;
      if (!builder_.may_read(file.path, place(event.line))) return builder_.refused;
      if (!file.exists) {
        builder_.defects.add(DefectKind::material_file_missing, [&] {
          return fmt::format("{} ({})", file.path.string(), place(event.line));
        });
      } else if (Status s = read_mtl(file.path, builder_); !s.ok()) {
        return s;
      }
    }
    return {};
  }

  // Copies the corners [begin, end) in the builder's form; none if the chunk names none.
  static void copy_corners(const ObjChunk::Corners& corners, std::uint32_t begin, std::uint32_t end,
                           std::vector<std::int64_t>& to) {
    to.clear();
    if (corners.index.empty()) return;
    for (std::uint32_t k = begin; k < end; ++k) {
      const std::int32_t i = corners.index[k];
      to.push_back(i == ObjChunk::kNoIndex ? SceneBuilder::kNoIndex : i);
    }
  }

  void merge_faces(const ObjChunk& chunk) {
    std::size_t next_event = 0;
    std::uint32_t begin = 0;
    std::vector<std::int64_t> vertices, uvs, normals;
    for (std::size_t face = 0; face < chunk.face_end.size(); ++face) {
      while (next_event < chunk.events.size() && chunk.events[next_event].face <= face) {
        apply(chunk.events[next_event++]);
      }
      const std::uint32_t end = chunk.face_end[face];
      vertices.assign(chunk.position.index.begin() + begin, chunk.position.index.begin() + end);
      copy_corners(chunk.texcoord, begin, end, uvs);
      copy_corners(chunk.normal, begin, end, normals);
      if (!smoothing_.empty() && !smoothing_counted_ &&
          (normals.empty() || normals[0] == SceneBuilder::kNoIndex)) {
        smoothing_groups_.insert(smoothing_);
        smoothing_counted_ = true;
      }
      builder_.add_face({vertices, uvs, normals}, [&] { return place(chunk.face_line[face]); });
      begin = end;
    }
    while (next_event < chunk.events.size()) apply(chunk.events[next_event++]);
  }

  void apply(const ObjEvent& event) {
    const std::string name(event.text);
    if (event.kind == ObjEvent::material) {
      const auto next = static_cast<std::uint32_t>(builder_.materials.size());
      const auto [at, is_new] = material_id_.try_emplace(name, next);
      if (is_new) {
        builder_.materials.push_back({});
        builder_.materials.back().name = name;
        builder_.defects.add(DefectKind::material_unknown,
                             [&] { return fmt::format("{}: '{}'", place(event.line), name); });
      }
      builder_.material = at->second;
    } else if (event.kind == ObjEvent::smoothing) {
      smoothing_ = name == "off" || name == "0" ? "" : name;
      smoothing_counted_ = false;
    } else if (event.kind == ObjEvent::group && has_objects_) {
      if (builder_.wants_rest && !name.empty()) inner_groups_.insert(name);
    } else if (event.kind == (has_objects_ ? ObjEvent::object : ObjEvent::group)) {
      const auto next = static_cast<std::uint32_t>(builder_.objects.size());
      const auto [at, is_new] = object_id_.try_emplace(name, next);
      if (is_new) builder_.objects.push_back(name);
      builder_.object = at->second;
    }
  }

  fs::path path_;
  SceneBuilder& builder_;
  const Context& context_;
  std::uint32_t line_ = 1;               // of the file, where the current chunk begins
  bool has_objects_ = false;             // if so, groups do not count as objects
  std::vector<Counts> counts_;           // 1 per chunk
  std::vector<std::string> bad_places_;  // places of the first unusable positions
  std::map<std::string, std::uint32_t> material_id_, object_id_;
  std::string smoothing_;  // group of the faces that follow; empty if there is none
  bool smoothing_counted_ = false;
  std::set<std::string> smoothing_groups_, inner_groups_;
  std::set<fs::path> libraries_;  // those already read or reported
};

// Refuses a file whose last line has no line end and is a face of fewer than three corners: it was
// cut off there.
Status check_tail(const fs::path& path, const FileBytes& bytes, const ObjChunk& last,
                  std::uint32_t lines) {
  if (bytes.size == 0 || bytes.end()[-1] == '\n' || last.face_end.empty()) return {};
  const std::size_t faces = last.face_end.size();
  const std::uint32_t begin = faces > 1 ? last.face_end[faces - 2] : 0;
  if (last.face_line.back() != last.lines || last.face_end.back() - begin >= 3) return {};
  return {
      ErrorCode::bad_input,
      fmt::format("{}:{}: the file ends in the middle of a face (it was cut short: export or copy "
                  "it again)",
                  path.string(), lines)};
}

// Takes what the comments at the head of the file say of the pages of its uvs. Returns the lightmap
// that they name.
std::optional<LightmapImages> take_comments(const FileBytes& bytes, UvPages& pages) {
  std::optional<LightmapImages> lightmap;
  std::string_view text = bytes.text();
  while (text.starts_with('#')) {
    const std::size_t end = std::min(text.find('\n'), text.size() - 1);
    pages.take(text.substr(0, end));
    if (!lightmap) lightmap = lightmap_in_comment(text.substr(0, end));
    text.remove_prefix(end + 1);
  }
  return lightmap;
}

}  // namespace

Status read_obj(const fs::path& path, SceneBuilder& builder, const Context& context) {
  auto bytes = read_text_bytes(path);
  if (!bytes.ok()) return bytes.status();
  const std::optional<LightmapImages> lightmap = take_comments(*bytes, builder.uv_pages);
  if (lightmap) note_lightmap(*lightmap, builder);
  if (lightmap && builder.wants_lightmap) read_obj_lightmap(*lightmap, builder, context);
  const std::vector<const char*> borders = cut(*bytes);
  std::vector<ObjChunk> chunks(borders.size() - 1);
  std::mutex reporting;
  std::size_t parsed = 0;
  parallel_for(context, chunks.size(), 1, [&](std::size_t i, std::size_t) {
    chunks[i] =
        parse_obj_chunk(borders[i], borders[i + 1], {builder.wants_normals, builder.wants_rest});
    const std::lock_guard lock(reporting);
    context.report("reading", kParsing * double(++parsed) / double(chunks.size()));
  });
  if (context.cancelled()) return Status::cancelled();
  std::uint32_t lines = 1;
  for (const ObjChunk& chunk : chunks) lines += chunk.lines;
  if (Status s = check_tail(path, *bytes, chunks.back(), lines); !s.ok()) return s;
  return Merger(path, builder, context).merge(chunks);
}

}  // namespace atlas
