#include "libatlas/scene/obj/obj_names.h"

#include <fmt/format.h>

namespace atlas {

std::string one_line(std::string text) {
  for (char& c : text) {
    if (c == '\n' || c == '\r' || c == '\\') c = ' ';
  }
  return text;
}

std::string obj_name(const std::string& name) {
  std::string result = one_line(name);
  for (std::size_t i = 0; i < result.size(); ++i) {
    const bool behind_blank = i == 0 || result[i - 1] == ' ' || result[i - 1] == '\t';
    if (result[i] == '#' && behind_blank) result[i] = '_';
  }
  const auto first = result.find_first_not_of(" \t");
  if (first == std::string::npos) return {};
  return result.substr(first, result.find_last_not_of(" \t") + 1 - first);
}

std::string obj_object_line(const Scene& scene, std::uint32_t object) {
  const std::string name =
      object < scene.object_names.size() ? obj_name(scene.object_names[object]) : "";
  if (!name.empty()) return "o " + name + "\n";
  return object == 0 ? "" : fmt::format("o object{}\n", object);
}

}  // namespace atlas
