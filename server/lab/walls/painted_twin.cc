#include "server/lab/walls/painted_twin.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "server/haptic/wall_proxies.h"

namespace handrail {
namespace {

constexpr int kPoints = 16;    // along each side of a pixel
constexpr int kBorder = 20;    // pixels of wall around the shapes
constexpr double kOn = 1e-12;  // off free space, by rounding [m]

// Half the box around a shape, and its middle [m].
std::pair<Vec2, Vec2> box_of(const WallShape& shape) {
  switch (shape.kind) {
    case WallShape::Kind::kRectangle: {
      const double c = std::abs(std::cos(shape.angle)), s = std::abs(std::sin(shape.angle));
      return {shape.centre,
              {c * shape.half.x() + s * shape.half.y(), s * shape.half.x() + c * shape.half.y()}};
    }
    case WallShape::Kind::kDisc: return {shape.centre, Vec2::Constant(shape.radius)};
    case WallShape::Kind::kArc:
      return {shape.centre, Vec2::Constant(shape.radius + 0.5 * shape.width)};
  }
  return {shape.centre, Vec2::Zero()};
}

class Painter {
 public:
  Painter(const Walls& drawn, double pixel) : proxy_(make_wall_proxy(drawn)), pixel_(pixel) {
    // The map's middle is the origin.
    Vec2 half = Vec2::Zero();
    for (const WallShape& shape : drawn.shapes) {
      const auto [middle, size] = box_of(shape);
      half = half.cwiseMax(middle.cwiseAbs() + size);
    }
    map_.pixel = pixel;
    map_.width = 2 * (static_cast<int>(std::ceil(half.x() / pixel)) + kBorder);
    map_.height = 2 * (static_cast<int>(std::ceil(half.y() / pixel)) + kBorder);
    map_.wall.assign(static_cast<std::size_t>(map_.width) * static_cast<std::size_t>(map_.height),
                     drawn.outside);
  }

  CoverageMap paint() {
    std::vector<char> above = row_of_corners(0);
    for (int y = 0; y < map_.height; ++y) {
      std::vector<char> below = row_of_corners(y + 1);
      for (int x = 0; x < map_.width; ++x) {
        const auto i = static_cast<std::size_t>(x);
        const Vec2 middle = at(x + 0.5, y + 0.5);
        const int free = above[i] + above[i + 1] + below[i] + below[i + 1] + int{is_free(middle)};
        const double share = free == 0 ? 0.0 : free == 5 ? 1.0 : free_share(x, y);
        const double coded = std::round(share * 255.0) / 255.0;
        map_.open.push_back(static_cast<std::uint16_t>(std::lround(coded * 65535.0)));
        map_.region.push_back(coded >= 0.5 ? region_near(middle) : map_.wall.front());
      }
      above.swap(below);
    }
    return std::move(map_);
  }

 private:
  // The place in the map's frame of a place in pixels from its upper left corner.
  Vec2 at(double x, double y) const {
    return pixel_ * Vec2(x - 0.5 * map_.width, 0.5 * map_.height - y);
  }
  bool is_free(const Vec2& p) { return (proxy_->start(p) - p).norm() < kOn; }
  std::uint8_t region_near(const Vec2& p) { return proxy_->advance(proxy_->start(p)).region; }
  std::vector<char> row_of_corners(int y) {
    std::vector<char> out(static_cast<std::size_t>(map_.width + 1));
    for (int x = 0; x <= map_.width; ++x) {
      out[static_cast<std::size_t>(x)] = is_free(at(x, y)) ? 1 : 0;
    }
    return out;
  }
  double free_share(int x, int y) {
    int free = 0;
    for (int k = 0; k < kPoints; ++k) {
      for (int l = 0; l < kPoints; ++l) {
        free += is_free(at(x + (k + 0.5) / kPoints, y + (l + 0.5) / kPoints)) ? 1 : 0;
      }
    }
    return static_cast<double>(free) / (kPoints * kPoints);
  }

  std::unique_ptr<WallProxy> proxy_;
  double pixel_;
  CoverageMap map_;
};

}  // namespace

Walls painted_twin(const Walls& drawn, double pixel, WallMethod method) {
  Walls out = drawn;
  out.map = std::make_shared<const CoverageMap>(Painter(drawn, pixel).paint());
  out.method = method;
  return out;
}

}  // namespace handrail
