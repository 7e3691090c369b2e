// The border between drawn free space and wall, with rounded wall corners. Map frame, SI.
#pragma once

#include <cstddef>
#include <vector>

#include "server/constraint/drawn/outline_piece.h"
#include "server/model/walls.h"

namespace handrail {

// What is this near to a corner is at the corner [m].
inline constexpr double kAtCorner = 1e-11;

// The border of the union of all shapes as closed loops of pieces, free space on the left. Borders
// that run within kBorderTolerance of each other are one: shapes side by side are joined without a
// wall between them, and shapes that touch in a point are joined there. A wall corner that
// protrudes into free space is rounded by the fillet, or by the largest radius that fits on its two
// pieces. Built once, immutable; every query is real-time safe and looks at each piece at most
// once.
class Outline {
 public:
  struct Place {
    Vec2 p = Vec2::Zero();
    int piece = -1;   // it is on; -1: no piece at all
    int corner = -1;  // it is at; -1: within the piece
  };

  // May allocate.
  Outline(const std::vector<WallShape>& shapes, double fillet);

  int size() const noexcept { return static_cast<int>(pieces_.size()); }
  const OutlinePiece& piece(int i) const noexcept { return pieces_[index(i)]; }
  // Corner i is the end of piece i and the start of piece next(i).
  int next(int i) const noexcept { return next_[index(i)]; }
  // The corner at the start of piece i.
  int before(int i) const noexcept { return before_[index(i)]; }
  // The next corner at the same point, in a circle: another one only where borders touch.
  int twin(int corner) const noexcept { return twin_[index(corner)]; }

  // The point of the border nearest to x.
  Place nearest(const Vec2& x) const noexcept;
  // Whether x is in free space or on its border, given the border's point nearest to it.
  bool is_free(const Vec2& x, const Place& nearest) const noexcept;
  // Whether the direction d leads from a corner into free space.
  bool opens(int corner, const Vec2& d) const noexcept;

  // Where the way from p to p + d first enters the wall; piece -1: nowhere. The way starts on piece
  // `on` or at corner `at` (-1: neither, in free space) and leads into free space there.
  Place cast(const Vec2& p, const Vec2& d, int on, int at) const noexcept;

  std::size_t memory() const noexcept;  // [bytes]

 private:
  // Smallest box around a piece.
  struct Box {
    double x0, y0, x1, y1;
  };

  static std::size_t index(int i) noexcept { return static_cast<std::size_t>(i); }
  void join();
  bool meets_corner(int piece, int corner) const noexcept;

  std::vector<OutlinePiece> pieces_;
  std::vector<Box> boxes_;
  std::vector<int> next_, before_, twin_;
  std::vector<int> point_;  // of each corner: corners at one point share a number
};

}  // namespace handrail
