#include "server/lab/stability/bare_device.h"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <numbers>

namespace handrail {
namespace {

// A step over which the velocity's direction turns by more is halved [rad].
constexpr double kTurn = 0.02;

// exp(a) by its series, of a matrix that has been halved until its largest entry is small.
Eigen::Matrix3d exponential(Eigen::Matrix3d a) {
  constexpr double kSmall = 0.25;
  constexpr int kTerms = 16;  // 0.75^16 / 16! is below 1e-15
  int halvings = 0;
  for (; a.cwiseAbs().maxCoeff() > kSmall; ++halvings) a *= 0.5;
  Eigen::Matrix3d sum = Eigen::Matrix3d::Identity(), term = sum;
  for (int i = 1; i <= kTerms; ++i) {
    term = (term * a / i).eval();
    sum += term;
  }
  for (; halvings > 0; --halvings) sum = (sum * sum).eval();
  return sum;
}

}  // namespace

BareDevice::BareDevice(const DeviceBody& body, const PassiveGrip& grip, const Vec2& at,
                       double step) noexcept
    : body_(body),
      grip_(grip),
      mass_(body.mass + grip.mass),
      damping_(body.damping + grip.damping),
      hold_(at),
      longest_(step),
      x_(at) {}

BareDevice::Flow BareDevice::flow(double h) const noexcept {
  Eigen::Matrix3d a = Eigen::Matrix3d::Zero();
  a(0, 1) = h;
  a(1, 0) = -h * grip_.stiffness / mass_;
  a(1, 1) = -h * damping_ / mass_;
  a(1, 2) = h / mass_;
  const Eigen::Matrix3d e = exponential(a);
  return {e(0, 0), e(0, 1), e(0, 2), e(1, 0), e(1, 1), e(1, 2)};
}

BareDevice::Motion BareDevice::moved(const Flow& by, const Motion& from,
                                     const Vec2& force) noexcept {
  return {by.xx * from.y + by.xv * from.v + by.xf * force,
          by.vx * from.y + by.vv * from.v + by.vf * force};
}

double BareDevice::energy() const noexcept {
  const Vec2 y = x_ - hold_;
  return 0.5 * (mass_ * v_.squaredNorm() + grip_.stiffness * y.squaredNorm()) - grip_.push.dot(y);
}

void BareDevice::advance(double dt, const Vec2& force) noexcept {
  const int steps = std::max(1, static_cast<int>(std::ceil(dt / longest_ - 1e-6)));
  const double h = dt / steps;
  if (h != h_) {
    h_ = h;
    const int needed = body_.friction > 0.0 ? kLevels + 2 : 1;
    for (int i = 0; i < needed; ++i) flows_[static_cast<std::size_t>(i)] = flow(h * std::exp2(-i));
  }
  for (int i = 0; i < steps; ++i) step(0, force);
}

// Its own energy is known before and after, and so what dampers have taken of it.
void BareDevice::take(const Motion& to, const Vec2& force, const Vec2& friction) noexcept {
  const double before = energy();
  const Vec2 way = to.y - (x_ - hold_);
  x_ = hold_ + to.y;
  v_ = to.v;
  const double work = force.dot(way), rubbed = friction.dot(way);
  const double damped = work - rubbed - (energy() - before);
  given_ += work;
  lost_ += rubbed + (damping_ > 0.0 ? damped * body_.damping / damping_ : 0.0);
}

double BareDevice::stop(const Motion& from, const Vec2& force, const Vec2& way,
                        double h) const noexcept {
  constexpr int kTries = 4;  // the speed is all but straight over a step
  double low = 0.0, high = h, at = h;
  double fast = from.v.dot(way), slow = moved(flow(h), from, force).v.dot(way);
  for (int i = 0; i < kTries; ++i) {
    at = low + (high - low) * fast / (fast - slow);
    const double speed = moved(flow(at), from, force).v.dot(way);
    if (std::abs(speed) < 1e-15) break;
    (speed > 0.0 ? low : high) = at;
    (speed > 0.0 ? fast : slow) = speed;
  }
  return at;
}

void BareDevice::step(int level, const Vec2& force) noexcept {
  const Vec2 pushed = force + grip_.push;
  const Motion from{x_ - hold_, v_};
  const Flow& whole = flows_[static_cast<std::size_t>(level)];
  if (body_.friction == 0.0) return take(moved(whole, from, pushed), force, Vec2::Zero());
  if (from.v.isZero(0.0)) return leave(h_ * std::exp2(-level), force);
  Vec2 way = from.v.normalized();
  const Vec2 began = way;
  // Less friction along it, the velocity in the middle keeps its direction: so that is known
  // beforehand, and a motion that all but stands is not thrown from side to side.
  const Vec2 middle = moved(flows_[static_cast<std::size_t>(level) + 1], from, pushed).v;
  if (middle.dot(way) > 0.0) way = middle.normalized();
  const Vec2 friction = body_.friction * way;
  const Motion to = moved(whole, from, pushed - friction);
  const Vec2 across = to.v - to.v.dot(began) * began;
  const bool turns = across.norm() > kTurn * std::max(from.v.norm(), to.v.norm());
  if (turns && level < kLevels) {
    step(level + 1, force);
    return step(level + 1, force);
  }
  if (turns || to.v.dot(way) >= 0.0) return take(to, force, friction);
  const double h = h_ * std::exp2(-level), until = stop(from, pushed - friction, way, h);
  Motion stopped = moved(flow(until), from, pushed - friction);
  stopped.v.setZero();
  take(stopped, force, friction);
  leave(h - until, force);
}

void BareDevice::leave(double h, const Vec2& force) noexcept {
  const Motion from{x_ - hold_, Vec2::Zero()};
  const Vec2 pushed = force + grip_.push;
  const Vec2 pulled = pushed - grip_.stiffness * from.y;
  if (!(h > 0.0) || pulled.norm() <= body_.friction) return;  // sticks
  const Vec2 friction = body_.friction * pulled.normalized();
  take(moved(flow(h), from, pushed - friction), force, friction);
}

void Encoder::read(const Vec2& truth, double dt) noexcept {
  const Vec2 seen = resolution_ > 0.0
                        ? Vec2(resolution_ * (truth / resolution_).array().round().matrix())
                        : truth;
  if (!known_) x_ = seen;
  known_ = true;
  const double follow = cutoff_ > 0.0 ? -std::expm1(-2.0 * std::numbers::pi * cutoff_ * dt) : 1.0;
  v_ += follow * ((seen - x_) / dt - v_);
  x_ = seen;
}

}  // namespace handrail
