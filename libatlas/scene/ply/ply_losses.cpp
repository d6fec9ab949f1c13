#include "libatlas/scene/ply/ply_losses.h"

#include <algorithm>

namespace atlas {

PlyLosses::PlyLosses(const PlyElement& element, std::span<const int> read, const char* plural)
    : element_(element), plural_(plural) {
  for (std::size_t i = 0; i < element.properties.size(); ++i) {
    const PlyProperty& property = element.properties[i];
    if (std::find(read.begin(), read.end(), int(i)) != read.end()) continue;
    unread_.push_back({i, 0, property.name == "alpha" && !property.list,
                       property.type == PlyType::u8    ? 255.0
                       : property.type == PlyType::u16 ? 65535.0
                                                       : 1.0});
  }
}

void PlyLosses::add_to(LossCounts& counts) const {
  for (const Property& p : unread_) {
    if (p.count == 0) continue;
    counts[std::string("values of ") + plural_ + ": " + element_.properties[p.index].name] +=
        p.count;
  }
}

}  // namespace atlas
