#include <spdlog/fmt/fmt.h>

#include <array>
#include <cmath>
#include <functional>
#include <memory>
#include <vector>

#include "devices/hand/hand_model.h"
#include "server/base/units.h"
#include "server/lab/accuracy/choices.h"
#include "server/lab/accuracy/contact_model.h"
#include "server/lab/scenes/contest.h"

namespace handrail {
namespace {

constexpr double kDuration = 0.2;  // [s]
constexpr double kWatch = 1e-3;    // the position is compared this often [s]

constexpr int kMotion = 200;  // the same in milliseconds
constexpr int kCalls = 8;
constexpr double kWay = 3.0 * kMm;  // from the start at rest to the wall [m]
constexpr double kPush = 2.0;       // force that pushes the hand there [N]

// The hand of hand_model.h on something as stiff as a workpiece.
ContactModel contact() {
  const HandOptions hand;
  ContactModel out;
  out.mass = hand.mass;
  out.stiffness = hand.stiffness;
  out.damping = 2.0 * hand.damping_ratio * std::sqrt(hand.stiffness * hand.mass);
  out.rest = kPush / hand.stiffness - kWay;
  out.wall = 60.0 * kNewtonPerMm;
  return out;
}
constexpr Motion1 kStart{-kWay, 0.0};

using Step = Motion1 (*)(const ContactModel&, const Motion1&, double);

Motion1 explicit_euler(const ContactModel& m, const Motion1& s, double h) {
  return {s.x + h * s.v, s.v + h * m.force(s.x, s.v) / m.mass};
}

Motion1 symplectic_euler(const ContactModel& m, const Motion1& s, double h) {
  const double v = s.v + h * m.force(s.x, s.v) / m.mass;
  return {s.x + h * v, v};
}

// With the stiffness at the step's start.
Motion1 implicit_euler(const ContactModel& m, const Motion1& s, double h) {
  const double k = m.stiffness + (s.x > 0.0 ? m.wall : 0.0);
  const double v = (m.mass * s.v + h * m.force(s.x, 0.0)) / (m.mass + h * (m.damping + h * k));
  return {s.x + h * v, v};
}

Motion1 runge_kutta(const ContactModel& m, const Motion1& s, double h) {
  const auto rate = [&m](double x, double v) { return Motion1{v, m.force(x, v) / m.mass}; };
  const Motion1 a = rate(s.x, s.v);
  const Motion1 b = rate(s.x + 0.5 * h * a.x, s.v + 0.5 * h * a.v);
  const Motion1 c = rate(s.x + 0.5 * h * b.x, s.v + 0.5 * h * b.v);
  const Motion1 d = rate(s.x + h * c.x, s.v + h * c.v);
  return {s.x + h / 6.0 * (a.x + 2.0 * (b.x + c.x) + d.x),
          s.v + h / 6.0 * (a.v + 2.0 * (b.v + c.v) + d.v)};
}

// One millisecond of a scheme or of the hand model.
class Simulation {
 public:
  virtual ~Simulation() = default;
  virtual void start() = 0;
  virtual void millisecond() = 0;
  virtual double x() const = 0;
  virtual std::size_t memory() const = 0;
};

class Scheme final : public Simulation {
 public:
  Scheme(Step step, int per_ms) : step_(step), per_ms_(per_ms) { Scheme::start(); }
  void start() override { state_ = kStart; }
  void millisecond() override {
    for (int i = 0; i < per_ms_; ++i) state_ = step_(model_, state_, kWatch / per_ms_);
  }
  double x() const override { return state_.x; }
  std::size_t memory() const override { return sizeof(state_); }

 private:
  Step step_;
  int per_ms_;
  ContactModel model_ = contact();
  Motion1 state_;
};

// The simulated hand against its device's stop, which stands kStop from the origin.
class Hand final : public Simulation {
 public:
  explicit Hand(int per_ms) : per_ms_(per_ms), model_(fresh()) {
    push_.force.x() = kPush;
    Hand::start();
  }
  void start() override {
    model_ = fresh();
    model_.place(Vec3(kStop + kStart.x, 0.0, 0.0));
  }
  void millisecond() override {
    for (int i = 0; i < per_ms_; ++i) model_.step(kWatch / per_ms_, push_);
  }
  double x() const override { return model_.pose().p.x() - kStop; }
  std::size_t memory() const override { return sizeof(model_); }

 private:
  static constexpr double kStop = 0.1;  // [m]
  static HandModel fresh() {
    HandOptions hand;
    hand.tremor_rms = hand.drift_rms = hand.drift_rotation_rms = 0.0;
    HeldBody stop;
    stop.stop_half.setConstant(kStop);
    stop.stop_stiffness = contact().wall;
    return HandModel(hand, stop);
  }

  int per_ms_;
  Wrench push_;
  HandModel model_;
};

struct Entry {
  const char* method;
  Step step;  // null: the hand model
};
constexpr std::array<Entry, 5> kEntries = {{{"explicit Euler", explicit_euler},
                                            {"symplectic Euler", symplectic_euler},
                                            {"implicit Euler", implicit_euler},
                                            {"Runge-Kutta 4", runge_kutta},
                                            {"hand model", nullptr}}};

ErrorSum error_of(Simulation& simulation, const ExactContact& exact) {
  ErrorSum sum;
  simulation.start();
  for (int i = 1; i * kWatch <= kDuration + 1e-9; ++i) {
    simulation.millisecond();
    sum.add(simulation.x() - exact.at(i * kWatch).x);
  }
  return sum;
}

}  // namespace

AccuracyRows integrator_rows(const std::atomic<bool>& cancelled) {
  const ExactContact exact(contact(), kStart, kDuration);
  AccuracyRows rows;
  std::vector<std::unique_ptr<Simulation>> simulations;
  Contest contest;
  for (const Entry& entry : kEntries) {
    for (const int per_ms : {1, 2, 4, 10, 20, 50, 100}) {
      // The hand model itself takes steps of at most 0.25 ms.
      if (entry.step == nullptr && per_ms < 4) continue;
      std::unique_ptr<Simulation> simulation;
      if (entry.step == nullptr) {
        simulation = std::make_unique<Hand>(per_ms);
      } else {
        simulation = std::make_unique<Scheme>(entry.step, per_ms);
      }
      AccuracyRow row;
      row.choice = "integrator";
      row.method = entry.method;
      row.setting = fmt::format("step {:g} ms", 1.0 / per_ms);
      row.error = error_of(*simulation, exact).in("um", 1e6);
      row.memory_bytes = simulation->memory();
      rows.push_back(row);
      contest.add([s = simulation.get()] { s->start(); },
                  [s = simulation.get()] {
                    for (int i = 0; i < kCalls; ++i) s->millisecond();
                    keep(s->x());
                  },
                  kCalls);
      simulations.push_back(std::move(simulation));
    }
  }
  // A turn, its warming up included, is the whole motion.
  contest.run(120, kMotion / kCalls - 1, cancelled);
  for (std::size_t i = 0; i < rows.size(); ++i) {
    rows[i].cost = {"ns", contest.time(i).median, contest.time(i).p999};
  }
  return rows;
}

}  // namespace handrail
