// Internal: a mesh with the uvs of its earlier state, from which its charts are made and laid out.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "libatlas/charts/charts.h"
#include "libatlas/core/context.h"
#include "libatlas/core/status.h"
#include "libatlas/unwrap/like.h"
#include "libatlas/unwrap/part_gaps.h"

namespace atlas {

// Errors: bad_input for arrays of the wrong length, an index out of range, a position that is not
// finite, or pages of no usable size; bad_option for the tolerance. `who` begins the messages.
Status check_earlier(const EarlierUvs& earlier, const std::string& who);

class LikeMesh {
 public:
  struct Options {
    double max_stretch = 1.25;  // ChartOptions::max_stretch
    std::int32_t padding = 2;   // texels free around each chart
  };
  // Finds what stays. Everything referred to must outlive the object; `earlier` was checked.
  LikeMesh(const MeshView& mesh, const EarlierUvs& earlier, const Options& options);

  // Why nothing stays, in one line for users; empty if something does.
  const std::string& nothing() const { return nothing_; }

  // For make_charts(): the mesh with the uvs that stay as its texcoords.
  MeshView view() const { return view_; }
  ChartOptions chart_options(const ChartOptions& asked) const;

  // Lays out what make_charts() made of view(): charts of uvs that stay where these lie, and the
  // others in the free room, at the density of the former. Of the options, pages, padding,
  // alignment, square and allow_rotation count. With `apart`, gaps between parts of the other
  // charts are opened first. Errors: those of pack_beside().
  Result<PagesOfParts> lay_out(const LayoutOptions& options, bool apart, ChartSet& charts,
                               const Context& context) const;

 private:
  class Keeper;
  void write_texcoords(const EarlierUvs& earlier);

  MeshView view_;
  double max_stretch_;
  std::vector<Vec2f> texcoords_ = {};
  std::vector<std::uint32_t> texcoord_indices_ = {};
  std::vector<std::uint8_t> seams_ = {};
  double aspect_ = 1;
  std::vector<Extent> pages_ = {};
  // One per corner of the mesh; its uv in texels of the page.
  std::vector<Vec2d> texels_ = {};
  // One per triangle: its earlier chart or kNoIndex, whether it is unchanged, and its page.
  std::vector<std::uint32_t> chart_ = {}, page_ = {};
  std::vector<std::uint8_t> same_ = {};
  std::vector<std::uint32_t> chart_triangles_ = {};  // one per earlier chart: how many it had
  std::string nothing_ = {};
};

}  // namespace atlas
