#include "server/lab/scenes/press_course.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <string>

#include "devices/net_ft/rdt_packet.h"
#include "server/kinematics/arm_of.h"
#include "server/kinematics/rv2a.h"

namespace handrail {
namespace {

constexpr double kAway = 10.0 * kMm;    // where nothing is touched
constexpr double kDeep = 1.0 * kMm;     // past what is touched
constexpr double kSlide = 10.0 * kMm;   // along it
constexpr double kSpeed = 20.0 * kMm;   // [m/s]
constexpr double kTurn = 120.0 * kDeg;  // of a key
constexpr double kTurnSpeed = 60.0 * kDeg;
constexpr double kRest = 0.3;  // [s]
constexpr double kCycle = 7.1e-3;

// Where the tip goes straight to, and how far it has turned about its own axis by then.
struct Stop {
  Vec3 p_S;
  double turn = 0.0;
};

struct Way {
  std::string what;  // is touched
  Quat q_ST;
  std::vector<Stop> stops;
};

// The tool along `along`, turned from where it points at home as little as that takes.
Quat looking(const Pose& home, const Vec3& along) {
  return (smallest_turn(home.q * Vec3::UnitZ(), along) * home.q).normalized();
}

Way onto(const char* what, const Pose& home, const Vec3& p, const Vec3& n) {
  const Vec3 aside = kSlide * n.unitOrthogonal();
  const Vec3 above = p + kAway * n, in = p - kDeep * n;
  return {what, looking(home, -n), {{above}, {in}, {in + aside}, {above + aside}, {above}}};
}

Way onto(const PlaneSpec& plane, const Pose& home) {
  const Vec3 n = plane.normal;
  return onto("plane", home, home.p - n.dot(home.p - plane.at) * n, n);
}

Way onto(const BoxSpec& box, const Pose& home) {
  const Vec3 from = box.X_SB.q.conjugate() * (home.p - box.X_SB.p);
  int axis = 0;
  from.cwiseQuotient(box.half).cwiseAbs().maxCoeff(&axis);
  const Vec3 n_B = std::copysign(1.0, from[axis]) * Vec3::Unit(axis);
  return onto("box", home, (box.X_SB * Pose{box.half[axis] * n_B, Quat::Identity()}).p,
              box.X_SB.q * n_B);
}

Way onto(const CylinderSpec& cylinder, const Pose& home) {
  const Vec3 from = home.p - cylinder.at;
  const double height = cylinder.axis.dot(from);
  const Vec3 across = from - height * cylinder.axis;
  const Vec3 n = across.norm() > 1e-6 ? Vec3(across.normalized()) : cylinder.axis.unitOrthogonal();
  if (!cylinder.hole) return onto("cylinder", home, cylinder.at + cylinder.radius * n, n);
  const Vec3 out = std::copysign(1.0, height) * cylinder.axis;
  const Vec3 above = cylinder.at + (cylinder.half_length + kAway) * out;
  const Vec3 wall = cylinder.at + (cylinder.radius + kDeep) * n;
  const Vec3 along = std::min(kSlide, 0.5 * cylinder.half_length) * out;
  return {"cylinder",
          looking(home, -out),
          {{above}, {cylinder.at}, {wall}, {wall + along}, {cylinder.at + along}, {above}}};
}

Way into(const HexSocketSpec& socket, const Pose& home) {
  const Vec3 z = socket.X_SK.q * Vec3::UnitZ();
  const Vec3 above = socket.X_SK.p + kAway * z;
  const Vec3 in = socket.X_SK.p - (socket.depth + kDeep) * z;
  // One of the six ways in which a key fits, the one nearest to home.
  const Quat wish = looking(home, -z);
  Quat best = wish;
  double least = std::numeric_limits<double>::infinity();
  for (int i = 0; i < 6; ++i) {
    const Quat q =
        socket.X_SK.q * Quat(0.0, 1.0, 0.0, 0.0) * rotation_exp(Vec3(0, 0, i * 60.0 * kDeg));
    if (angle_between(q, wish) >= least) continue;
    least = angle_between(q, wish);
    best = q;
  }
  return {"hex_socket", best, {{above}, {in}, {in, kTurn}, {above, kTurn}, {above}}};
}

Way way_of(const Simulate& list, const Pose& home) {
  if (const auto* socket = list.find<HexSocketSpec>()) return into(*socket, home);
  for (const RigEffectSpec& effect : list.effects) {
    if (const auto* plane = std::get_if<PlaneSpec>(&effect)) return onto(*plane, home);
    if (const auto* box = std::get_if<BoxSpec>(&effect)) return onto(*box, home);
    if (const auto* cylinder = std::get_if<CylinderSpec>(&effect)) return onto(*cylinder, home);
  }
  return {"air", home.q, {{home.p}, {home.p + Vec3(0, kAway, 0)}, {home.p}}};
}

bool within_limits(const JointVector& q) {
  const JointLimits& limits = rv2a_limits();
  return (q.array() >= limits.lower.array()).all() && (q.array() <= limits.upper.array()).all();
}

}  // namespace

Simulate simulated_by(const Scene& scene) {
  if (scene.simulate) return *scene.simulate;
  return {{ServoLagSpec(), EncoderOffsetsSpec(), SensorNoiseSpec(), SensorSaturationSpec()}};
}

Result<PressCourse> press_course(const Scene& scene) {
  const ArmGeometry arm = arm_of(scene);
  JointVector q = ServoArmOptions::default_start();
  const Way way = way_of(simulated_by(scene), forward(arm, q));
  PressCourse out;
  for (std::size_t i = 0; i < way.stops.size(); ++i) {
    const Stop& to = way.stops[i];
    const Stop& from = way.stops[i == 0 ? 0 : i - 1];
    const double time =
        std::max((to.p_S - from.p_S).norm() / kSpeed, std::abs(to.turn - from.turn) / kTurnSpeed);
    const int count = static_cast<int>((time + kRest) / kCycle) + 1;
    for (int k = 1; k <= count; ++k) {
      const double share = time > 0.0 ? std::min(k * kCycle / time, 1.0) : 1.0;
      const double turn = from.turn + share * (to.turn - from.turn);
      const Pose X{from.p_S + share * (to.p_S - from.p_S),
                   way.q_ST * rotation_exp(Vec3(0, 0, turn))};
      if (inverse_near(arm, X, q, q) != InverseStatus::kOk || !within_limits(q)) {
        return Status::error(fmt::format("the arm cannot reach {}: ({:.1f}, {:.1f}, {:.1f}) mm",
                                         way.what, X.p.x() / kMm, X.p.y() / kMm, X.p.z() / kMm));
      }
      out.q.push_back(q);
      out.X_ST.push_back(X);
    }
  }
  return out;
}

namespace {

RigOptions options_of(const Scene& scene, const PressCourse& course) {
  Scene listed = scene;
  listed.simulate = simulated_by(scene);
  RigOptions out;
  run_only_listed(listed, out);
  out.controller.arm.q_start = course.q.front();
  return out;
}

}  // namespace

PressRun::PressRun(const Scene& scene, const PressCourse& course)
    : course_(&course), rig_(options_of(scene, course), 0) {
  rig_.sensor().on_datagram(encode_rdt(RdtRequest{RdtCommand::kStream, 0}), 1);
}

void PressRun::tick() noexcept {
  now_ += kMillisecond;
  while (rig_.next() <= now_) {
    if (rig_.step(now_) != RigEvent::kControl) continue;
    if (++at_ == course_->q.size()) {
      at_ = 0;
      ++rounds_;
    }
    rig_.controller().arm().command(course_->q[at_]);
  }
}

PressResult run_press(const Scene& scene, const PressCourse& course) {
  PressRun run(scene, course);
  PressResult out;
  double sum = 0.0, tip_off = 0.0, read_off = 0.0, sensor_off = 0.0;
  int touching = 0, records = 0, count = 0;
  for (; run.rounds() == 0; ++count) {
    run.tick();
    const World* world = run.rig().world();
    const Vec3 force = world != nullptr ? world->on_tip().force : Vec3(Vec3::Zero());
    const Pose tip = run.rig().true_tip();
    out.peak = std::max(out.peak, force.norm());
    if (force.norm() > 2.0) {
      sum += force.norm();
      ++touching;
    }
    tip_off += (tip.p - run.led().p).squaredNorm();
    const ServoArm& arm = run.rig().controller().arm();
    read_off += (forward(arm.geometry(), arm.measured()).p - tip.p).squaredNorm();
    if (const auto& record = run.rig().sensor().record()) {
      const auto decoded = decode_rdt_record(record->bytes);
      const FtSourceOptions scale;
      Vec3 told;
      for (int i = 0; i < 3; ++i) {
        told[i] = decoded->counts[static_cast<std::size_t>(i)] / scale.counts_per_n;
      }
      sensor_off += (told - tip.q.conjugate() * force).squaredNorm();
      ++records;
    }
    if (world != nullptr) out.screw = world->screw_angle();
  }
  out.mean = touching > 0 ? sum / touching : 0.0;
  out.tip_off = std::sqrt(tip_off / std::max(count, 1));
  out.read_off = std::sqrt(read_off / std::max(count, 1));
  out.sensor_off = std::sqrt(sensor_off / std::max(records, 1));
  return out;
}

}  // namespace handrail
