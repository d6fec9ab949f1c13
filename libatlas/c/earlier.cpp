#include "libatlas/c/earlier.h"

#include <string>

#include "libatlas/c/structs.h"
#include "libatlas/unwrap/strided.h"

namespace atlas::c {
namespace {

const char* const kName = "libatlas_earlier_uvs";

// Copies an array without its gaps. `member` names it in messages.
template <class Span, class T>
Status copy(const char* member, const Span& from, std::vector<T>& to) {
  if (Status s = check_span(std::string(kName) + ": " + member, from); !s.ok()) return s;
  to.reserve(from.count);
  for (std::size_t i = 0; i < from.count; ++i) to.push_back(from[i]);
  return {};
}

}  // namespace

Status EarlierArrays::take(const libatlas_earlier_uvs& given) {
  libatlas_earlier_uvs own;
  if (Status s = take_struct(&given, kName, own); !s.ok()) return s;
  const std::size_t corners = own.index_count;
  const StridedSpan<Vec3f> positions{own.positions, own.position_count, own.position_stride};
  if (Status s = copy("positions", positions, positions_); !s.ok()) return s;
  const IndexSpan indices{own.indices, corners, own.index_bytes};
  if (Status s = copy("indices", indices, indices_); !s.ok()) return s;
  const StridedSpan<Vec2f> uvs{own.uvs, own.uv_count, own.uv_stride};
  if (Status s = copy("uvs", uvs, uvs_); !s.ok()) return s;
  if (own.uv_indices) {
    const IndexSpan uv_indices{own.uv_indices, corners, own.index_bytes};
    if (Status s = copy("uv indices", uv_indices, uv_indices_); !s.ok()) return s;
  }
  if (own.page_count > 0 && !own.pages) return null("libatlas_earlier_uvs: pages");
  for (std::size_t p = 0; p < own.page_count; ++p)
    pages_.push_back({own.pages[p].width, own.pages[p].height});
  earlier_ = {positions_, indices_, uvs_, uv_indices_, {}, pages_, {}, own.tolerance};
  if (own.objects) earlier_.objects = {own.objects, own.position_count};
  if (own.triangle_page) earlier_.triangle_page = {own.triangle_page, corners / 3};
  return {};
}

}  // namespace atlas::c

libatlas_status libatlas_earlier_uvs_init(libatlas_earlier_uvs* earlier, size_t size) {
  libatlas_earlier_uvs defaults{};
  defaults.index_bytes = 4;
  defaults.tolerance = atlas::EarlierUvs{}.tolerance;
  return atlas::c::set_defaults(earlier, size, defaults);
}
