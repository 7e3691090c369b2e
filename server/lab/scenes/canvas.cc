#include "server/lab/scenes/canvas.h"

#include <png.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <string>

#include "server/base/output.h"

namespace handrail {
namespace {

std::size_t offset(int width, int x, int y) {
  return 3 * (static_cast<std::size_t>(y) * static_cast<std::size_t>(width) +
              static_cast<std::size_t>(x));
}

}  // namespace

Canvas::Canvas(int width, int height, const Colour& ground)
    : width_(width), height_(height), rgb_(offset(width, 0, height)) {
  for (std::size_t i = 0; i < rgb_.size(); ++i) rgb_[i] = ground[i % 3];
}

Colour Canvas::at(int x, int y) const {
  const std::size_t i = offset(width_, x, y);
  return {rgb_[i], rgb_[i + 1], rgb_[i + 2]};
}

void Canvas::blend(int x, int y, const Colour& colour, double share) {
  if (x < 0 || y < 0 || x >= width_ || y >= height_ || share <= 0.0) return;
  const std::size_t at = offset(width_, x, y);
  for (std::size_t i = 0; i < 3; ++i) {
    const double mixed = (1.0 - share) * rgb_[at + i] + share * colour[i];
    rgb_[at + i] = static_cast<std::uint8_t>(std::lround(mixed));
  }
}

void Canvas::line(const Vec2& from, const Vec2& to, double width, const Colour& colour) {
  if (!from.allFinite() || !to.allFinite()) return;
  const double half = 0.5 * width;
  const auto first = [half](double a, double b) { return std::floor(std::min(a, b) - half - 1.0); };
  const auto last = [half](double a, double b) { return std::ceil(std::max(a, b) + half + 1.0); };
  const int x0 = static_cast<int>(std::max(first(from.x(), to.x()), 0.0));
  const int y0 = static_cast<int>(std::max(first(from.y(), to.y()), 0.0));
  const int x1 = static_cast<int>(std::min(last(from.x(), to.x()), width_ - 1.0));
  const int y1 = static_cast<int>(std::min(last(from.y(), to.y()), height_ - 1.0));
  const Vec2 way = to - from;
  const double square = way.squaredNorm();
  for (int y = y0; y <= y1; ++y) {
    for (int x = x0; x <= x1; ++x) {
      const Vec2 p = Vec2(x + 0.5, y + 0.5) - from;
      const double t = square > 0.0 ? std::clamp(p.dot(way) / square, 0.0, 1.0) : 0.0;
      blend(x, y, colour, std::clamp(half + 0.5 - (p - t * way).norm(), 0.0, 1.0));
    }
  }
}

void Canvas::arrow(const Vec2& from, const Vec2& to, double width, const Colour& colour) {
  line(from, to, width, colour);
  const Vec2 way = to - from;
  const double length = way.norm();
  if (length == 0.0) return;
  const double head = std::min(0.45 * length, 5.0 * width);
  const Vec2 back = -head / length * way, side = 0.6 * Vec2(-back.y(), back.x());
  line(to, to + back + side, width, colour);
  line(to, to + back - side, width, colour);
}

Status Canvas::write_png(const std::string& path) const {
  png_image image{};
  image.version = PNG_IMAGE_VERSION;
  image.width = static_cast<png_uint_32>(width_);
  image.height = static_cast<png_uint_32>(height_);
  image.format = PNG_FORMAT_RGB;
  png_alloc_size_t size = 0;
  std::string bytes;
  const auto encode = [&](void* to) {
    return png_image_write_to_memory(&image, to, &size, 0, rgb_.data(), 0, nullptr) != 0;
  };
  if (!encode(nullptr)) return Status::error(path + ": cannot encode: " + image.message);
  bytes.resize(size);
  if (!encode(bytes.data())) return Status::error(path + ": cannot encode: " + image.message);
  return write_file(path, bytes);
}

}  // namespace handrail
