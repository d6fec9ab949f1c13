#include "libatlas/unwrap/check_pages.h"

#include <fmt/format.h>

#include <bit>
#include <cstdint>

namespace atlas {

Status check_pages(const std::string& call, const PageOptions& options) {
  const auto bad = [&](const std::string& text) {
    return Status(ErrorCode::bad_option, call + ": " + text);
  };
  if (options.pages < 1) return bad("pages is 0 (ask for at least one)");
  if (options.page_size < 64 || options.page_size > 16384)
    return bad(fmt::format("page_size is {} (64 to 16384 texels)", options.page_size));
  const bool powers = options.square || options.pages > 1;
  if (powers && !std::has_single_bit(std::uint32_t(options.page_size)))
    return bad(fmt::format("page_size is {} (a power of two for square or several pages)",
                           options.page_size));
  if (options.padding < 0 || options.padding > options.page_size / 4)
    return bad(fmt::format("padding is {} (0 to a quarter of page_size)", options.padding));
  if (options.alignment < 1 || options.alignment > options.page_size / 4)
    return bad(fmt::format("alignment is {} (1 to a quarter of page_size)", options.alignment));
  if (powers && !std::has_single_bit(std::uint32_t(options.alignment)))
    return bad(fmt::format("alignment is {} (a power of two for square or several pages)",
                           options.alignment));
  return {};
}

}  // namespace atlas
