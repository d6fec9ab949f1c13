// Internal: which points of which bodies may touch another body or the page's edge soon.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "libatlas/pack/squeeze.h"

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

// Points near another chart when last looked at; others cannot touch it before both have moved far
// against each other (the neighbour lists of Verlet 1967). Each pair is looked at again when it
// has.
class Contacts {
 public:
  Contacts(std::span<const Body> bodies, const SqueezeOptions& options);

  // A point of a body's outline, in the body's own frame. It may touch once its body has moved by
  // `room` against the other.
  struct Contact {
    Vec2d point;
    double room;
  };
  struct Pair {
    std::uint32_t i = 0, j = 0;
    std::vector<Contact> of_i, of_j;  // points of i near j, and of j near i
    double moved = 0;                 // against each other since they were looked for

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

  // Brings all up to date.
  void update(std::span<const Pose> poses);
  // The page's edges have moved.
  void set_page(const SqueezePage& page, std::span<const Pose> poses);

  const std::vector<Wall>& walls() const { return walls_; }  // 1 a body
  std::size_t near_count() const { return near_.size(); }
  const Pair& near(std::size_t k) const { return pairs_[near_[k]]; }

 private:
  static constexpr double kSkin = 5;  // texels that a pair may move before it is looked at again
  static constexpr double kFarSkin = 128;  // that two bodies may move before all pairs are

  void list_near_pairs(std::span<const Pose> poses);
  void look_at(Pair& pair, std::span<const Pose> poses) const;
  void look_at_wall(std::uint32_t i, const Pose& pose);
  void find_points(std::uint32_t i, std::uint32_t j, std::span<const Pose> poses,
                   std::vector<Contact>& found) const;

  std::span<const Body> bodies_;
  const SqueezeOptions& options_;
  SqueezePage page_;
  std::vector<Wall> walls_;
  std::vector<Pair> pairs_;          // of all bodies, ascending
  std::vector<std::uint32_t> near_;  // those that may have contacts, ascending
  std::vector<Pose> listed_;         // when near_ was made
};

}  // namespace atlas::pack
