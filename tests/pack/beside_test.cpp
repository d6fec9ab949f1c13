// Outlines that are placed beside others that stay.
#include "libatlas/pack/beside.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <string>
#include <vector>

namespace atlas {
namespace {

struct Square {
  std::array<Vec2d, 4> corners;
  std::array<std::uint32_t, 6> triangles{0, 1, 2, 0, 2, 3};

  explicit Square(double side, Vec2d low = {}) {
    corners = {low, Vec2d{low.x + side, low.y}, Vec2d{low.x + side, low.y + side},
               Vec2d{low.x, low.y + side}};
  }
  ChartShape shape() const { return {corners, triangles}; }
};

struct Box {
  double left, bottom, right, top;
};

Box box_at(const OutlinePlacement& p, double side) {
  Box box{1e9, 1e9, -1e9, -1e9};
  for (const Vec2d q : Square(side).corners) {
    const double x = p.offset.x + std::cos(p.angle) * q.x - std::sin(p.angle) * q.y,
                 y = p.offset.y + std::sin(p.angle) * q.x + std::cos(p.angle) * q.y;
    box = {std::min(box.left, x), std::min(box.bottom, y), std::max(box.right, x),
           std::max(box.top, y)};
  }
  return box;
}

double gap(const Box& a, const Box& b) {
  return std::max({b.left - a.right, a.left - b.right, b.bottom - a.top, a.bottom - b.top});
}

PageOptions padded(std::int32_t padding, std::uint32_t pages = 1) {
  PageOptions options;
  options.padding = padding;
  options.pages = pages;
  return options;
}

TEST(Beside, KeepsThePaddingFromWhatStaysBetweenTexels) {
  const std::vector<Extent> pages{{64, 64}};
  const Square large(30.3, {10.37, 9.81}), small(9.5);
  const std::vector<TakenShape> taken{{0, large.shape()}};
  const std::vector<ChartShape> shapes(6, small.shape());
  const auto placed = pack_beside(shapes, {pages, taken}, padded(2), {});
  ASSERT_TRUE(placed.ok()) << placed.status().message();
  EXPECT_EQ(placed->pages, pages);
  const Box fixed{10.37, 9.81, 40.67, 40.11};
  std::vector<Box> boxes;
  for (const OutlinePlacement& p : placed->placements) {
    boxes.push_back(box_at(p, 9.5));
    EXPECT_GE(gap(fixed, boxes.back()), 4 - 1e-9);  // both have two texels around them
    EXPECT_GE(std::min(boxes.back().left, boxes.back().bottom), 2 - 1e-9);
    EXPECT_LE(std::max(boxes.back().right, boxes.back().top), 62 + 1e-9);
  }
  for (std::size_t i = 0; i < boxes.size(); ++i)
    for (std::size_t j = 0; j < i; ++j) EXPECT_GE(gap(boxes[i], boxes[j]), 4 - 1e-9);
}

TEST(Beside, FullPagesAreFollowedByNewOnesAndThenGrow) {
  const std::vector<Extent> pages{{64, 64}};
  const Square large(60, {2, 2}), other(40);
  const std::vector<TakenShape> taken{{0, large.shape()}};
  const std::vector<ChartShape> shapes{other.shape(), other.shape()};
  const auto two = pack_beside(shapes, {pages, taken}, padded(2, 3), {});
  ASSERT_TRUE(two.ok());
  EXPECT_EQ(two->pages, (std::vector<Extent>(3, {64, 64})));
  const auto grown = pack_beside(shapes, {pages, taken}, padded(2), {});
  ASSERT_TRUE(grown.ok());
  ASSERT_EQ(grown->pages.size(), 1u);
  EXPECT_LT(grown->pages[0].area(), 4 * 64 * 64);
  PageOptions square = padded(2);
  square.square = true;
  const auto doubled = pack_beside(shapes, {pages, taken}, square, {});
  ASSERT_TRUE(doubled.ok());
  EXPECT_EQ(doubled->pages, (std::vector<Extent>{{128, 128}}));
}

TEST(Beside, WhatReachesBeyondThePageCountsForNothingThere) {
  const std::vector<Extent> pages{{64, 64}};
  const Square beyond(60, {-40, 30}), small(30);
  const std::vector<TakenShape> taken{{0, beyond.shape()}};
  const std::vector<ChartShape> shapes{small.shape()};
  const auto placed = pack_beside(shapes, {pages, taken}, padded(1), {});
  ASSERT_TRUE(placed.ok());
  EXPECT_EQ(placed->pages, pages);
  EXPECT_GE(gap({-40, 30, 20, 90}, box_at(placed->placements[0], 30)), 2 - 1e-9);
}

TEST(Beside, ErrorsNameWhatIsWrong) {
  const Square one(10);
  const std::vector<ChartShape> shapes{one.shape()};
  const std::vector<Extent> page{{64, 64}}, huge{{20000, 64}};
  const std::vector<TakenShape> elsewhere{{1, one.shape()}};
  const auto message = [&](const TakenPages& taken, const PageOptions& options) {
    const auto placed = pack_beside(shapes, taken, options, {});
    return placed.ok() ? std::string() : placed.status().message();
  };
  EXPECT_NE(message({{}, {}}, padded(1)).find("none"), std::string::npos);
  EXPECT_NE(message({huge, {}}, padded(1)).find("20000 x 64"), std::string::npos);
  EXPECT_NE(message({page, elsewhere}, padded(1)).find("page 1 of 1"), std::string::npos);
  EXPECT_NE(message({page, {}}, padded(-1)).find("padding -1"), std::string::npos);
  const Square large(20000);
  const std::vector<ChartShape> too_large{large.shape()};
  const auto placed = pack_beside(too_large, {page, {}}, padded(1), {});
  ASSERT_FALSE(placed.ok());
  EXPECT_EQ(placed.status().code(), ErrorCode::no_solution);
}

}  // namespace
}  // namespace atlas
