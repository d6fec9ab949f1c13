#include <fmt/format.h>

#include <algorithm>
#include <vector>

#include "libatlas/c/objects.h"
#include "libatlas/c/structs.h"
#include "libatlas/unwrap/transfer.h"

namespace atlas::c {
namespace {

libatlas_transfer_options options_to_c(const TransferOptions& options) {
  libatlas_transfer_options c{};
  c.page = options.page;
  c.shifts = options.shifts;
  return c;
}

Status check_room(const libatlas_unwrapped& unwrapped, std::uint32_t page, std::size_t count) {
  if (page >= unwrapped.pages.size()) return {};  // transfer() says so
  const libatlas_extent side = unwrapped.pages[page];
  const std::size_t texels = std::size_t(side.width) * std::size_t(side.height);
  if (count == texels) return {};
  return {ErrorCode::bad_input,
          fmt::format("transfer: room for {} texels, but page {} has {}", count, page, texels)};
}

}  // namespace
}  // namespace atlas::c

libatlas_status libatlas_transfer_options_init(libatlas_transfer_options* options, size_t size) {
  return atlas::c::set_defaults(options, size, atlas::c::options_to_c(atlas::TransferOptions{}));
}

libatlas_status libatlas_transfer(libatlas_context* context, const libatlas_unwrapped* unwrapped,
                                  const float* values, size_t value_count,
                                  const libatlas_transfer_options* options, float* texels,
                                  size_t texel_count) {
  return atlas::c::run_call(context, [&]() -> atlas::Status {
    if (!unwrapped) return atlas::c::null("unwrapped");
    if (!values) return atlas::c::null("values");
    if (!texels) return atlas::c::null("texels");
    libatlas_transfer_options own = atlas::c::options_to_c(atlas::TransferOptions{});
    if (options) {
      if (auto s = atlas::c::take_struct(options, "libatlas_transfer_options", own); !s.ok())
        return s;
    }
    if (auto s = atlas::c::check_room(*unwrapped, own.page, texel_count); !s.ok()) return s;
    std::vector<atlas::Vec3f> read(value_count);
    for (std::size_t i = 0; i < value_count; ++i)
      read[i] = {values[3 * i], values[3 * i + 1], values[3 * i + 2]};
    const auto image = atlas::transfer(unwrapped->atlas, read,
                                       {.page = own.page, .shifts = own.shifts}, context->context);
    if (!image.ok()) return image.status();
    std::copy(image->texels.begin(), image->texels.end(), texels);
    return {};
  });
}
