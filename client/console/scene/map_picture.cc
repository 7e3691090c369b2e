#include "client/console/scene/map_picture.h"

#include <png.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>
#include <vector>

#include "server/base/read_file.h"
#include "server/constraint/drawn/outline.h"

namespace handrail {
namespace {

constexpr std::size_t kMostMapBytes = 16u << 20;
constexpr double kAround = 0.010;      // of wall that is shown around drawn shapes [m]
constexpr int kLongestSide = 1000;     // of the picture of drawn shapes [pixels]
constexpr double kFinestPixel = 1e-4;  // [m]

bool is_in(const WallShape& shape, const Vec2& p) {
  const Vec2 from = p - shape.centre;
  switch (shape.kind) {
    case WallShape::Kind::kRectangle: {
      const Vec2 local = Pose2::turned(from, -shape.angle);
      return std::abs(local.x()) <= shape.half.x() && std::abs(local.y()) <= shape.half.y();
    }
    case WallShape::Kind::kDisc: return from.norm() <= shape.radius;
    case WallShape::Kind::kArc: {
      if (std::abs(from.norm() - shape.radius) > 0.5 * shape.width) return false;
      const double turn = 2.0 * std::numbers::pi;
      const double past = std::atan2(from.y(), from.x()) - shape.from;
      return past - turn * std::floor(past / turn) <= shape.to - shape.from;
    }
  }
  return false;
}

// How far a shape may reach from its centre [m].
double reach_of(const WallShape& shape) {
  switch (shape.kind) {
    case WallShape::Kind::kRectangle: return shape.half.norm();
    case WallShape::Kind::kDisc: return shape.radius;
    case WallShape::Kind::kArc: return shape.radius + 0.5 * shape.width;
  }
  return 0.0;
}

// Half of the square about the origin that holds all shapes [m].
double half_side(const Walls& walls) {
  double half = 0.0;
  for (const WallShape& shape : walls.shapes) {
    half = std::max(half, shape.centre.cwiseAbs().maxCoeff() + reach_of(shape));
  }
  return half + kAround;
}

Result<std::string> encoded(int side, const std::vector<std::uint8_t>& rgb) {
  png_image image{};
  image.version = PNG_IMAGE_VERSION;
  image.width = image.height = static_cast<png_uint_32>(side);
  image.format = PNG_FORMAT_RGB;
  std::string out(PNG_IMAGE_PNG_SIZE_MAX(image), '\0');
  png_alloc_size_t size = out.size();
  if (png_image_write_to_memory(&image, out.data(), &size, 0, rgb.data(), 0, nullptr) == 0) {
    return Status::error(std::string("the walls' picture: ") + image.message);
  }
  out.resize(size);
  return out;
}

// The region of the shape nearest to p, within `far` [m]; else what is outside all.
std::size_t region_near(const Walls& walls, const Vec2& p, double far) {
  constexpr int kRings = 4, kWays = 16;
  for (int ring = 1; ring <= kRings; ++ring) {
    for (int way = 0; way < kWays; ++way) {
      const Vec2 to =
          Pose2::turned(Vec2(far * ring / kRings, 0.0), 2.0 * std::numbers::pi * way / kWays);
      for (const WallShape& shape : walls.shapes) {
        if (is_in(shape, p + to)) return shape.region;
      }
    }
  }
  return walls.outside;
}

// Where a shape is, and in its rounded corners.
std::size_t region_at(const Walls& walls, const std::optional<Outline>& outline, const Vec2& p) {
  for (const WallShape& shape : walls.shapes) {
    if (is_in(shape, p)) return shape.region;
  }
  if (!outline) return walls.outside;
  const Outline::Place border = outline->nearest(p);
  const bool rounded = (border.p - p).norm() <= walls.fillet && outline->is_free(p, border);
  return rounded ? region_near(walls, p, 2.0 * walls.fillet) : walls.outside;
}

// Of a picture of `columns` by `rows` pixels about the origin, the nearest pixel for each cell.
// `colour` of a column and a row from the top.
template <typename Colour>
MapCells cells_of(int columns, int rows, const Vec2& size, const Colour& colour) {
  MapCells out;
  const int each = (std::max(columns, rows) + MapCells::kMost - 1) / MapCells::kMost;
  out.columns = columns / each;
  out.rows = rows / each;
  // What is left over at the edges is less than a cell.
  out.size =
      size.cwiseProduct(Vec2(1.0 * out.columns * each / columns, 1.0 * out.rows * each / rows));
  const int left = (columns - out.columns * each + each) / 2,
            low = (rows - out.rows * each + each) / 2;
  for (int row = 0; row < out.rows; ++row) {
    for (int column = 0; column < out.columns; ++column) {
      const auto rgb = colour(left + column * each, rows - 1 - (low + row * each));
      out.rgb.append(rgb.begin(), rgb.end());
    }
  }
  return out;
}

Result<MapPicture> drawn(const Walls& walls) {
  const double half = half_side(walls);
  std::optional<Outline> outline;
  if (walls.fillet > 0.0) outline.emplace(walls.shapes, walls.fillet);
  const int side = std::min(kLongestSide, static_cast<int>(std::ceil(2.0 * half / kFinestPixel)));
  const double pixel = 2.0 * half / side;
  std::vector<std::uint8_t> rgb;
  rgb.reserve(static_cast<std::size_t>(side) * static_cast<std::size_t>(side) * 3);
  for (int row = 0; row < side; ++row) {
    for (int column = 0; column < side; ++column) {
      const Vec2 p((column + 0.5) * pixel - half, half - (row + 0.5) * pixel);
      const auto colour = map_colour(walls, region_at(walls, outline, p));
      rgb.insert(rgb.end(), colour.begin(), colour.end());
    }
  }
  const auto png = encoded(side, rgb);
  if (!png) return png.status();
  const Vec2 size = Vec2::Constant(2.0 * half);
  const auto colour = [&](int column, int row) {
    const auto at = static_cast<std::size_t>(3 * (row * side + column));
    return std::array{rgb[at], rgb[at + 1], rgb[at + 2]};
  };
  return MapPicture{*png, size, cells_of(side, side, size, colour)};
}

}  // namespace

std::array<std::uint8_t, 3> map_colour(const Walls& walls, std::size_t region) {
  if (region >= walls.regions.size()) return {255, 255, 255};
  const WallRegion& of = walls.regions[region];
  if (!walls.image.empty() || of.rgb != decltype(of.rgb){}) return of.rgb;
  switch (of.kind) {
    case RegionKind::kFree: return {250, 250, 250};
    case RegionKind::kAisle: return {214, 230, 250};
    case RegionKind::kWall: break;
  }
  return {70, 76, 86};
}

Result<MapPicture> map_picture(const Walls& walls) {
  if (walls.image.empty()) return drawn(walls);
  const auto png = read_file(walls.image, kMostMapBytes);
  if (!png) return png.status();
  const CoverageMap& map = *walls.map;
  const Vec2 size = map.pixel * Vec2(map.width, map.height);
  const auto colour = [&](int column, int row) {
    const auto at = static_cast<std::ptrdiff_t>(row) * map.width + column;
    return map_colour(walls, map.region[static_cast<std::size_t>(at)]);
  };
  return MapPicture{*png, size, cells_of(map.width, map.height, size, colour)};
}

}  // namespace handrail
