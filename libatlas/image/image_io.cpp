#include "libatlas/image/image_io.h"

#include <dlfcn.h>
#include <fmt/format.h>

#include <cstddef>
#include <memory>
#include <system_error>
#include <utility>
#include <vector>

#include "libatlas/core/srgb.h"
#include "libatlas/image/image_files.h"

namespace atlas {
namespace {

namespace fs = std::filesystem;

// Returns the file that this code was linked into: a shared library or the program.
fs::path own_file() {
  Dl_info own{};
  const bool known = dladdr(reinterpret_cast<const void*>(&own_file), &own) != 0 && own.dli_fname;
  return known ? fs::path(own.dli_fname) : fs::path();
}

// Returns the folder where the module was built if `file` lies in the same build tree, else an
// empty path, so that an installed program never loads a module that a builder has left. The tree
// is found from the file on, so that no path of the builder's machine becomes part of the library.
fs::path built_folder(const fs::path& file) {
  std::error_code none;
  for (fs::path up = fs::canonical(file, none).parent_path(); up.has_relative_path();
       up = up.parent_path()) {
    if (fs::exists(up / "CMakeCache.txt", none)) return up / LIBATLAS_BUILT_IN;
  }
  return {};
}

// Returns where the system looks for the libraries of the program, which its run path names, too.
// dlopen() by itself would look along the run path of the code that calls it, and with a sanitizer
// that is the sanitizer.
std::vector<fs::path> library_folders() {
  std::vector<fs::path> folders;
  void* const program = dlopen(nullptr, RTLD_LAZY);
  Dl_serinfo size{};
  if (!program || dlinfo(program, RTLD_DI_SERINFOSIZE, &size) != 0) return folders;
  const auto words = size.dls_size / sizeof(std::max_align_t) + 1;
  const auto room = std::make_unique<std::max_align_t[]>(words);
  auto* const found = reinterpret_cast<Dl_serinfo*>(room.get());
  if (dlinfo(program, RTLD_DI_SERINFOSIZE, found) != 0 ||
      dlinfo(program, RTLD_DI_SERINFO, found) != 0)
    return folders;
  for (unsigned i = 0; i < found->dls_cnt; ++i)
    folders.emplace_back(found->dls_serpath[i].dls_name);
  return folders;
}

// Returns the folders where the module may be: beside the file that this code was linked into and
// beside the program; in the lib/ next to the folder of either; where the module was built; where
// it was to be installed; where the program's libraries are.
std::vector<fs::path> module_folders() {
  std::error_code none;
  std::vector<fs::path> folders;
  const std::vector<fs::path> files = {own_file(), fs::read_symlink("/proc/self/exe", none)};
  for (const fs::path& file : files) {
    if (!file.has_parent_path()) continue;
    folders.push_back(file.parent_path());
    folders.push_back(file.parent_path() / ".." / LIBATLAS_LIBRARY_FOLDER);
  }
  for (const fs::path& file : files)
    if (const fs::path built = built_folder(file); !built.empty()) folders.push_back(built);
  folders.push_back(LIBATLAS_INSTALL_FOLDER);
  for (fs::path& folder : library_folders()) folders.push_back(std::move(folder));
  return folders;
}

struct Module {
  const ImageFiles* functions = nullptr;
  std::string why_not;
};

Module failure() {
  const char* reason = dlerror();
  // What the loader says if memory is limited.
  const std::string_view said = reason ? reason : "";
  for (const std::string_view short_of_memory :
       {"failed to map segment", "annot allocate memory", "cannot map"}) {
    if (said.find(short_of_memory) == std::string_view::npos) continue;
    return {nullptr, fmt::format("not enough memory to load {} ({})", LIBATLAS_IMAGE_MODULE, said)};
  }
  return {nullptr,
          fmt::format("image files need {}, which belongs beside the program or into its ../{}: {}",
                      LIBATLAS_IMAGE_MODULE, LIBATLAS_LIBRARY_FOLDER, reason ? reason : "damaged")};
}

Module load() {
  void* handle = nullptr;
  std::error_code none;
  for (const fs::path& folder : module_folders()) {
    const fs::path file = fs::absolute(folder / LIBATLAS_IMAGE_MODULE, none);
    if (handle || !fs::exists(file, none)) continue;
    handle = dlopen(file.c_str(), RTLD_NOW | RTLD_LOCAL);
    if (!handle) return failure();
  }
  // Otherwise the system searches its list of libraries, too.
  if (!handle) handle = dlopen(LIBATLAS_IMAGE_MODULE, RTLD_NOW | RTLD_LOCAL);
  void* entry = handle ? dlsym(handle, "libatlas_image_files") : nullptr;
  if (!entry) return failure();
  const ImageFiles* files = reinterpret_cast<decltype(&libatlas_image_files)>(entry)();
  if (files->mark == image_files_mark()) return {files, {}};
  Dl_info where{};
  const bool known = dladdr(entry, &where) != 0 && where.dli_fname;
  return {nullptr,
          fmt::format("image files need the {} that was built with this program; {} is "
                      "of another build (install both from one)",
                      LIBATLAS_IMAGE_MODULE, known ? where.dli_fname : "the one that was found")};
}

// Returns the module. It is loaded once and never unloaded, because OpenImageIO has threads.
const Module& module() {
  static const Module loaded = load();
  return loaded;
}

// Calls the module's function, or returns the reason why there is no module.
template <class Function, class... Arguments>
auto call(Function ImageFiles::*function, const std::string& name, Arguments&&... arguments)
    -> decltype((std::declval<ImageFiles>().*function)(arguments...)) {
  const Module& files = module();
  if (!files.functions) {
    return Status(ErrorCode::unsupported, fmt::format("{}: {}", name, files.why_not));
  }
  return (files.functions->*function)(std::forward<Arguments>(arguments)...);
}

// Refuses an image whose sides or channels are out of range, or whose texels are not as many as
// these say: the module would read past the end of a shorter one.
template <class T>
Status check_image(const fs::path& path, const Image<T>& image, int most_channels) {
  const std::string sizes = fmt::format("{}: the image is {} x {} with {} channels", path.string(),
                                        image.width, image.height, image.channels);
  if (image.width < 1 || image.height < 1 || image.channels < 1 || image.channels > most_channels)
    return {ErrorCode::bad_input,
            fmt::format("{} (sides of at least 1, 1 to {} channels)", sizes, most_channels)};
  if (!image.whole())
    return {ErrorCode::bad_input,
            fmt::format("{}, but holds {} values", sizes, image.texels.size())};
  return {};
}

// Returns whether clipping changes a linear value by more than a step of eight bits.
bool clips(float linear) {
  constexpr float kStep = 1 / 255.0f;
  return !(linear >= -kStep / 12.92f && linear <= 1 + kStep);
}

TextureImage encoded(const ImageF& linear) {
  TextureImage texture{Image8(linear.width, linear.height, linear.channels)};
  const int n = linear.channels, colours = n == 2 || n == 4 ? n - 1 : n;
  for (std::size_t i = 0; i < linear.texels.size(); ++i) {
    const float value = linear.texels[i];
    const bool alpha = int(i % std::size_t(n)) >= colours;
    texture.image.texels[i] = alpha ? quantize8(value) : srgb_encode8(value);
    texture.clipped |= !alpha && clips(value);
  }
  return texture;
}

bool holds_floats(const fs::path& path) {
  const Module& files = module();
  return files.functions && files.functions->holds_floats(path);
}

}  // namespace

Status check_image_module(const std::string& name) {
  const Module& files = module();
  if (files.functions) return {};
  return {ErrorCode::unsupported, fmt::format("{}: {}", name, files.why_not)};
}

Result<Image8> read_image8(const fs::path& path) {
  return call(&ImageFiles::read_image8, path.string(), path);
}

Result<Image8> decode_image8(std::span<const std::uint8_t> bytes, const std::string& name) {
  return call(&ImageFiles::decode_image8, name, bytes, name);
}

Result<ImageF> read_image_float(const fs::path& path) {
  return call(&ImageFiles::read_image_float, path.string(), path);
}

Result<TextureImage> read_texture(const fs::path& path) {
  if (holds_floats(path)) {
    const Result<ImageF> linear = read_image_float(path);
    if (!linear.ok()) return linear.status();
    return encoded(*linear);
  }
  Result<Image8> image = read_image8(path);
  if (!image.ok()) return image.status();
  return TextureImage{std::move(*image)};
}

Status write_png(const fs::path& path, const Image8& image, const PngOptions& options) {
  if (options.compression < 0 || options.compression > 9)
    return {ErrorCode::bad_option, fmt::format("{}: compression {} is not a zlib level, 0 to 9",
                                               path.string(), options.compression)};
  if (Status s = check_image(path, image, 4); !s.ok()) return s;
  return call(&ImageFiles::write_png, path.string(), path, image, options);
}

Status write_exr(const fs::path& path, const ImageF& image) {
  if (Status s = check_image(path, image, 1024); !s.ok()) return s;
  return call(&ImageFiles::write_exr, path.string(), path, image);
}

}  // namespace atlas
