// A layout that changes over time: sprites or charts are inserted and removed one at a time.
#pragma once

#include <cstdint>
#include <memory>

#include "libatlas/pack/pack.h"

namespace atlas {

// Pages of fixed size into which rectangles are inserted one by one, from which they are removed,
// and which can be packed anew. Uses options.page (both sides must be given), max_pages,
// allow_rotation, padding, border, alignment, preset (for repack) and pinned. Ids count up from 0
// in the order of insertion and are never reused. Inserting or removing an item takes time in
// proportion to the items of its page at most. Not thread-safe.
class AtlasLayout {
 public:
  // Errors: bad_option (as for pack_rects, and if a side of the page is open).
  static Result<AtlasLayout> create(const PackOptions& options);
  AtlasLayout(AtlasLayout&&) noexcept;
  AtlasLayout& operator=(AtlasLayout&&) noexcept;
  ~AtlasLayout();

  // Puts an item into the first page that has room, at its lowest free place. No other item moves.
  // An item with a side of 0 takes no space and gets the corner of page 0. Returns the item's id.
  // Errors: bad_input (a negative side), no_solution (the item is larger than a page, or all pages
  // are full).
  Result<std::uint32_t> insert(Extent item);

  // Removes an item and frees its place for later ones. Returns false if there is no item with this
  // id (any more).
  bool remove(std::uint32_t id);

  // Packs all present items anew with the preset. Ids stay the same, places change. If the new
  // layout would need more pages than max_pages, nothing changes and the error is no_solution.
  // Other errors are those of pack_rects.
  Status repack(const Context& context);

  std::size_t size() const;  // number of items present
  bool contains(std::uint32_t id) const;
  Extent extent(std::uint32_t id) const;        // of an item that is present
  Placement placement(std::uint32_t id) const;  // of an item that is present
  std::uint32_t page_count() const;             // the highest page in use, plus one
  double utilization() const;  // area of the items / area of the first page_count() pages

 private:
  struct State;
  explicit AtlasLayout(std::unique_ptr<State> state);
  std::unique_ptr<State> state_;
};

}  // namespace atlas
