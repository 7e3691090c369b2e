// Tools called while the hand stands.
#include <algorithm>
#include <array>

#include "server/lab/faults/fault_rows.h"

namespace handrail::rows {
namespace {

ToolCall point_at(const Vec3& p_SA) {
  ToolCall call;
  call.kind = ToolKind::kPoint;
  call.at_present = false;
  call.p_SA = p_SA;
  return call;
}

// Each part up to `size` either way.
Vec3 any_vector(Random& random, double size) {
  Vec3 v;
  for (int k = 0; k < 3; ++k) v[k] = size * (2.0 * random.uniform() - 1.0);
  return v;
}

ToolCall tool_anywhere(Random& random, const Vec3& p) {
  const auto any = [&random](double size) { return any_vector(random, size); };
  ToolCall call;
  call.kind = std::array{ToolKind::kPoint, ToolKind::kLine, ToolKind::kPlane,
                         ToolKind::kFRotation}[static_cast<std::size_t>(4.0 * random.uniform())];
  call.at_present = false;
  call.p_SA = p + any(random.uniform() < 0.5 ? 0.02 : 0.6);
  call.direction_S = any(1.0);
  call.normal_S = any(1.0);
  call.has_axis = true;
  call.axis_S = any(1.0);
  call.has_end = random.uniform() < 0.3;
  call.p_SE = p + any(0.6);
  return call;
}

constexpr double kCallReach = 0.020;  // of the scene [m]
constexpr double kRounding = 1e-5;    // of what the arm comes to rest by [m]
constexpr double kThere = 1e-3;       // an arm this near its command reaches it [m]

// A run whose hand stands but while it is pulled, and what moved by itself meanwhile.
class StillHand {
 public:
  explicit StillHand(const RowRun& row) : run_(row) {
    run_.layers().hand = [this](Nanos, HandReading& hand) {
      if (!still_) held_ = hand;
      hand = held_;
      hand.v_MH.setZero();
      hand.clutch_button = clutched_;
    };
  }

  // Engages, and stands from then on. False: it did not.
  bool begin() {
    if (!run_.engage()) return false;
    still_ = true;
    run_.run(kSecond);
    home_ = run_.auditor().tip();
    middle_ = held_.X_MH.p;
    return true;
  }

  // The first tool moves the arm for certain. How long it is to be left alone.
  Nanos call_tool(bool first, bool approach) {
    HapticOrder order = order_of(OrderKind::kTool);
    order.tool = tool_anywhere(run_.random(), home_);
    if (first) order.tool = point_at(home_ + Vec3(0.0, 0.0, -0.01));
    order.tool.approach = approach;
    run_.tick(order);
    return from_seconds(0.5 + run_.random().uniform());
  }

  // Off the tool by hand; then another, or none, takes its place.
  void pull_off(Nanos wait, int call) {
    stay(wait);
    approached_ = std::max(approached_, way_from(home_));
    pull(middle_ + any_vector(run_.random(), 0.02));
    HapticOrder other = order_of(call % 4 < 2 ? OrderKind::kToolOff : OrderKind::kTool);
    other.tool.kind = call % 4 == 2 ? ToolKind::kPlane : ToolKind::kLine;
    other.tool.normal_S = other.tool.direction_S = any_vector(run_.random(), 1.0);
    run_.tick(other);
    stay(3 * kSecond);
  }

  // On the way to the tool.
  void hold_clutch(Nanos wait) {
    run_.run(wait);
    approached_ = std::max(approached_, way_from(home_));
    clutched_ = true;
    run_.run(500 * kMillisecond);
    home_ = run_.auditor().tip();
    const Vec3 still_asked = asked();
    const double behind = run_.auditor().behind();
    clutched_ = false;
    run_.run(kSecond);
    crept_ = std::max({crept_, (asked() - still_asked).norm(), run_.auditor().behind() - behind});
  }

  void drop_tools() {
    run_.tick(order_of(OrderKind::kToolOff));
    stay(kSecond);
  }

  FaultOutcome judge(double bound) {
    FaultOutcome out = run_.outcome();
    measure(out, 1e3 * std::max(furthest_, crept_), 1e3 * bound);
    find(out, furthest_ > kCallReach + kRounding, "further by itself than a tool may be called");
    find(out, crept_ > kRounding, "went on after the clutch");
    find(out, approached_ < 0.001, "no tool moved anything");
    return out;
  }

 private:
  double way_from(const Vec3& p) { return (run_.auditor().tip() - p).norm(); }
  Vec3 asked() { return run_.cell().master().link.X_SU.p; }

  // Out of reach an arm goes on sliding towards its command: there the command alone is judged.
  void stay(Nanos wait) {
    home_ = run_.auditor().tip();
    const Vec3 sent = asked();
    const bool there = (sent - home_).norm() < kThere;
    for (const Nanos end = run_.now() + wait; run_.now() < end;) {
      run_.tick();
      furthest_ = std::max({furthest_, (asked() - sent).norm(), there ? way_from(home_) : 0.0});
    }
  }

  void pull(const Vec3& p_MH) {
    const Vec3 step = (p_MH - held_.X_MH.p) / 1000.0;
    for (int i = 0; i < 1000; ++i) {
      held_.X_MH.p += step;
      run_.tick();
    }
    run_.run(3 * kSecond);
  }

  FaultRun run_;
  bool still_ = false, clutched_ = false;
  HandReading held_;
  Vec3 home_ = Vec3::Zero(), middle_ = Vec3::Zero();  // tip, hand
  double furthest_ = 0.0, crept_ = 0.0, approached_ = 0.0;
};

}  // namespace

// Tools called anywhere while the hand stands still. In every other run the hand is then pulled off
// the tool, and stands still while another tool, or none, takes its place. In the others they are
// approached, and the clutch is held on the way. When it is let go the command stays, and an arm
// that cannot reach it goes no further from it.
FaultOutcome x2c(const RowRun& row) {
  const bool pulled = row.index % 2 == 0;
  StillHand hand(row);
  if (!hand.begin()) return not_engaged();
  for (int call = 0; call < 20; ++call) {
    const Nanos wait = hand.call_tool(call == 0, !pulled);
    if (pulled) {
      hand.pull_off(wait, call);
    } else {
      hand.hold_clutch(wait);
    }
    hand.drop_tools();
  }
  return hand.judge(pulled ? kCallReach : 0.0);
}

}  // namespace handrail::rows
