#include "server/constraint/drawn/exact_wall.h"

#include <cmath>
#include <limits>
#include <stdexcept>

#include "server/constraint/drawn/outline.h"
#include "server/constraint/drawn/wall_shape.h"
#include "server/constraint/proxy_image.h"

namespace handrail {
namespace {

constexpr int kMaxWork = 2048;            // pieces looked at in a tick, after the first leg
constexpr double kNoGain = 1e-12;         // less than this is no way nearer to the hand [m]
constexpr double kClearDirection = 1e-9;  // farther than this a direction is well defined [m]
constexpr double kInShape = 1e-9;         // a point of a shape's border is in the shape [m]

class ExactWall final : public WallProxy {
 public:
  explicit ExactWall(const Walls& walls) : walls_(walls), outline_(walls.shapes, walls.fillet) {
    start(walls.start);
  }

  Vec2 start(const Vec2& hand) noexcept override {
    hand_ = hand.allFinite() ? hand : walls_.start;
    place_ = {hand_, -1, -1};
    if (gone_) return place_.p;
    if (!put_to_free(kNearBy)) {
      place_ = {walls_.start, -1, -1};
      put_to_free(std::numeric_limits<double>::infinity());
    }
    return place_.p;
  }

  WallContact advance(const Vec2& hand) noexcept override {
    if (hand.allFinite()) hand_ = hand;
    WallContact contact;
    if (gone_) {
      place_ = {hand_, -1, -1};
    } else {
      work_ = 0;
      bool done = false;
      for (int leg = 0; !done && leg < kMaxLegs && work_ < kMaxWork; ++leg) done = go();
      contact.unfinished = !done;
      contact.work = work_;
    }
    contact.proxy = place_.p;
    contact.touching = place_.piece >= 0 && place_.p != hand_;
    if (contact.touching) contact.normal = normal();
    contact.wall = walls_.outside;
    contact.region = region();
    return contact;
  }

  void set_gone(std::uint64_t gone) noexcept override {
    const bool was_gone = gone_;
    gone_ = (gone >> walls_.outside & 1u) != 0;
    if (gone_) place_ = {place_.p, -1, -1};
    if (was_gone && !gone_) put_to_free(std::numeric_limits<double>::infinity());
  }

  std::size_t save(std::span<std::byte, kMostImage> out) const noexcept override {
    return put_in_image(out, gone_, hand_, place_, work_);
  }
  bool restore(std::span<const std::byte> image) noexcept override {
    return take_from_image(image, gone_, hand_, place_, work_);
  }

  std::size_t memory() const noexcept override { return sizeof(*this) + outline_.memory(); }

 private:
  // If the place is inside the wall, puts it to the border; false, and nothing done, if that is
  // farther than `reach`.
  bool put_to_free(double reach) noexcept {
    const Outline::Place border = outline_.nearest(place_.p);
    if (outline_.is_free(place_.p, border)) return true;
    if ((border.p - place_.p).norm() > reach) return false;
    place_ = border;
    return true;
  }

  // One leg; true when there is nowhere nearer to go.
  bool go() noexcept {
    if (place_.corner >= 0) return go_around(place_.corner);
    if (place_.piece >= 0) return go_on(place_.piece);
    return go_straight(-1, -1);
  }

  // Through free space, from piece `on` or corner `at`.
  bool go_straight(int on, int at) noexcept {
    const Vec2 d = hand_ - place_.p;
    if (d.isZero(0.0)) return true;
    work_ += outline_.size();
    const Outline::Place hit = outline_.cast(place_.p, d, on, at);
    place_ = hit.piece < 0 ? Outline::Place{hand_, -1, -1} : hit;
    return hit.piece < 0;
  }

  bool go_to_corner(int corner) noexcept {
    place_ = {outline_.piece(corner).b, corner, corner};
    return false;
  }

  // From within a piece: off it, or along it.
  bool go_on(int i) noexcept {
    ++work_;
    const OutlinePiece& piece = outline_.piece(i);
    const Vec2 d = hand_ - place_.p;
    if (d.dot(piece.normal(place_.p)) > 0.0) return leave(i);
    return go_along(i, d.dot(piece.tangent(place_.p)) >= 0.0);
  }

  bool leave(int i) noexcept {
    const OutlinePiece& piece = outline_.piece(i);
    if ((place_.p - piece.b).norm() < kAtCorner) return go_to_corner(i);
    if ((place_.p - piece.a).norm() < kAtCorner) return go_to_corner(outline_.before(i));
    return go_straight(i, -1);
  }

  bool go_along(int i, bool forward) noexcept {
    const OutlinePiece& piece = outline_.piece(i);
    return piece.turn == 0 ? go_along_segment(i, piece) : go_along_arc(i, piece, forward);
  }

  bool go_along_segment(int i, const OutlinePiece& piece) noexcept {
    const double s = (hand_ - piece.a).dot(piece.along);
    if (s <= 0.0) return go_to_corner(outline_.before(i));
    if (s >= piece.length) return go_to_corner(i);
    place_ = {piece.a + s * piece.along, i, -1};
    return true;
  }

  bool go_along_arc(int i, const OutlinePiece& piece, bool forward) noexcept {
    const Vec2 v = hand_ - piece.centre;
    const double distance = v.norm();
    if (piece.turn < 0 && distance > piece.radius) {
      // The hand is past the round wall: it comes into sight where the tangent points at it.
      const double cosine = piece.radius / distance;
      const double sine =
          std::sqrt((distance - piece.radius) * (distance + piece.radius)) / distance;
      const double side = forward ? 1.0 : -1.0;
      const Vec2 sight =
          piece.centre + piece.radius / distance * (cosine * v + side * sine * left_of(v));
      if (piece.spans(sight, 0.0)) {
        place_ = {sight, i, -1};
        return leave(i);
      }
    } else {
      if (distance < kNoGain) return true;  // at the centre: every point is as near
      const Vec2 foot = piece.centre + piece.radius / distance * v;
      if (piece.spans(foot, 0.0)) {
        place_ = {foot, i, -1};
        return true;
      }
    }
    return go_to_corner(forward ? i : outline_.before(i));
  }

  bool go_around(int corner) noexcept {
    ++work_;
    const Vec2 d = hand_ - place_.p;
    if (outline_.opens(corner, d)) return go_straight(-1, corner);
    double most = kNoGain;
    int best = -1;
    bool forward = false;
    int k = corner;
    do {
      const int out = outline_.next(k);
      const double back = approach(outline_.piece(k), d, -1.0);
      const double ahead = approach(outline_.piece(out), d, 1.0);
      if (back > most) most = back, best = k, forward = false;
      if (ahead > most) most = ahead, best = out, forward = true;
      k = outline_.twin(k);
    } while (k != corner);
    if (best < 0) return true;
    place_ = {place_.p, best, -1};
    return go_along(best, forward);
  }

  // How much a start along a piece leads toward the hand, `d` away; `side` 1: forward.
  double approach(const OutlinePiece& piece, const Vec2& d, double side) const noexcept {
    const double straight = side * d.dot(piece.tangent(place_.p));
    // Opposite the hand on a round wall both ways lead nearer, though neither does at first.
    const bool opposite = piece.turn < 0 && -d.dot(piece.normal(place_.p)) > piece.radius;
    return opposite && std::abs(straight) <= kNoGain ? 2.0 * kNoGain : straight;
  }

  Vec2 normal() const noexcept {
    const Vec2 away = place_.p - hand_;
    const double depth = away.norm();
    if (place_.corner >= 0 && depth > kClearDirection) return away / depth;
    return outline_.piece(place_.piece).normal(place_.p);
  }

  // Of the last shape the proxy is in; on a fillet, between two shapes, of the nearest.
  std::uint8_t region() const noexcept {
    double least = std::numeric_limits<double>::infinity();
    std::uint8_t nearest = walls_.outside;
    for (std::size_t i = walls_.shapes.size(); i-- > 0;) {
      const double off = outside_by(walls_.shapes[i], place_.p);
      if (off <= kInShape) return walls_.shapes[i].region;
      if (off < least && !gone_) least = off, nearest = walls_.shapes[i].region;
    }
    return nearest;
  }

  const Walls& walls_;
  Outline outline_;
  bool gone_ = false;
  Vec2 hand_ = Vec2::Zero();
  Outline::Place place_;  // of the proxy
  int work_ = 0;
};

}  // namespace

std::unique_ptr<WallProxy> make_exact_proxy(const Walls& walls) {
  if (walls.shapes.empty()) throw std::invalid_argument("the exact proxy needs drawn shapes");
  return std::make_unique<ExactWall>(walls);
}

}  // namespace handrail
