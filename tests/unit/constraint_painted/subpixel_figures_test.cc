// How far the sub-pixel proxy is off on walls drawn at random: corners, thin walls, narrow aisles,
// tight circles. WALLS.md says in which range of each constant these figures hold.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <numbers>
#include <random>
#include <string>

#include "server/constraint/painted/subpixel_wall.h"
#include "tests/support/wall_samples.h"

namespace handrail {
namespace {

using test::Polygon;
using test::WallPainter;

constexpr double kBankPixel = 1e-4;
constexpr double kMicro = 1e-6;

Vec2 unit_at(double angle) { return {std::cos(angle), std::sin(angle)}; }
Vec2 left_of(const Vec2& v) { return {-v.y(), v.x()}; }

// Distances from where the proxy should be [m].
struct Off {
  double squares = 0.0, worst = 0.0;
  int count = 0;
  void add(const Vec2& off) {
    squares += off.squaredNorm();
    worst = std::max(worst, off.norm());
    ++count;
  }
  double rms() const { return std::sqrt(squares / count); }
};

// Every kind of wall in turn; the same on every machine.
class Bank {
 public:
  // Along the sides of free space with corners (`inner`), or of wall.
  Off corners(bool inner) {
    Off out;
    for (int map = 0; map < 12; ++map) {
      const Polygon sides = any_polygon(3 + map % 4);
      const Walls walls = inner
                              ? WallPainter(120, 120, kBankPixel, false).open(sides).finish(middle_)
                              : WallPainter(120, 120, kBankPixel).wall(sides).finish({0.0, 5e-3});
      begin(walls, inner ? middle_ : Vec2(0.0, 5e-3));
      for (int round = 0; round < 2; ++round) {
        for (std::size_t i = 0; i < sides.size(); ++i) {
          along_side(sides[i], sides[(i + 1) % sides.size()], inner, out);
        }
      }
    }
    return out;
  }

  // A straight wall, or an aisle, that many pixels wide.
  Off strip(double pixels, bool wall) {
    Off out;
    const double width = pixels * kBankPixel;
    for (int map = 0; map < 8; ++map) {
      const double angle = between(0.0, 3.2);
      const Vec2 t = unit_at(angle), n = unit_at(angle + 0.5 * std::numbers::pi);
      const Vec2 off = between(-1.0, 1.0) * kBankPixel * n;
      const Vec2 start = wall ? Vec2(off + 2e-3 * n) : off;
      const Polygon shape = test::rectangle(off, wall ? 1.0 : 6e-3, width, angle);
      WallPainter painter(100, 100, kBankPixel, wall);
      begin((wall ? painter.wall(shape) : painter.open(shape)).finish(start), start);
      for (double s = -2e-3; s < 2e-3; s += 0.17 * kBankPixel) {
        const Vec2 face = off + s * t + 0.5 * width * n;
        const Vec2 into = wall ? Vec2(-0.8 * width * n) : Vec2(0.8 * kBankPixel * n);
        out.add(look(face + into) - face);
      }
    }
    return out;
  }

  // The inside of a closed wall with corners, that many pixels thick.
  Off fence(double pixels) {
    Off out;
    for (int map = 0; map < 6; ++map) {
      const int n = 3 + map % 4;
      const double first = between(0.0, 6.3), r = between(2.5e-3, 4e-3);
      draw_middle();
      const double more = pixels * kBankPixel / std::cos(std::numbers::pi / n);
      Polygon inside, outside;
      for (int i = 0; i < n; ++i) {
        const Vec2 way = unit_at(first + 2.0 * std::numbers::pi * i / n);
        inside.push_back(middle_ + r * way);
        outside.push_back(middle_ + (r + more) * way);
      }
      begin(WallPainter(120, 120, kBankPixel).wall(outside).open(inside).finish(middle_, 256),
            middle_);
      for (std::size_t i = 0; i < inside.size(); ++i) {
        const Vec2 a = inside[i], way = inside[(i + 1) % inside.size()] - a, t = way.normalized();
        for (double s = 0.0; s < way.norm(); s += 0.3 * kBankPixel) {
          const Vec2 foot = a + s * t;
          out.add(settled(foot - 0.7 * pixels * kBankPixel * left_of(t)) - foot);
        }
      }
    }
    return out;
  }

  // A disc of wall, or a hole in it.
  Off circle(double pixels, bool solid) {
    Off out;
    const double r = pixels * kBankPixel, outward = solid ? 1.0 : -1.0;
    for (int map = 0; map < 3; ++map) {
      const double x = between(-1.0, 1.0), y = between(-1.0, 1.0);
      const Vec2 c = kBankPixel * Vec2(x, y);
      WallPainter painter(100, 100, kBankPixel, solid);
      const Vec2 start = solid ? Vec2(4e-3, 4e-3) : c;
      begin((solid ? painter.wall_disc(c, r) : painter.open_disc(c, r)).finish(start, 256),
            c + (r + 2.0 * outward * kBankPixel) * unit_at(0.0));
      for (double a = 0.0; a < 6.3; a += 0.2 * kBankPixel / r) {
        out.add(look(c + (r - outward * kBankPixel) * unit_at(a)) - c - r * unit_at(a));
      }
    }
    return out;
  }

  double mean_work() const { return work_ / looks_; }
  int unfinished() const { return unfinished_; }

 private:
  double between(double low, double high) {
    return low + (high - low) * static_cast<double>(random_() >> 11) * 0x1p-53;
  }
  void draw_middle() {
    const double x = between(-1e-4, 1e-4), y = between(-1e-4, 1e-4);
    middle_ = {x, y};
  }
  Polygon any_polygon(int n) {
    const double first = between(0.0, 6.3), r = between(2.5e-3, 4e-3);
    draw_middle();
    Polygon out;
    for (int i = 0; i < n; ++i) {
      const double turn = (i + between(-0.25, 0.25)) / n;
      out.push_back(middle_ + r * unit_at(first + 2.0 * std::numbers::pi * turn));
    }
    return out;
  }

  void begin(const Walls& walls, const Vec2& start) {
    walls_ = walls;
    proxy_ = make_subpixel_proxy(walls_);
    proxy_->start(start);
  }
  Vec2 look(const Vec2& hand) {
    contact_ = proxy_->advance(hand);
    work_ += contact_.work;
    ++looks_;
    unfinished_ += contact_.unfinished;
    return contact_.proxy;
  }
  Vec2 settled(const Vec2& hand) {
    look(hand);
    for (int i = 0; i < 5 && contact_.unfinished; ++i) look(hand);
    return contact_.proxy;
  }

  // A hand a pixel deep. On a wall's outer corner it stays on the first side.
  void along_side(const Vec2& a, const Vec2& b, bool inner, Off& out) {
    const double length = (b - a).norm();
    const Vec2 t = (b - a) / length, into = (inner ? -kBankPixel : kBankPixel) * left_of(t);
    if (!inner) {
      proxy_->start(0.5 * (a + b) - 5.0 * into);
      proxy_->advance(0.5 * (a + b) + into);
    }
    const double last = inner ? length : length - 1.5 * kBankPixel;
    for (double s = inner ? 0.0 : 0.5 * length; s < last; s += 0.3 * kBankPixel) {
      const Vec2 foot = a + s * t;
      out.add(settled(foot + into) - foot);
    }
  }

  std::mt19937_64 random_{7};
  Vec2 middle_ = Vec2::Zero();
  Walls walls_;
  std::unique_ptr<WallProxy> proxy_;
  WallContact contact_;
  double work_ = 0.0, looks_ = 0.0;
  int unfinished_ = 0;
};

// What was measured when the constants were [um].
struct Row {
  const char* kind;
  double pixels;  // thickness, width or radius
  double rms, worst;
};
constexpr Row kRows[] = {
    {"outer corner", 0.0, 0.02, 0.10}, {"inner corner", 0.0, 1.97, 36.61},
    {"wall", 1.0, 2.08, 8.64},         {"wall", 1.3, 6.60, 34.98},
    {"wall", 1.7, 2.49, 28.97},        {"wall", 2.0, 0.08, 0.95},
    {"wall", 2.6, 0.03, 0.13},         {"wall", 4.0, 0.06, 0.16},
    {"aisle", 1.5, 4.25, 20.63},       {"aisle", 2.0, 0.05, 0.57},
    {"aisle", 3.0, 0.01, 0.05},        {"fence", 1.0, 7.74, 88.94},
    {"fence", 1.5, 8.63, 70.34},       {"fence", 2.0, 2.28, 29.80},
    {"fence", 3.0, 2.50, 36.41},       {"hole", 3.0, 9.94, 24.48},
    {"disc", 3.0, 13.91, 37.12},       {"hole", 6.0, 6.09, 20.09},
    {"disc", 6.0, 8.06, 34.49},        {"hole", 9.0, 3.71, 16.99},
    {"disc", 9.0, 4.11, 21.08},        {"hole", 14.0, 0.20, 0.61},
    {"disc", 14.0, 0.57, 7.99},        {"hole", 30.0, 0.18, 0.68},
    {"disc", 30.0, 0.20, 0.71},
};

Off measured(Bank& bank, const Row& row) {
  const std::string kind = row.kind;
  if (kind == "outer corner" || kind == "inner corner") return bank.corners(kind[0] == 'i');
  if (kind == "wall" || kind == "aisle") return bank.strip(row.pixels, kind == "wall");
  if (kind == "fence") return bank.fence(row.pixels);
  return bank.circle(row.pixels, kind == "disc");
}

TEST(SubpixelFigures, WallsDrawnAtRandomAreFollowedAsWellAsWhenTheConstantsWereMeasured) {
  Bank bank;
  for (const Row& row : kRows) {
    const Off off = measured(bank, row);
    EXPECT_LE(off.rms() / kMicro, 1.25 * row.rms + 0.1) << row.kind << ' ' << row.pixels;
    EXPECT_LE(off.worst / kMicro, 1.5 * row.worst + 0.5) << row.kind << ' ' << row.pixels;
  }
  EXPECT_LE(bank.mean_work(), 1.25 * 3.74);
  EXPECT_EQ(bank.unfinished(), 0);
}

}  // namespace
}  // namespace handrail
