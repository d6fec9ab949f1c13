// Internal: removes vertices of one chart as long as slip and turn stay within their bounds.
#pragma once

#include <cstdint>
#include <vector>

#include "libatlas/core/context.h"
#include "libatlas/simplify/chart_mesh.h"
#include "libatlas/simplify/fine_chart.h"
#include "libatlas/simplify/slip_measure.h"
#include "libatlas/simplify/star.h"

namespace atlas::simplify {

struct Collapse : Estimate {
  std::vector<std::uint32_t> faces;  // the faces around v that stay and change
  std::vector<SlipLimits> bounds;    // upper bounds for these faces, set by check()
};

// How far the removal of a border vertex moves the border. check() of the chart takes this into
// account.
struct BorderStep {
  double before = 0;  // slip bound of the coarse border around the vertex so far, texels
  double step = 0;    // slip that the removal adds, texels
};

class ChartSimplifier {
 public:
  // `texel` is the length of a texel of this chart on its surface. The slip in `limits` is in
  // texels.
  ChartSimplifier(const Geometry& geometry, FineChart fine, double texel, const SlipLimits& limits);
  ChartSimplifier(const ChartSimplifier&) = delete;
  ChartSimplifier& operator=(const ChartSimplifier&) = delete;

  const FineChart& fine() const { return fine_; }
  double texel() const { return texel_; }

  // Removes inner vertices, cheapest first, as long as they cost at most `limit`.
  void run(double limit, const Context& context);
  // The cost of the cheapest vertex in the queue: 0 if a vertex with very many neighbours waits,
  // and infinity if there is none.
  double next_cost() const;
  // Returns the border vertices whose surroundings have changed since the last call.
  std::vector<std::uint32_t> take_touched();

  // Several charts must agree on the collapse of a border vertex, so it is done in three steps.
  // judge() returns whether the new triangles are well oriented, and sets cost and offset. check()
  // returns whether slip and turn stay within their bounds. apply() performs the collapse.
  bool judge(std::uint32_t v, std::uint32_t w, Estimate& out);
  bool check(const BorderStep& border, Collapse& collapse);
  void apply(const Collapse& collapse);
  void ring(std::uint32_t v, Ring& out) const { mesh_.ring(v, out); }

  // Appends the remaining triangles to the result.
  struct Triangle {
    std::uint32_t vertices[3];
    std::uint32_t source;
  };
  void collect(std::vector<Triangle>& out) const;
  SlipLimits worst() const;  // largest bounds over the remaining triangles, texels and radians

 private:
  struct Entry {
    float cost;
    std::uint32_t vertex;
  };
  static bool costs_more(const Entry& a, const Entry& b) {
    return a.cost != b.cost ? a.cost > b.cost : a.vertex > b.vertex;
  }
  void load(std::uint32_t v);
  void push(std::uint32_t v, float cost);
  void queue_all();
  double top_cost() const;
  bool grows_hub(const Collapse& collapse) const;
  void wake(std::uint32_t v, float cost);
  bool rank(std::uint32_t v);
  void process(std::uint32_t v, float cost);

  FineChart fine_;
  VertexPoints points_;
  double texel_;
  SlipLimits limits_;
  ChartMesh mesh_;
  SlipMeasure measure_;
  std::vector<float> face_slip_, face_turn_;  // upper bounds, texels and radians
  std::vector<float> key_;                    // cost a vertex is queued with, or infinity
  std::vector<Entry> heap_;
  std::vector<std::uint32_t> touched_;
  std::vector<std::uint32_t> hubs_;   // vertices with very many neighbours, examined once a run
  std::vector<bool> hub_;             // for each vertex, whether it waits in hubs_
  std::vector<Estimate> candidates_;  // of the current vertex, cheapest first
  std::vector<std::size_t> targets_;
  Collapse attempt_;
  Star star_;
};

}  // namespace atlas::simplify
