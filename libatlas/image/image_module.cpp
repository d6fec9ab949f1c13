#include "libatlas/image/image_module.h"

#include <dlfcn.h>
#include <fmt/format.h>

#include <cstddef>
#include <filesystem>
#include <memory>
#include <string_view>
#include <system_error>
#include <thread>
#include <utility>
#include <vector>

#include "libatlas/core/granted_threads.h"

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

ImageModule failure() {
  const char* reason = dlerror();
  // What the loader says if memory is limited.
  const std::string_view said = reason ? reason : "";
  for (const std::string_view short_of_memory :
       {"failed to map segment", "annot allocate memory", "cannot map"}) {
    if (said.find(short_of_memory) == std::string_view::npos) continue;
    return {nullptr, fmt::format("not enough memory to load {} ({})", LIBATLAS_IMAGE_MODULE, said)};
  }
  return {nullptr,
          fmt::format("image files other than PNG and JPEG need {}, which belongs beside the "
                      "program or into its ../{}: {}",
                      LIBATLAS_IMAGE_MODULE, LIBATLAS_LIBRARY_FOLDER, reason ? reason : "damaged")};
}

// Some of the module's libraries start threads when they are loaded, four on a machine of two
// cores, and end the program if they cannot.
bool threads_can_start() {
  const std::size_t count = 6 + std::thread::hardware_concurrency();
  return startable_threads(count) == count;
}

ImageModule load() {
  if (!threads_can_start())
    return {nullptr, fmt::format("image files other than PNG and JPEG need {}, which starts "
                                 "more threads than the system grants (raise the limit of "
                                 "processes, ulimit -u)",
                                 LIBATLAS_IMAGE_MODULE)};
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
  return {
      nullptr,
      fmt::format(
          "image files other than PNG and JPEG need the {} that was built with this program; {} is "
          "of another build (install both from one)",
          LIBATLAS_IMAGE_MODULE, known ? where.dli_fname : "the one that was found")};
}

}  // namespace

const ImageModule& image_module() {
  static const ImageModule loaded = load();
  return loaded;
}

}  // namespace atlas
