// Recorded hands among painted walls: the sub-pixel proxy under motions as a pointer records them,
// played at up to 5 m/s.
#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>
#include <vector>

#include "devices/hand/recorded_hand.h"
#include "server/constraint/painted/subpixel_wall.h"
#include "tests/property/draws.h"
#include "tests/support/wall_samples.h"

namespace handrail {
namespace {

using test::between;
using test::within_square;

constexpr double kMapPixel = 1e-4;
constexpr int kMapSide = 240;      // of the map [pixels]
constexpr double kRoom = 0.014;    // the hand stays this near the map's middle [m]
constexpr double kFastest = 5e-3;  // a tick of 1 ms at 5 m/s [m]

// About nine samples a second, uneven, with rests and now and then a gap, as pointers record. Of a
// seed, so that a long recording costs rapidcheck one number.
RecordedMotion any_recording() {
  std::mt19937_64 random(*rc::gen::arbitrary<std::uint64_t>());
  const auto uniform = [&random](double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(random);
  };
  std::vector<RecordedSample> samples;
  Vec2 p = Vec2::Zero(), v = Vec2::Zero();
  double t = 0.0;
  for (int i = 0; i < 60; ++i) {
    samples.push_back({t, Vec3(p.x(), p.y(), 0.0)});
    t += uniform(0.0, 1.0) < 0.05 ? uniform(0.3, 0.9) : uniform(0.03, 0.14);
    const double what = uniform(0.0, 1.0);
    if (what < 0.2) v.setZero();
    if (what > 0.5) v = Vec2(uniform(-1.0, 1.0), uniform(-1.0, 1.0));
    p = (p + v * uniform(0.2, 1.0)).cwiseMax(-2.0).cwiseMin(2.0);
  }
  return RecordedMotion(std::move(samples));
}

// The recording, shrunk or grown to the map and played as fast as makes its fastest tick a way of
// `step` [m].
std::vector<Vec2> played(const RecordedMotion& recording, double step) {
  const double scale = kRoom / std::max(recording.half_extent().maxCoeff(), 1e-9);
  double fastest = 1e-9;
  for (double t = 0.0; t < recording.duration(); t += 1e-3) {
    fastest = std::max(fastest, scale * recording.velocity(t).norm());
  }
  std::vector<Vec2> out;
  const double tick = step / fastest;
  for (double t = 0.0; t < recording.duration(); t += tick) {
    out.push_back(scale * recording.at(t).head<2>());
  }
  return out;
}

RC_GTEST_PROP(RecordedWallProperty, NoRecordedHandTakesTheProxyOutOfTheFarFace, ()) {
  const RecordedMotion recording = any_recording();
  const double step = kFastest * std::pow(10.0, between(-1.5, 0.0));
  const std::vector<Vec2> hand = played(recording, step);
  const double thickness = between(1.0, 4.0) * kMapPixel;
  const bool ring = *rc::gen::arbitrary<bool>();
  const double angle = between(0.0, 2.0 * std::numbers::pi), r = between(2e-3, 9e-3);
  const Vec2 off = within_square(5e-3), n(-std::sin(angle), std::cos(angle));
  const auto above = [&](const Vec2& p) { return ring ? (p - off).norm() - r : (p - off).dot(n); };
  RC_PRE(std::abs(above(hand[0])) > thickness);
  // From the wall's middle toward the side where the hand begins.
  const double sign = above(hand[0]) > 0.0 ? 1.0 : -1.0;

  test::WallPainter painter(kMapSide, kMapSide, kMapPixel);
  if (ring) {
    painter.wall_disc(off, r + 0.5 * thickness).open_disc(off, r - 0.5 * thickness);
  } else {
    painter.wall(test::rectangle(off, 1.0, thickness, angle));
  }
  const double edge = 0.5 * kMapSide * kMapPixel;
  const auto on_map = [&](const Vec2& p) {
    return p.cwiseAbs().maxCoeff() < edge - 2.0 * kMapPixel;
  };
  RC_PRE(on_map(hand[0]));
  // As an editor exports it, or exactly.
  const int levels = *rc::gen::arbitrary<bool>() ? 256 : 0;
  const Walls walls = painter.finish(hand[0], levels);
  const auto proxy = make_subpixel_proxy(walls);
  proxy->start(hand[0]);
  bool crossed = false;
  for (const Vec2& p : hand) {
    const WallContact contact = proxy->advance(p);
    RC_ASSERT(sign * above(contact.proxy) > -0.5 * kMapPixel);
    RC_ASSERT(contact.proxy.cwiseAbs().maxCoeff() < edge + 0.5 * kMapPixel);
    crossed |= sign * above(p) < -0.5 * thickness;
  }
  RC_CLASSIFY(crossed, "the hand went through the wall");
}

}  // namespace
}  // namespace handrail
