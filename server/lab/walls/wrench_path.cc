#include "server/lab/walls/wrench_path.h"

#include <algorithm>
#include <cmath>

#include "server/lab/walls/wall_bench.h"

namespace handrail {

Result<WrenchPath> WrenchPath::of(const Scene& scene) {
  const EffectSpec* friction = effect_of(scene, EffectKind::kProgressive);
  if (scene.walls == nullptr || friction == nullptr) {
    return Status::error("scene '" + scene.name + "' lists no progressive effect to turn against");
  }
  const auto& shapes = scene.walls->shapes;
  const auto arc = std::find_if(shapes.begin(), shapes.end(), [&](const WallShape& shape) {
    return shape.kind == WallShape::Kind::kArc && scene.walls->regions[shape.region].progressive;
  });
  if (arc == shapes.end()) {
    return Status::error("scene '" + scene.name +
                         "' draws no arc in a progressive region for the ball to lead along");
  }
  WrenchPath path;
  path.centre_ = arc->centre;
  path.radius_ = arc->radius;
  path.width_ = arc->width;
  path.from_ = friction->clockwise ? arc->to : arc->from;
  path.sweep_ = friction->clockwise ? arc->from - arc->to : arc->to - arc->from;
  path.turn_ = path.radius_ * std::abs(path.sweep_);
  const auto on_circle = [&](double angle) { return Pose2::turned({path.radius_, 0.0}, angle); };
  path.chord_ = (on_circle(path.from_) - on_circle(path.from_ + path.sweep_)).norm();
  return path;
}

Vec2 WrenchPath::middle() const {
  // Half a degree of a circle each: 1 - cos(0.25 deg) of its radius is missed, a 100 000th.
  constexpr int kAround = 720;
  Eigen::AlignedBox2d box;
  for (int i = 0; i < kAround; ++i) box.extend(at(length() * i / kAround));
  return box.center();
}

Vec2 WrenchPath::at(double s) const {
  s -= length() * std::floor(s / length());
  const auto on_circle = [&](double angle) {
    return Vec2(centre_ + Pose2::turned({radius_, 0.0}, angle));
  };
  if (s < turn_) return on_circle(from_ + sweep_ * s / turn_);
  const double share = chord_ > 0.0 ? (s - turn_) / chord_ : 1.0;
  return (1.0 - share) * on_circle(from_ + sweep_) + share * on_circle(from_);
}

Vec2 WrenchPath::tangent(double s) const {
  s -= length() * std::floor(s / length());
  if (s < turn_) {
    const double side = sweep_ < 0.0 ? -1.0 : 1.0;
    return Pose2::turned({0.0, side}, from_ + sweep_ * s / turn_);
  }
  return (at(0.0) - at(turn_)).normalized();
}

GuidingBall::GuidingBall(const WrenchPath& path, int turns, int loosen) noexcept
    : path_(path),
      turns_(turns),
      loosen_(loosen),
      lead_in_(0.5 * (path.length() - path.turn_length())),
      behind_(-lead_in_),
      p_(path.at(-lead_in_)) {}

double GuidingBall::duration() const noexcept {
  return lead_in_ / path_.speed() + kLoopTime * (turns_ + loosen_);
}

int GuidingBall::loop(double t) const noexcept {
  return static_cast<int>(std::floor(travelled(t) / path_.length()));
}

double GuidingBall::travelled(double t) const noexcept { return path_.speed() * t - lead_in_; }

double GuidingBall::along(double way) const noexcept {
  const double forth = path_.length() * turns_;
  return way <= forth ? way : 2.0 * forth - way;
}

double GuidingBall::direction(double way) const noexcept {
  return way <= path_.length() * turns_ ? 1.0 : -1.0;
}

void GuidingBall::move(double t, const Vec2& hand) noexcept {
  constexpr int kSteps = 60;
  constexpr double kStep = 1e-3;  // [m]
  const double ball = travelled(std::min(t, duration()));
  const auto off = [&](double way) { return (path_.at(along(way)) - hand).squaredNorm(); };
  double nearest = behind_;
  for (int i = 1; i <= kSteps && behind_ + i * kStep <= ball; ++i) {
    if (off(behind_ + i * kStep) < off(nearest)) nearest = behind_ + i * kStep;
  }
  behind_ = nearest;
  const bool waits = ball > behind_ + kBallAhead;
  const double way = waits ? behind_ + kBallAhead : ball;
  p_ = path_.at(along(way));
  v_ = Vec2::Zero();
  if (!waits && t < duration()) v_ = direction(way) * path_.speed() * path_.tangent(along(way));
}

}  // namespace handrail
