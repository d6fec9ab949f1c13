#include "libatlas/exporters/writing/page_sides.h"

#include <algorithm>

namespace atlas {

PageSides::PageSides(const Page& page) {
  if (page.indices.empty()) return;
  const std::vector<bool>& front = page.one_sided;
  const auto count = std::size_t(std::count(front.begin(), front.end(), true));
  if (count == 0 || count == page.indices.size() / 3) {
    sides_.push_back({page.indices, page.uv_indices, count > 0});
    return;
  }
  for (std::size_t k = 0; k < page.indices.size(); ++k) {
    indices_[front[k / 3]].push_back(page.indices[k]);
    uv_indices_[front[k / 3]].push_back(page.uv_indices[k]);
  }
  for (const bool one_sided : {false, true})
    sides_.push_back({indices_[one_sided], uv_indices_[one_sided], one_sided});
}

}  // namespace atlas
