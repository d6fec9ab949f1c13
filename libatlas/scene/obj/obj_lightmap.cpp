#include "libatlas/scene/obj/obj_lightmap.h"

#include <string>
#include <utility>

#include "libatlas/files/parse_number.h"

namespace atlas {

std::optional<LightmapImages> lightmap_in_comment(std::string_view line) {
  constexpr std::string_view kBegin = "# lightmap: ", kImage = " (sRGB-encoded, ",
                             kWhite = "white is ", kMore = "), ", kLinear = " (linear)";
  while (!line.empty() && (line.back() == '\r' || line.back() == ' ')) line.remove_suffix(1);
  const std::size_t image = line.find(kImage);
  if (!line.starts_with(kBegin) || image == line.npos) return {};
  LightmapImages named;
  named.images.emplace_back(line.substr(kBegin.size(), image - kBegin.size()));
  line.remove_prefix(image + kImage.size());
  if (line.starts_with(kWhite)) {
    double white = 0;
    const char* const end = line.data() + line.size();
    if (parse_number(line.data() + kWhite.size(), end, white) == nullptr) return {};
    if (!(float(white) > 0 && white <= double(kMostLight))) return {};
    named.white = float(white);
  }
  const std::size_t more = line.find(kMore);
  if (more == line.npos || !line.ends_with(kLinear)) return named;
  line.remove_prefix(more + kMore.size());
  named.linear.emplace_back(line.substr(0, line.size() - kLinear.size()));
  return named;
}

void read_obj_lightmap(const LightmapImages& named, SceneBuilder& builder, const Context& context) {
  auto pages = read_lightmap(named, {true}, builder, context);
  if (!pages.ok()) {
    builder.defects.add(DefectKind::lightmap_unusable, [&] { return pages.status().message(); });
    return;
  }
  builder.light_page = std::move(pages->front());
  builder.light_white = named.white.value_or(0.0f);
}

}  // namespace atlas
