// Two masters and a slave through every order of stops, resets, faults, restarts and changes of
// who leads, over ways that delay and drop: nothing is confirmed, released or engaged but by who
// saw it. The test keeps its own account of what was said when; the steps see none of it.
#include <gtest/gtest.h>

#include <array>
#include <deque>
#include <map>
#include <memory>
#include <optional>

#include "server/base/random.h"
#include "tests/unit/follow/follow_rig.h"
#include "tests/unit/haptic/haptic_rig.h"

namespace handrail {
namespace {

using test::FollowRig;
using test::HapticRig;

// What the test writes on a slave's state: which start of it, when, and when it was told what.
struct SlaveNote {
  int start = -1;
  int made = -1;
  std::map<int, int> told;  // by a master's start: when the newest datagram taken from it was sent
};
// And on a master's: which start, when, and its operator's newest orders.
struct MasterNote {
  int start = -1;
  int sent = -1;
  int stopped = -1;
  int reset = -1;
  SlaveNote seen;  // newest before the reset
};

template <typename State, typename Note>
struct Way {
  struct Datagram {
    int due = 0;
    int sent = 0;
    State state;
    Note note;
  };
  std::deque<Datagram> under_way;
  int newest = -1;

  void send(Random& random, int now, const State& state, const Note& note) {
    if (random.uniform() < 0.1) return;
    under_way.push_back({now + 1 + static_cast<int>(12.0 * random.uniform()), now, state, note});
  }
  // The newest that has come and is newer than all before.
  std::optional<Datagram> take(int now) {
    std::optional<Datagram> out;
    for (auto it = under_way.begin(); it != under_way.end();) {
      if (it->due > now) {
        ++it;
        continue;
      }
      if (it->sent > newest) {
        newest = it->sent;
        out = *it;
      }
      it = under_way.erase(it);
    }
    return out;
  }
};

struct Master {
  HapticRig rig;
  MasterNote note;
  SlaveNote seen;
  int heard = -1000;
  int aligning_since = -1;
  Way<SlaveState, SlaveNote> in;
  Way<MasterState, MasterNote> out;
};

class EpochModel {
 public:
  explicit EpochModel(std::uint64_t seed) : random_(seed) {
    for (auto& master : masters_) start(master);
    start_slave();
  }

  void run(int steps) {
    for (int i = 0; i < steps; ++i) {
      happen();
      step();
    }
  }

  // Everything runs again: the operator's way back is a reset, or two when a fault came meanwhile.
  bool comes_back() {
    slave_->in.stop_input = false;
    const auto wait = [this](int steps) {
      for (int i = 0; i < steps; ++i) step();
    };
    const auto stuck = [this] {
      return masters_[0]->rig.session() == SessionState::kFault ||
             slave_->out.link.state == SessionState::kFault;
    };
    leader_ = 0;
    wait(300);
    for (int i = 0; i < 2 && stuck(); ++i) {
      give(*masters_[0], OrderKind::kReset);
      wait(100);
    }
    give(*masters_[0], OrderKind::kEngage);
    wait(200);
    return masters_[0]->rig.session() == SessionState::kEngaged &&
           slave_->out.link.state == SessionState::kEngaged;
  }

  int releases = 0, confirmed = 0, engaged = 0;

 private:
  double draw() { return random_.uniform(); }

  void start(std::unique_ptr<Master>& master) {
    auto fresh = std::make_unique<Master>();
    if (master) {
      fresh->in = master->in;  // what is under way arrives at its successor
      fresh->out = master->out;
    }
    master = std::move(fresh);
    master->rig.play_slave = false;
    master->rig.in.slave_known = false;
    master->rig.in.slave_age = kForever;
    master->note.start = ++starts_;
    begin_epochs(random_.bits(), *master->rig.state);
  }
  void start_slave() {
    slave_.emplace();
    slave_->state.fault_epoch = random_.bits();
    slave_note_ = SlaveNote();
    slave_note_.start = ++starts_;
    taken_ = MasterNote();
    taken_at_ = -1000;
    latched_ = -1;
  }

  static void give(Master& master, OrderKind kind) { master.rig.in.order.kind = kind; }

  void happen() {
    Master& any = *masters_[draw() < 0.7 ? leader_ : 1 - leader_];
    const double what = draw();
    if (what < 0.020) return give(any, OrderKind::kStop);
    if (what < 0.050) return give(any, OrderKind::kReset);
    if (what < 0.080) return give(any, OrderKind::kEngage);
    if (what < 0.090) return give(any, OrderKind::kDisengage);
    if (what < 0.095)
      slave_->in.fault = Reason::kRobotBadPacket;
    else if (what < 0.100)
      slave_->in.stop_input = !slave_->in.stop_input;
    else if (what < 0.103)
      start(masters_[draw() < 0.5 ? 0 : 1]);
    else if (what < 0.106)
      start_slave();
    else if (what < 0.110)
      leader_ = 1 - leader_;
  }

  void step() {
    ++now_;
    for (std::size_t i = 0; i < 2; ++i) step_master(*masters_[i]);
    step_slave();
  }

  void step_master(Master& master) {
    HapticRig& rig = master.rig;
    if (const auto news = master.in.take(now_)) {
      rig.in.slave = news->state;
      rig.in.slave_known = true;
      master.seen = news->note;
      master.heard = now_;
    }
    if (rig.in.slave_known) rig.in.slave_age = (now_ - master.heard) * kMillisecond;
    const OrderKind kind = rig.in.order.kind;
    const SessionState before = rig.session();
    rig.tick();
    const bool done = rig.out.order_result == Reason::kNone;
    if (kind == OrderKind::kStop && done) master.note.stopped = now_;
    if (kind == OrderKind::kReset && done) {
      master.note.reset = now_;
      master.note.seen = master.seen;
    }
    judge_confirmed(master);
    judge_engaged(master, before);
    master.note.sent = now_;
    master.out.send(random_, now_, rig.out.link, master.note);
  }

  // The slave that is seen was told by this start of the master after the order was given.
  bool knows(const Master& master, int since) const {
    const auto told = master.seen.told.find(master.note.start);
    return told != master.seen.told.end() && told->second >= since;
  }
  void judge_confirmed(Master& master) {
    if (!master.rig.in.slave_known ||
        master.rig.in.slave.stop_epoch != master.rig.out.link.stop_epoch) {
      return;
    }
    ++confirmed;
    EXPECT_TRUE(master.note.stopped >= 0 && knows(master, master.note.stopped))
        << "a stop was confirmed by an echo of another, step " << now_;
  }
  void judge_engaged(Master& master, SessionState before) {
    const SessionState state = master.rig.session();
    if (state == SessionState::kAligning && before != state) master.aligning_since = now_;
    if (before != SessionState::kAligning || !follows(state)) return;
    ++engaged;
    EXPECT_TRUE(knows(master, master.aligning_since))
        << "engaged by a slave that did not know of it, step " << now_;
  }

  void step_slave() {
    FollowRig& rig = *slave_;
    for (std::size_t i = 0; i < 2; ++i) {
      const auto news = masters_[i]->out.take(now_);
      if (!news || i != leader_) continue;
      rig.in.master = news->state;
      rig.in.master_known = true;
      taken_ = news->note;
      taken_at_ = now_;
    }
    if (taken_at_ >= 0) slave_note_.told[taken_.start] = taken_.sent;
    rig.in.master_age = (now_ - taken_at_) * kMillisecond;
    const SlaveState before = rig.out.link;
    rig.cycle();
    rig.in.fault = Reason::kNone;
    judge_release(before, rig.out.link);
    slave_note_.made = now_;
    masters_[leader_]->in.send(random_, now_, rig.out.link, slave_note_);
  }
  void judge_release(const SlaveState& before, const SlaveState& after) {
    if (after.fault_epoch != before.fault_epoch) latched_ = now_;
    if (before.state != SessionState::kFault || after.state == SessionState::kFault) return;
    ++releases;
    const bool saw = taken_.seen.start == slave_note_.start && taken_.seen.made >= latched_;
    EXPECT_TRUE(taken_.reset >= 0 && saw) << "released by who had not seen it, step " << now_;
    EXPECT_LE(taken_.stopped, taken_.reset) << "released while a stop stood, step " << now_;
  }

  Random random_;
  std::array<std::unique_ptr<Master>, 2> masters_;
  std::optional<FollowRig> slave_;
  SlaveNote slave_note_;
  MasterNote taken_;  // on the newest datagram the slave took
  int taken_at_ = -1000;
  int latched_ = -1;
  std::size_t leader_ = 0;
  int starts_ = 0;
  int now_ = 0;
};

TEST(EpochModel, NothingIsConfirmedReleasedOrEngagedButByWhoSawIt) {
  int releases = 0, confirmed = 0, engaged = 0;
  for (std::uint64_t seed = 1; seed <= 150; ++seed) {
    EpochModel model(seed);
    model.run(1500);
    releases += model.releases;
    confirmed += model.confirmed;
    engaged += model.engaged;
    ASSERT_FALSE(HasFailure()) << "seed " << seed;
  }
  EXPECT_GT(releases, 500);
  EXPECT_GT(confirmed, 500);
  EXPECT_GT(engaged, 500);
}

TEST(EpochModel, WhateverHappenedTwoResetsAndAnEngageLeadBack) {
  for (std::uint64_t seed = 1; seed <= 150; ++seed) {
    EpochModel model(seed);
    model.run(400);
    EXPECT_TRUE(model.comes_back()) << "seed " << seed;
  }
}

}  // namespace
}  // namespace handrail
