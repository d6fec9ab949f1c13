// Internal: finds the points of bodies that may soon touch another body or the page's edge.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "libatlas/pack/pressing/squeeze.h"

namespace atlas::pack {

struct Pose {
  Vec2d at;
  double cosine = 1, sine = 0;

  Vec2d to_page(Vec2d d) const {
    return {at.x + cosine * d.x - sine * d.y, at.y + sine * d.x + cosine * d.y};
  }
  Vec2d to_body(Vec2d q) const {
    const double x = q.x - at.x, y = q.y - at.y;
    return {cosine * x + sine * y, cosine * y - sine * x};
  }
};

// The points that were near another chart when they were last searched for. Other points cannot
// touch that chart before both charts have moved far against each other (the neighbour lists of
// Verlet 1967). The points of a pair are searched for again when that has happened.
class Contacts {
 public:
  Contacts(std::span<const Body> bodies, const SqueezeOptions& options);

  // A point of a body's outline, in the body's own frame. It can only touch once its body has moved
  // by `room` against the other.
  struct Contact {
    Vec2d point;
    double room;
  };
  struct Pair {
    std::uint32_t i = 0, j = 0;
    std::vector<Contact> of_i, of_j;  // points of i near j, and of j near i
    double moved = 0;                 // relative movement since the points were searched for

   private:
    friend class Contacts;
    bool known = false;
    Pose seen_i, seen_j;
  };
  struct Wall {
    std::vector<Contact> points;
    double moved = 0;

   private:
    friend class Contacts;
    Pose seen;
  };

  // Brings all contacts up to date.
  void update(std::span<const Pose> poses);
  // Tells the object that the page's edges have moved.
  void set_page(const SqueezePage& page, std::span<const Pose> poses);

  const std::vector<Wall>& walls() const { return walls_; }  // one per body
  std::size_t near_count() const { return near_.size(); }
  const Pair& near(std::size_t k) const { return pairs_[near_[k]]; }

 private:
  // Relative movement in texels after which a pair is searched again.
  static constexpr double kSkin = 5;
  // Movement in texels of two bodies together after which all pairs are checked again.
  static constexpr double kFarSkin = 128;

  void list_near_pairs(std::span<const Pose> poses);
  void look_at(Pair& pair, std::span<const Pose> poses) const;
  void look_at_wall(std::uint32_t i, const Pose& pose);
  void find_points(std::uint32_t i, std::uint32_t j, std::span<const Pose> poses,
                   std::vector<Contact>& found) const;

  std::span<const Body> bodies_;
  const SqueezeOptions& options_;
  SqueezePage page_;
  std::vector<Wall> walls_;
  std::vector<Pair> pairs_;          // all pairs of bodies, ascending
  std::vector<std::uint32_t> near_;  // indices of the pairs that may have contacts, ascending
  std::vector<Pose> listed_;         // the poses when near_ was made
};

}  // namespace atlas::pack
