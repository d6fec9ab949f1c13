// Internal: the strips that are packed to find the smallest page for items that all go onto one.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "libatlas/pack/rectangles/problem.h"

namespace atlas::pack {

// A strip of this width, in cells, that is packed as short as possible. An upright strip is open
// upwards: its width is that of the page. A lying one is open to the right: its width is the page's
// height.
struct Strip {
  std::int32_t width = 1;
  bool lying = false;
  bool operator==(const Strip&) const = default;
};

// The packing problem of a strip. The engines know upright strips only, so a lying strip is turned
// by exchanging x and y.
class StripProblem {
 public:
  StripProblem(const Problem& problem, Strip strip, std::int32_t length);
  StripProblem(const StripProblem&) = delete;  // the problem points at the items

  const Problem& problem() const { return problem_; }
  // Turns a layout of problem() back, and counts the items that it does not place.
  void turn_back(Layout& layout) const;

 private:
  Problem problem_;
  bool lying_;
  std::vector<Extent> items_;
};

// Adds a strip to the list, unless it is in it.
void add_strip(Strip strip, std::vector<Strip>& strips);

// Adds the strips to search. Mostly their widths are around that of the square that the items would
// fill; there are fewer if the list is not empty. If an item is longer than this square's side, the
// page has to be as long as that item; so it is narrower than the square, and a strip of just that
// length is searched as well. If pages are rounded up to powers of two, the widths are the sides
// that pages can have.
void add_usual_strips(const Problem& problem, const PackOptions& options,
                      std::vector<Strip>& strips);

// Returns about this many strips, from as narrow as the items allow to as wide as all items side by
// side.
std::vector<Strip> strips_of_all_widths(const Problem& problem, std::size_t count);

}  // namespace atlas::pack
