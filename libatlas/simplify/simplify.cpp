#include "libatlas/simplify/simplify.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <numbers>
#include <optional>

#include "libatlas/charts/chart_set_check.h"
#include "libatlas/core/glm_bridge.h"
#include "libatlas/core/parallel.h"
#include "libatlas/simplify/border_chains.h"
#include "libatlas/simplify/chain_simplifier.h"
#include "libatlas/simplify/chart_simplifier.h"
#include "libatlas/simplify/fine_chart.h"

namespace atlas {
namespace {

using simplify::BorderChains;
using simplify::ChainSimplifier;
using simplify::ChartSimplifier;
using simplify::FineChart;
using simplify::Geometry;
using simplify::SlipLimits;

constexpr double kRadians = std::numbers::pi / 180;

Status bad_input(std::string message) {
  return {ErrorCode::bad_input, std::move(message)};
}

Status check_options(const SimplifyOptions& options) {
  const auto bad = [](std::string_view name, double value, std::string_view range) {
    return Status(ErrorCode::bad_option,
                  fmt::format("simplify: {} = {} (give {})", name, value, range));
  };
  if (!(options.max_slip_texels > 0) || !std::isfinite(options.max_slip_texels)) {
    return bad("max_slip_texels", options.max_slip_texels, "a number > 0");
  }
  if (!(options.max_border_slip_texels > 0) || !std::isfinite(options.max_border_slip_texels)) {
    return bad("max_border_slip_texels", options.max_border_slip_texels, "a number > 0");
  }
  if (!(options.max_turn_degrees > 0 && options.max_turn_degrees < 90)) {
    return bad("max_turn_degrees", options.max_turn_degrees, "an angle between 0 and 90");
  }
  return {};
}

Status check_input(const SimplifyInput& input) {
  const auto& [mesh, charts, texels_per_unit] = input;
  if (texels_per_unit.size() != charts.charts.size()) {
    return bad_input(fmt::format("simplify: {} texel densities for {} charts",
                                 texels_per_unit.size(), charts.charts.size()));
  }
  for (std::size_t c = 0; c < texels_per_unit.size(); ++c) {
    if (!(texels_per_unit[c] > 0) || !std::isfinite(texels_per_unit[c])) {
      return bad_input(
          fmt::format("simplify: chart {} has {} texels a unit", c, texels_per_unit[c]));
    }
  }
  return check_chart_set(mesh, charts, "simplify");
}

// Twice the areas of a triangle in space and in uv.
struct Areas {
  double space = 0, uv = 0;
};

Areas areas_of(const Geometry& geometry, const std::uint32_t (&uv)[3]) {
  const glm::dvec3 p = to_dvec(geometry.position(uv[0]));
  const glm::dvec2 u = to_glm(geometry.uv(uv[0]));
  const glm::dvec2 a = to_glm(geometry.uv(uv[1])) - u, b = to_glm(geometry.uv(uv[2])) - u;
  return {glm::length(glm::cross(to_dvec(geometry.position(uv[1])) - p,
                                 to_dvec(geometry.position(uv[2])) - p)),
          a.x * b.y - a.y * b.x};
}

// One run of the simplification: it builds the fine charts, finds their borders, and then collapses
// vertices in rounds of rising cost.
class Run {
 public:
  Run(const Geometry& geometry, std::span<const double> texels_per_unit,
      const SimplifyOptions& options, const Context& context)
      : geometry_(geometry), density_(texels_per_unit), options_(options), context_(context) {}

  Result<SimplifiedMesh> operator()();

 private:
  void build_charts();
  void build_simplifiers();
  void rounds();
  void collect();

  const Geometry& geometry_;
  std::span<const double> density_;
  const SimplifyOptions& options_;
  const Context& context_;
  std::vector<FineChart> fine_;
  std::vector<std::unique_ptr<ChartSimplifier>> charts_;
  std::optional<ChainSimplifier> chains_;
  SimplifiedMesh out_;
};

void Run::build_charts() {
  const ChartSet& set = *geometry_.charts;
  std::vector<bool> flipped(set.chart_triangles.size(), false);
  for (const std::uint32_t t : set.flipped_triangles) flipped[t] = true;
  fine_.resize(set.charts.size());
  parallel_for(context_, fine_.size(), 1, [&](std::size_t begin, std::size_t end) {
    for (std::size_t c = begin; c < end; ++c) {
      fine_[c] = build_fine_chart(geometry_, static_cast<std::uint32_t>(c), flipped);
    }
  });
}

void Run::build_simplifiers() {
  cut_shared_edges(geometry_, fine_, context_);
  BorderChains chains = find_border_chains(geometry_, fine_);
  const SlipLimits limits{options_.max_slip_texels, options_.max_turn_degrees * kRadians};
  charts_.resize(fine_.size());
  std::vector<std::uint64_t> degenerate(fine_.size(), 0);
  parallel_for(context_, fine_.size(), 1, [&](std::size_t begin, std::size_t end) {
    for (std::size_t c = begin; c < end; ++c) {
      const FineChart& fine = fine_[c];
      Areas sum;
      for (std::uint32_t t = 0; t < fine.triangle_count(); ++t) {
        const std::uint32_t uv[3] = {fine.vertex_uv[fine.corners[std::size_t{3} * t]],
                                     fine.vertex_uv[fine.corners[std::size_t{3} * t + 1]],
                                     fine.vertex_uv[fine.corners[std::size_t{3} * t + 2]]};
        const Areas areas = areas_of(geometry_, uv);
        degenerate[c] += !(areas.space > 0) || !(areas.uv > 0);
        sum.space += areas.space;
        sum.uv += areas.uv;
      }
      // The chart's scale from uv to the surface. It is about 1 unless relative densities differ.
      const double scale = sum.space > 0 && sum.uv > 0 ? std::sqrt(sum.space / sum.uv) : 1;
      charts_[c] = std::make_unique<ChartSimplifier>(geometry_, std::move(fine_[c]),
                                                     scale / density_[c], limits);
    }
  });
  if (context_.cancelled()) return;
  for (std::size_t c = 0; c < charts_.size(); ++c) {
    out_.degenerate_dropped += charts_[c]->fine().dropped;
    out_.degenerate_in += charts_[c]->fine().dropped + degenerate[c];
  }
  chains_.emplace(geometry_, charts_, std::move(chains), density_);
  chains_->set_limits(options_.max_slip_texels,
                      std::min(options_.max_border_slip_texels, options_.max_slip_texels));
}

// Each round collapses the inner vertices of all charts in parallel, and then border vertices up to
// the same cost. The next round does both up to a higher cost. Borders and insides are therefore
// simplified together, whatever the number of threads.
void Run::rounds() {
  constexpr double kGrowth = 3, kLargest = std::numeric_limits<float>::max();  // costs are floats
  constexpr double kUsualRounds = 24;
  double limit = 0;
  for (int round = 0; !context_.cancelled(); ++round) {
    parallel_for(context_, charts_.size(), 1, [&](std::size_t begin, std::size_t end) {
      for (std::size_t c = begin; c < end; ++c) charts_[c]->run(limit, context_);
    });
    for (std::size_t c = 0; c < charts_.size(); ++c) {
      chains_->wake(static_cast<std::uint32_t>(c), charts_[c]->take_touched());
    }
    chains_->run(limit, context_);
    double least = chains_->next_cost();
    for (const auto& chart : charts_) least = std::min(least, chart->next_cost());
    if (!(least <= kLargest)) break;
    limit = std::min(kLargest, std::max(limit * kGrowth, least * kGrowth));
    context_.report("simplify", std::min(0.99, round / kUsualRounds));
  }
}

void Run::collect() {
  std::vector<std::vector<ChartSimplifier::Triangle>> triangles(charts_.size());
  std::vector<SlipLimits> worst(charts_.size());
  parallel_for(context_, charts_.size(), 1, [&](std::size_t begin, std::size_t end) {
    for (std::size_t c = begin; c < end; ++c) {
      charts_[c]->collect(triangles[c]);
      worst[c] = charts_[c]->worst();
    }
  });
  out_.max_slip_texels = chains_->worst_slip();
  for (std::size_t c = 0; c < charts_.size(); ++c) {
    out_.max_slip_texels = std::max(out_.max_slip_texels, worst[c].slip);
    out_.max_turn_degrees = std::max(out_.max_turn_degrees, worst[c].turn / kRadians);
    const auto& vertex_uv = charts_[c]->fine().vertex_uv;
    for (const auto& t : triangles[c]) {
      const std::uint32_t uv[3] = {vertex_uv[t.vertices[0]], vertex_uv[t.vertices[1]],
                                   vertex_uv[t.vertices[2]]};
      const Areas areas = areas_of(geometry_, uv);
      out_.degenerate_kept += !(areas.space > 0) || !(areas.uv > 0);
      for (const std::uint32_t id : uv) {
        out_.uv_indices.push_back(id);
        out_.indices.push_back(geometry_.position_of(id));
      }
      out_.triangle_chart.push_back(static_cast<std::uint32_t>(c));
      out_.source_triangle.push_back(t.source);
    }
    triangles[c] = {};
  }
  // Bounds are stored as floats that are rounded up. They were checked against the options before
  // the rounding, so the excess is only rounding.
  out_.max_slip_texels = std::min(out_.max_slip_texels, options_.max_slip_texels);
  out_.max_turn_degrees = std::min(out_.max_turn_degrees, options_.max_turn_degrees);
  out_.triangles_out = out_.triangle_chart.size();
}

Result<SimplifiedMesh> Run::operator()() {
  context_.report("simplify", 0);
  out_.triangles_in = geometry_.mesh->indices.size() / 3;
  build_charts();
  if (context_.cancelled()) return Status::cancelled();
  build_simplifiers();
  if (context_.cancelled()) return Status::cancelled();
  rounds();
  if (context_.cancelled()) return Status::cancelled();
  collect();
  if (context_.cancelled()) return Status::cancelled();
  context_.report("simplify", 1);
  return std::move(out_);
}

}  // namespace

Result<SimplifiedMesh> simplify_charts(const SimplifyInput& input, const SimplifyOptions& options,
                                       const Context& context) {
  if (Status status = check_options(options); !status.ok()) return status;
  if (Status status = check_input(input); !status.ok()) return status;
  const Geometry geometry{&input.mesh, &input.charts};
  return Run(geometry, input.texels_per_unit, options, context)();
}

}  // namespace atlas
