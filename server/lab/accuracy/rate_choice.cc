#include <spdlog/fmt/fmt.h>

#include <cmath>
#include <memory>
#include <vector>

#include "devices/joystick/joystick_data.h"
#include "server/base/units.h"
#include "server/lab/accuracy/choices.h"
#include "server/lab/accuracy/contact_model.h"
#include "server/lab/scenes/contest.h"
#include "server/master/wall_runs.h"

namespace handrail {
namespace {

constexpr double kRateDuration = 0.4;  // [s]
constexpr double kRateWatch = 1e-4;    // force and position are compared this often [s]
constexpr Motion1 kRateStart{-10.0 * kMm, 0.15};
constexpr int kRateCalls = 8;

// The joystick in a firm hand, which means to be 10 mm behind a wall of 5 N/mm.
ContactModel rate_contact() {
  ContactModel out;
  const HandOptions hand = joystick_grip();
  out.mass = hand.mass + kJoystickMass;
  out.stiffness = hand.stiffness;
  out.damping =
      2.0 * hand.damping_ratio * std::sqrt(hand.stiffness * hand.mass) + kJoystickViscosity;
  out.rest = 10.0 * kMm;
  out.wall = 5.0 * kNewtonPerMm;
  return out;
}

// Free space left of x = 0, drawn, with the wall's spring alone.
Scene wall_scene() {
  auto walls = std::make_shared<Walls>();
  walls->method = WallMethod::kExact;
  walls->regions.resize(2);
  walls->regions[1].kind = RegionKind::kWall;
  walls->regions[1].stiffness = rate_contact().wall;
  walls->outside = 1;
  WallShape room;
  room.centre = Vec2(-50.0, 0.0) * kMm;
  room.half = Vec2(50.0, 50.0) * kMm;
  walls->shapes = {room};
  walls->start = room.centre;
  walls->stages.resize(1);
  Scene scene;
  scene.walls = walls;
  scene.effects.resize(1);
  scene.effects[0].kind = EffectKind::kWall;
  return scene;
}

// The wall step at one rate, and the hand in between in closed form.
class Loop {
 public:
  explicit Loop(double rate) : run_(make_wall_run(wall_scene(), joystick_capabilities())) {
    period_ = 1.0 / rate;
    in_.hand.valid = true;
  }

  struct Errors {
    ErrorSum force, penetration;
  };
  Errors errors(const ExactContact& exact) {
    const ContactModel model = rate_contact();
    Errors out;
    Motion1 at = kRateStart;
    double force = 0.0, last = 0.0;
    int tick = -1;
    const int ticks_watched = static_cast<int>(std::lround(kRateDuration / kRateWatch));
    for (int i = 0; i < ticks_watched; ++i) {
      const double t = i * kRateWatch;
      // Every tick due by now, each from the hand where it then is.
      while ((tick + 1) * period_ <= t + 1e-12) {
        ++tick;
        at = held(model, at, force, tick * period_ - last);
        last = tick * period_;
        force = step(at);
      }
      at = held(model, at, force, t - last);
      last = t;
      const double true_x = exact.at(t).x;
      out.force.add(force + model.wall * std::max(true_x, 0.0));
      out.penetration.add(std::max(at.x, 0.0) - std::max(true_x, 0.0));
    }
    return out;
  }

  // The wall's force on the hand [N].
  double step(const Motion1& hand) {
    in_.hand.X_MH.p = Vec3(hand.x, 0.0, 0.0);
    in_.hand.v_MH = Vec3(hand.v, 0.0, 0.0);
    wall_step(run_->settings, in_, period_, run_->state, out_);
    return out_.f_H_M.force.x();
  }

 private:
  static Motion1 held(const ContactModel& m, const Motion1& from, double force, double t) {
    return spring_motion(m.mass, m.damping, m.stiffness, m.rest + force / m.stiffness, from, t);
  }

  std::unique_ptr<WallRun> run_;
  double period_ = 1e-3;
  WallInput in_;
  WallOutput out_;
};

}  // namespace

AccuracyRows rate_rows(const std::atomic<bool>& cancelled) {
  const ExactContact exact(rate_contact(), kRateStart, kRateDuration);
  std::vector<Motion1> hands;
  for (int i = 0; i < 400; ++i) hands.push_back(exact.at(i * kRateDuration / 400.0));
  const std::vector<double> rates = {250, 500, 1000, 2000, 4000, 5000, 10000};
  AccuracyRows rows;
  std::vector<std::unique_ptr<Loop>> loops;
  std::vector<std::size_t> places(rates.size(), 0);
  Contest contest;
  for (std::size_t i = 0; i < rates.size(); ++i) {
    loops.push_back(std::make_unique<Loop>(rates[i]));
    const Loop::Errors errors = loops.back()->errors(exact);
    AccuracyRow row;
    row.choice = "haptic_rate";
    row.method = "wall step";
    row.setting = fmt::format("{:g} Hz", rates[i]);
    row.error = errors.force.in("N", 1.0);
    row.note = fmt::format("penetration off by {:.3g} mm RMS, {:.3g} mm at worst",
                           errors.penetration.rms() / kMm, errors.penetration.worst() / kMm);
    row.memory_bytes = sizeof(WallRun);
    rows.push_back(row);
    contest.add([] {},
                [loop = loops.back().get(), &hands, &place = places[i]] {
                  for (int k = 0; k < kRateCalls; ++k) {
                    place = (place + 1) % hands.size();
                    keep(loop->step(hands[place]));
                  }
                },
                kRateCalls);
  }
  contest.run(40, 128, cancelled);
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const double per_second = rates[i] * 1e-3;  // us/s of a step of 1 ns
    rows[i].cost = {"us/s", contest.time(i).median * per_second, contest.time(i).p999 * per_second};
  }
  return rows;
}

}  // namespace handrail
