// What `why` names as the way out works, from every pair of troubles, one on top of the other.
#include <gtest/gtest.h>

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "devices/omni/omni_data.h"
#include "server/lab/cell/cell.h"
#include "server/master/haptic_settings.h"
#include "server/master/why_report.h"
#include "server/slave/follow_settings.h"

namespace handrail {
namespace {

// A force sensor that says nothing sound, or encoders that show what cannot be.
class BadDevice : public CellTap {
 public:
  bool force = false, encoder = false;
  void on_force(Nanos, Wrench&, bool& valid) noexcept override { valid = valid && !force; }
  void on_reply(Nanos, RobotReply& reply) noexcept override {
    if (encoder) reply.q_measured[2] += 1.0;
  }
};

// A cell whose hand is at rest, and an operator who does what `why` says.
class Operated {
 public:
  Operated() {
    Scene scene;
    scene.name = "test";
    scene.limits.joints = rv2a_limits();
    CellOptions options;
    options.haptic = haptic_settings(scene, omni_capabilities(false));
    options.follow = follow_settings(scene, options.rig.controller.period, true, 1000.0);
    options.rig.controller.arm.geometry.d6 = scene.tip_length;
    options.net = CellNetOptions();
    cell = std::make_unique<Cell>(options);
    cell->set_tap(&device);
  }

  Reason order(OrderKind kind) {
    HapticOrder order;
    order.kind = kind;
    cell->tick(hand(), order);
    return cell->master().order_result;
  }
  void run(Nanos span) {
    for (const Nanos end = cell->now() + span; cell->now() < end;) cell->tick(hand());
  }
  void lose(double share) {
    cell->net()->link().to_slave().faults.loss = share;
    cell->net()->link().to_master().faults.loss = share;
  }
  pb::Ledger why() const {
    HapticReport report;
    report.out = cell->master();
    const MasterPeer& peer = cell->net()->master();
    pb::Ledger out;
    set_ledger(&out, report, peer.newest(), peer.snapshot(), cell->net()->master_now(cell->now()));
    return out;
  }
  bool led() const {
    return cell->master().link.state == SessionState::kEngaged &&
           cell->slave().state == SessionState::kEngaged;
  }

  // One thing after the other, as the sentence has it. False with what was refused.
  bool follow(const std::string& way, std::string& refused) {
    const auto says = [&](const char* word) { return way.find(word) != std::string::npos; };
    if (says("stop circuit")) cell->open_stop_circuit(false);
    if (says("force sensor")) device.force = false;
    if (says("J3")) device.encoder = false;
    if (says("clutch")) order(OrderKind::kClutchOff);
    run(kSecond / 2);
    if (says("reset")) {
      if (const Reason r = order(OrderKind::kReset); r != Reason::kNone) {
        refused = std::string("reset: ") + describe(r);
        return false;
      }
      run(kSecond / 2);
    }
    if (!says("engage")) return true;
    // Engaging waits for a link that was good for a second, as the daemon does for ten.
    Reason r = Reason::kLinkQuality;
    for (int i = 0; i < 10 && (r == Reason::kLinkQuality || r == Reason::kNotConfirmed); ++i) {
      r = order(OrderKind::kEngage);
      run(kSecond / 4);
    }
    if (r != Reason::kNone) refused = std::string("engage: ") + describe(r);
    return r == Reason::kNone;
  }

  std::unique_ptr<Cell> cell;
  BadDevice device;

 private:
  static HandReading hand() {
    HandReading hand;
    hand.valid = true;
    return hand;
  }
};

struct WayOutTrouble {
  const char* name;
  std::function<void(Operated&)> comes;
};

const std::vector<WayOutTrouble>& way_out_troubles() {
  static const std::vector<WayOutTrouble> all = {
      {"disengaged", [](Operated& o) { o.order(OrderKind::kDisengage); }},
      {"clutched", [](Operated& o) { o.order(OrderKind::kClutchOn); }},
      {"stopped by the operator", [](Operated& o) { o.order(OrderKind::kStop); }},
      {"stop circuit open", [](Operated& o) { o.cell->open_stop_circuit(true); }},
      {"sensor not sound", [](Operated& o) { o.device.force = true; }},
      {"encoder jumps", [](Operated& o) { o.device.encoder = true; }},
      {"link dark for 0.5 s",
       [](Operated& o) {
         o.lose(1.0);
         o.run(kSecond / 2);
         o.lose(0.0);
       }},
      {"slave paused for 1.5 s",
       [](Operated& o) {
         o.cell->net()->stop_slave(true);
         o.run(3 * kSecond / 2);
         o.cell->net()->stop_slave(false);
       }},
      {"master stalls for 0.3 s",
       [](Operated& o) {
         o.cell->stall_master(true);
         o.run(3 * kSecond / 10);
         o.cell->stall_master(false);
       }},
      {"slave started anew", [](Operated& o) { o.cell->restart_slave(); }},
      {"master started anew", [](Operated& o) { o.cell->restart_master(); }},
  };
  return all;
}

TEST(WayOut, ThatWhyNamesWorksFromEveryPairOfTroubles) {
  constexpr int kSteps = 5;  // each of two troubles may be named in turn, and once more
  for (const WayOutTrouble& first : way_out_troubles()) {
    for (const WayOutTrouble& second : way_out_troubles()) {
      SCOPED_TRACE(std::string(first.name) + ", then " + second.name);
      Operated o;
      std::string refused;
      ASSERT_TRUE(o.follow("engage", refused)) << refused;
      o.run(kSecond / 2);
      ASSERT_TRUE(o.led());
      first.comes(o);
      o.run(kSecond / 4);
      second.comes(o);
      o.run(kSecond);
      std::string story;
      for (int step = 0; step < kSteps && !o.led(); ++step) {
        const pb::Ledger why = o.why();
        story += "\n" + why.sentence() + "; way out: " + why.way_out();
        ASSERT_FALSE(why.way_out().empty()) << story;
        // The second of two troubles may refuse what the first one's way out ends with.
        if (!o.follow(why.way_out(), refused)) story += "\n" + refused;
        o.run(kSecond / 2);
      }
      EXPECT_TRUE(o.led()) << story;
    }
  }
}

}  // namespace
}  // namespace handrail
