// A layout that grows and changes: sprites or charts come and go one at a time.
#pragma once

#include <cstdint>
#include <memory>

#include "libatlas/pack/pack.h"

namespace atlas {

// Pages of fixed size that rectangles are put into one by one, taken out of, and packed anew.
// Uses options.page (both sides given), max_pages, allow_rotation, padding, border, alignment,
// preset (for repack) and pinned. Ids count up from 0 in the order of insertion and are never
// used twice. Not thread-safe.
class AtlasLayout {
 public:
  // Errors: bad_option (as for pack_rects; also: an open page).
  static Result<AtlasLayout> create(const PackOptions& options);
  AtlasLayout(AtlasLayout&&) noexcept;
  AtlasLayout& operator=(AtlasLayout&&) noexcept;
  ~AtlasLayout();

  // Puts an item into the first page with room, at its lowest free place; nothing else moves.
  // Sides of 0 take no room and get the corner of page 0.
  // Errors: bad_input (a negative side), no_solution (larger than a page, or all pages are full).
  Result<std::uint32_t> insert(Extent item);

  // Frees an item's place for later ones. False if there is no such item (any more).
  bool remove(std::uint32_t id);

  // Packs all present items anew with the preset; ids stay, places change. If the fresh layout
  // would need more pages than max_pages, nothing changes and no_solution is returned.
  Status repack(const Context& context);

  std::size_t size() const;  // items present
  bool contains(std::uint32_t id) const;
  Extent extent(std::uint32_t id) const;        // of an item present
  Placement placement(std::uint32_t id) const;  // of an item present
  std::uint32_t page_count() const;             // highest page in use, plus one
  double utilization() const;                   // area of the items / area of the pages in use

 private:
  struct State;
  explicit AtlasLayout(std::unique_ptr<State> state);
  std::unique_ptr<State> state_;
};

}  // namespace atlas
