#include "examples/cabin/write.h"

#include <charconv>
#include <fstream>
#include <set>
#include <string>

#include "libatlas/files/atomic_file.h"
#include "libatlas/image/image_io.h"

namespace cabin {
namespace {

namespace fs = std::filesystem;

glm::vec3 turned(glm::vec3 p, bool y_up) {
  return y_up ? glm::vec3(p.x, p.z, -p.y) : p;
}

// Writes text to a file through its own buffer. Numbers have the shortest form that reads back as
// the same value.
class Writer {
 public:
  Writer(const fs::path& path, const atlas::Context& context)
      : file_(path, std::ios::binary), context_(context) {
    buffer_.reserve(kFull + 256);
  }
  Writer& text(std::string_view s) {
    buffer_.append(s);
    if (buffer_.size() >= kFull) flush();
    return *this;
  }
  template <class Number>
  Writer& number(Number x) {
    char digits[32];
    const auto end = std::to_chars(digits, digits + sizeof digits, x).ptr;
    return text({digits, std::size_t(end - digits)});
  }
  Writer& bytes(const void* data, std::size_t size) {
    return text({static_cast<const char*>(data), size});
  }
  atlas::Status finish(const fs::path& path) {
    flush();
    if (context_.cancelled()) return atlas::Status::cancelled();
    file_.flush();
    if (file_) return {};
    return {atlas::ErrorCode::io, path.string() + ": could not be written (is the disk full?)"};
  }

 private:
  static constexpr std::size_t kFull = 1 << 20;
  void flush() {
    if (!context_.cancelled()) file_.write(buffer_.data(), std::streamsize(buffer_.size()));
    buffer_.clear();
  }
  std::ofstream file_;
  const atlas::Context& context_;
  std::string buffer_;
};

glm::vec3 total_light(const Mesh& mesh, std::size_t v) {
  return mesh.direct[v] + mesh.indirect[v];
}

atlas::Status write_textures(const fs::path& folder, const Mesh& mesh, atlas::AtomicFiles& files,
                             const atlas::Context& context) {
  std::set<std::string> done;
  for (const SurfaceMaterial& m : mesh.materials) {
    if (m.texture_file.empty() || !done.insert(m.texture_file).second) continue;
    if (context.cancelled()) return atlas::Status::cancelled();
    const atlas::Status status =
        atlas::write_png(files.path_for(folder / m.texture_file), m.texture, {});
    if (!status.ok()) return status;
  }
  return {};
}

atlas::Status write_mtl(const fs::path& path, const Mesh& mesh, const atlas::Context& context) {
  Writer out(path, context);
  out.text("# Diffuse reflectance of the cabin's surfaces: Kd linear, map_Kd sRGB-encoded\n");
  for (const SurfaceMaterial& m : mesh.materials) {
    out.text("newmtl ").text(m.name).text("\nKd");
    for (int k = 0; k < 3; ++k) out.text(" ").number(m.diffuse[k]);
    if (!m.texture_file.empty()) out.text("\nmap_Kd ").text(m.texture_file);
    out.text("\n");
  }
  return out.finish(path);
}

atlas::Status write_obj(const fs::path& path, const Mesh& mesh, bool y_up,
                        const atlas::Context& context) {
  atlas::AtomicFiles files;
  const fs::path library = fs::path(path).replace_extension(".mtl");
  const fs::path target = files.path_for(path);
  Writer out(target, context);
  // atlas-play opens scenes of which a comment says that "the z axis points up" so.
  out.text("# Aircraft cabin in metres; the ")
      .text(y_up ? "y" : "z")
      .text(
          " axis points up. v x y z r g b: illuminance in lux,\n"
          "# linear RGB, not yet multiplied by the diffuse reflectance\nmtllib ");
  out.text(library.filename().string()).text("\n");
  for (std::size_t i = 0; i < mesh.vertices.size(); ++i) {
    const glm::vec3 p = turned(mesh.vertices[i].position, y_up), e = total_light(mesh, i);
    out.text("v");
    for (int k = 0; k < 3; ++k) out.text(" ").number(p[k]);
    for (int k = 0; k < 3; ++k) out.text(" ").number(e[k]);
    out.text("\n");
  }
  for (const glm::vec2& uv : mesh.texcoords)
    out.text("vt ").number(uv.x).text(" ").number(uv.y).text("\n");
  int object = -1, material = -1;
  for (const Triangle& t : mesh.triangles) {
    if (t.object != object) out.text("o ").text(mesh.objects[object = t.object]).text("\n");
    if (t.material != material)
      out.text("usemtl ").text(mesh.materials[material = t.material].name).text("\n");
    out.text("f");
    for (int k = 0; k < 3; ++k)
      out.text(" ").number(t.vertex[k] + 1).text("/").number(t.texcoord[k] + 1);
    out.text("\n");
  }
  for (const atlas::Status& status :
       {out.finish(path), write_mtl(files.path_for(library), mesh, context),
        write_textures(path.parent_path(), mesh, files, context)})
    if (!status.ok()) return status;
  return files.commit();
}

atlas::Status write_ply(const fs::path& path, const Mesh& mesh, bool y_up,
                        const atlas::Context& context) {
  atlas::AtomicFiles files;
  const fs::path target = files.path_for(path);
  Writer out(target, context);
  out.text(
      "ply\nformat binary_little_endian 1.0\ncomment aircraft cabin in metres; red, green, blue: "
      "illuminance in lux, linear\nelement vertex ");
  out.number(mesh.vertices.size());
  for (const char* name : {"x", "y", "z", "red", "green", "blue"})
    out.text("\nproperty float ").text(name);
  out.text("\nelement face ").number(mesh.triangles.size());
  out.text("\nproperty list uchar int vertex_indices\nend_header\n");
  for (std::size_t i = 0; i < mesh.vertices.size(); ++i) {
    const glm::vec3 p = turned(mesh.vertices[i].position, y_up), e = total_light(mesh, i);
    out.bytes(&p, sizeof p).bytes(&e, sizeof e);
  }
  for (const Triangle& t : mesh.triangles) {
    const std::uint8_t three = 3;
    out.bytes(&three, 1).bytes(t.vertex.data(), sizeof t.vertex);
  }
  const atlas::Status status = out.finish(path);
  return status.ok() ? files.commit() : status;
}

}  // namespace

// Defined in write_glb.cpp.
atlas::Status write_glb(const fs::path& path, const fs::path& target, const Mesh& mesh, bool y_up);

atlas::Status check_scene_path(const fs::path& path) {
  const std::string ending = path.extension().string();
  if (ending != ".obj" && ending != ".ply" && ending != ".glb")
    return {atlas::ErrorCode::bad_option,
            path.string() + ": unknown ending (use .obj, .ply or .glb)"};
  return atlas::check_writable(path);
}

atlas::Status write_scene(const fs::path& path, const Mesh& mesh, bool y_up,
                          const atlas::Context& context) {
  if (atlas::Status status = check_scene_path(path); !status.ok()) return status;
  const std::string ending = path.extension().string();
  if (ending == ".obj") return write_obj(path, mesh, y_up, context);
  if (ending == ".ply") return write_ply(path, mesh, y_up, context);
  atlas::AtomicFiles files;
  for (const atlas::Status& status : {write_glb(path, files.path_for(path), mesh, y_up),
                                      write_textures(path.parent_path(), mesh, files, context)})
    if (!status.ok()) return status;
  return files.commit();
}

}  // namespace cabin
