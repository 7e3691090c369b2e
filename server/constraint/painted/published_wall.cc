#include "server/constraint/painted/published_wall.h"
#include "server/constraint/proxy_image.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <stdexcept>
#include <vector>

namespace handrail {
namespace {

constexpr std::uint16_t kHalfOpen = 32768;

struct Pixel {
  int column = 0, row = 0;
  bool operator==(const Pixel&) const = default;
};

class PublishedWall final : public WallProxy {
 public:
  explicit PublishedWall(const Walls& walls) : walls_(walls), map_(*walls.map) {
    const double radius = walls.search_radius;
    const int reach = static_cast<int>(std::ceil(radius));
    for (int y = -reach; y <= reach; ++y) {
      for (int x = -reach; x <= reach; ++x) {
        if (x * x + y * y < radius * radius) around_.push_back({x, y});
      }
    }
    tests_ = std::max(kMaxPixelTests, static_cast<int>(around_.size()));
    start(walls.start);
  }

  Vec2 start(const Vec2& hand) noexcept override {
    hand_ = hand.allFinite() ? hand : walls_.start;
    proxy_ = pixel_at(hand_);
    put_to_free();
    return place();
  }

  WallContact advance(const Vec2& hand) noexcept override {
    if (hand.allFinite()) hand_ = hand;
    WallContact contact;
    contact.work = descend(contact.unfinished);
    contact.proxy = place();
    contact.touching = contact.proxy != hand_;
    if (contact.touching) contact.normal = (contact.proxy - hand_).normalized();
    const std::size_t i = index(proxy_);
    contact.region = map_.region[i];
    contact.wall = map_.wall[i];
    return contact;
  }

  void set_gone(std::uint64_t gone) noexcept override {
    gone_ = gone;
    if (is_wall(proxy_)) put_to_free();
  }

  std::size_t save(std::span<std::byte, kMostImage> out) const noexcept override {
    return put_in_image(out, gone_, hand_, proxy_);
  }
  bool restore(std::span<const std::byte> image) noexcept override {
    return take_from_image(image, gone_, hand_, proxy_);
  }

  std::size_t memory() const noexcept override {
    return sizeof(*this) + around_.capacity() * sizeof(Pixel) +
           map_.open.capacity() * sizeof(map_.open[0]) + map_.region.capacity() +
           map_.wall.capacity();
  }

 private:
  // In pixels from the centre of the top left one, down the rows.
  Vec2 in_pixels(const Vec2& p) const noexcept {
    return {p.x() / map_.pixel + 0.5 * (map_.width - 1),
            0.5 * (map_.height - 1) - p.y() / map_.pixel};
  }
  Vec2 centre_of(const Pixel& at) const noexcept {
    return {(at.column - 0.5 * (map_.width - 1)) * map_.pixel,
            (0.5 * (map_.height - 1) - at.row) * map_.pixel};
  }
  // Beyond the border: a pixel beyond the border, not farther than needed to look from there.
  Pixel pixel_at(const Vec2& p) const noexcept {
    const Vec2 at = in_pixels(p);
    const double far = kNearbyPixels + 1.0;
    return {static_cast<int>(std::floor(std::clamp(at.x() + 0.5, -far, map_.width + far))),
            static_cast<int>(std::floor(std::clamp(at.y() + 0.5, -far, map_.height + far)))};
  }

  std::size_t index(const Pixel& at) const noexcept {
    return static_cast<std::size_t>(at.row) * static_cast<std::size_t>(map_.width) +
           static_cast<std::size_t>(at.column);
  }

  bool is_wall(const Pixel& at) const noexcept {
    if (at.column < 0 || at.row < 0 || at.column >= map_.width || at.row >= map_.height) {
      return true;
    }
    const std::size_t i = index(at);
    return map_.open[i] < kHalfOpen && (gone_ >> map_.region[i] & 1u) == 0;
  }

  static double squared(const Pixel& at, const Vec2& hand) noexcept {
    const double x = at.column - hand.x(), y = at.row - hand.y();
    return x * x + y * y;
  }

  // Algorithm 1. Returns the pixels tested.
  int descend(bool& unfinished) noexcept {
    const Vec2 hand = in_pixels(hand_);
    const int scan = static_cast<int>(around_.size());
    int tested = 0;
    for (bool nearer = true; nearer;) {
      if (tested + scan > tests_) {
        unfinished = true;
        break;
      }
      nearer = false;
      const double here = squared(proxy_, hand);
      for (const Pixel& step : around_) {
        ++tested;
        const Pixel next{proxy_.column + step.column, proxy_.row + step.row};
        if (is_wall(next) || !(squared(next, hand) < here)) continue;
        proxy_ = next;
        nearer = true;
        break;
      }
    }
    return tested;
  }

  Vec2 place() const noexcept {
    const Vec2 off = in_pixels(hand_) - Vec2(proxy_.column, proxy_.row);
    return off.cwiseAbs().maxCoeff() <= 0.5 ? hand_ : centre_of(proxy_);
  }

  // From inside a wall to the free pixel nearest to the proxy's, else to the scene's start.
  void put_to_free() noexcept {
    if (!is_wall(proxy_) || to_nearest_free()) return;
    const Pixel start = pixel_at(walls_.start);
    proxy_ = {std::clamp(start.column, 0, map_.width - 1),
              std::clamp(start.row, 0, map_.height - 1)};
    if (is_wall(proxy_)) to_nearest_free();
  }

  bool to_nearest_free() noexcept {
    const Pixel from = proxy_;
    int least = kNearbyPixels * kNearbyPixels + 1;
    Pixel best;
    for (int y = -kNearbyPixels; y <= kNearbyPixels; ++y) {
      for (int x = -kNearbyPixels; x <= kNearbyPixels; ++x) {
        const Pixel at{from.column + x, from.row + y};
        if (x * x + y * y >= least || is_wall(at)) continue;
        least = x * x + y * y;
        best = at;
      }
    }
    if (least > kNearbyPixels * kNearbyPixels) return false;
    proxy_ = best;
    return true;
  }

  const Walls& walls_;
  const CoverageMap& map_;
  std::vector<Pixel> around_;  // the scan, relative to the proxy's pixel
  int tests_ = 0;              // a tick
  std::uint64_t gone_ = 0;
  Vec2 hand_ = Vec2::Zero();
  Pixel proxy_;
};

}  // namespace

std::unique_ptr<WallProxy> make_published_proxy(const Walls& walls) {
  if (walls.map == nullptr) throw std::invalid_argument("the published proxy needs a painted map");
  return std::make_unique<PublishedWall>(walls);
}

}  // namespace handrail
