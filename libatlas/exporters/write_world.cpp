#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <string_view>

#include "libatlas/exporters/world.h"
#include "libatlas/files/file_extension.h"
#include "libatlas/files/safe_file_name.h"

namespace atlas {
namespace {

using Writer = Result<WorldFile> (*)(const World&, const std::filesystem::path&, AtomicFiles&,
                                     const Context&);

struct Format {
  std::string_view extension;
  Writer write;
  bool viewpoint;                                                 // holds World::viewpoint
  bool scene;                                                     // can keep World::scene
  bool embeds;                                                    // holds the pages itself
  bool compressed;                                                // see holds_compressed()
  std::filesystem::path (*beside)(const std::filesystem::path&);  // see file_beside()
};

std::filesystem::path nothing_beside(const std::filesystem::path&) {
  return {};
}

std::filesystem::path materials_beside(const std::filesystem::path& path) {
  return safely_beside(path, ".mtl");
}

std::filesystem::path buffer_beside(const std::filesystem::path& path) {
  return std::filesystem::path(path).replace_extension(".bin");
}

// A new format is one more line here.
constexpr std::array<Format, 6> kFormats{
    {{".wrl", write_vrml, true, false, false, false, nothing_beside},
     {".wrz", write_vrml, true, false, false, false, nothing_beside},
     {".obj", write_obj, false, true, false, false, materials_beside},
     {".gltf", write_gltf, true, true, false, true, buffer_beside},
     {".glb", write_gltf, true, true, true, true, nothing_beside},
     {".html", write_html, true, false, true, true, nothing_beside}}};

const Format* format_of(const std::filesystem::path& path) {
  const std::string extension = lower_extension(path);
  const auto found = std::find_if(kFormats.begin(), kFormats.end(),
                                  [&](const Format& f) { return f.extension == extension; });
  return found == kFormats.end() ? nullptr : found;
}

}  // namespace

Status check_world_extension(const std::filesystem::path& path) {
  if (format_of(path) != nullptr) return {};
  std::string names;
  for (std::size_t i = 0; i < kFormats.size(); ++i) {
    names += i == 0 ? "" : i + 1 == kFormats.size() ? " or " : ", ";
    names += kFormats[i].extension;
  }
  return {ErrorCode::bad_option,
          fmt::format("{}: the target must end in {}",
                      path.empty() ? "no name given" : path.string(), names)};
}

bool holds_viewpoint(const std::filesystem::path& path) {
  const Format* format = format_of(path);
  return format != nullptr && format->viewpoint;
}

bool holds_scene(const std::filesystem::path& path) {
  const Format* format = format_of(path);
  return format != nullptr && format->scene;
}

bool holds_compressed(const std::filesystem::path& path) {
  const Format* format = format_of(path);
  return format != nullptr && format->compressed;
}

bool embeds_images(const std::filesystem::path& path) {
  const Format* format = format_of(path);
  return format != nullptr && format->embeds;
}

bool holds_light(const std::filesystem::path& path) {
  return lower_extension(path) == ".html";
}

std::filesystem::path file_beside(const std::filesystem::path& path) {
  const Format* format = format_of(path);
  return format != nullptr ? format->beside(path) : std::filesystem::path();
}

Result<WorldFile> write_world(const World& world, const std::filesystem::path& path,
                              AtomicFiles& files, const Context& context) {
  if (Status s = check_world_extension(path); !s.ok()) return s;
  return format_of(path)->write(world, path, files, context);
}

}  // namespace atlas
