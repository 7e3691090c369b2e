// Both daemons in virtual time, without sockets, threads or sleeping: the order desk and the haptic
// loop, the daemons' peers and datagrams over a made-up network, the robot loop and a scripted arm.
// A round is a millisecond.
#pragma once

#include <google/protobuf/text_format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>

#include "devices/omni/omni_data.h"
#include "server/lab/cell/cell_net.h"
#include "server/link/stall_watch.h"
#include "server/master/haptic_loop.h"
#include "server/master/haptic_settings.h"
#include "server/master/order_desk.h"
#include "server/master/wall_runs.h"
#include "server/scene/scene_library.h"
#include "server/slave/follow_settings.h"
#include "server/slave/robot_loop.h"
#include "tests/unit/master/scripted_device.h"

namespace handrail {

// An arm that is where it was told to be, behind a controller that can be away, silent or wrong.
class ScriptedArm : public Robot {
 public:
  static constexpr Nanos kCycle = 7'100'000;                // of the controller
  static constexpr Nanos kLostAfter = 1400 * kMillisecond;  // of silence, as the driver has it
  static constexpr Nanos kAnew = 100 * kMillisecond;        // of silence: it may be another one

  enum class State : std::uint8_t { kThere, kAway, kZeros };

  const RobotCapabilities& capabilities() const override { return capabilities_; }
  Status connect(Nanos patience, RobotReply& first) override {
    busy_for = state == State::kAway ? patience : 0;
    if (state == State::kAway) return Status::error("no answer");
    silent_for_ = 0;
    answer(first);
    return Status::ok();
  }
  RobotEvent wait(RobotReply& reply) noexcept override {
    reply.cycles = 1;
    if (state == State::kAway) {
      silent_for_ += kCycle;
      reply.fresh = reply.prompt = reply.has_measured = reply.has_commanded = false;
      reply.anew = silent_for_ > kAnew;
      return silent_for_ > kLostAfter ? RobotEvent::kLost : RobotEvent::kSilence;
    }
    answer(reply);
    reply.anew = silent_for_ > kAnew;
    silent_for_ = 0;
    return RobotEvent::kReply;
  }
  void send(const JointVector& q_target) noexcept override {
    if (state == State::kThere) q = q_target;
  }
  void ask() noexcept override {}
  void end() noexcept override {}

  State state = State::kThere;
  Nanos busy_for = 0;  // what the last connect() took
  JointVector q = (JointVector() << 0, 0, 1.5707963, 0, 1.5707963, 0).finished();

 private:
  void answer(RobotReply& reply) const noexcept {
    reply.q_measured = reply.q_commanded = state == State::kZeros ? JointVector::Zero() : q;
    reply.has_measured = reply.has_commanded = reply.fresh = reply.prompt = true;
  }
  RobotCapabilities capabilities_{"scripted arm", kCycle};
  Nanos silent_for_ = 0;
};

class TwoSides {
 public:
  static constexpr const char* kArm = "linear-movement";  // scenes that are shipped
  static constexpr const char* kWalls = "painted-aisle";

  // `seed`: of the network.
  explicit TwoSides(Presence presence = Presence::kNone, const char* scene = kArm,
                    std::uint64_t seed = 1)
      : presence_(presence), scene_(scene), net_(CellNetOptions{seed}) {
    clock() = 1000 * kSecond;
    device.sample.valid = true;
    start_master();
    start_slave();
  }

  static Nanos now() noexcept { return clock(); }
  void run(Nanos span) {
    for (const Nanos end = now() + span; now() < end;) round();
  }

  // What an operator is answered: "done: ..." or "refused: ...", once it is.
  std::string ask(const std::string& text) {
    pb::Request request;
    EXPECT_TRUE(google::protobuf::TextFormat::ParseFromString(text, &request)) << text;
    if (!request.has_as()) request.set_as(who);
    auto answer = std::make_shared<std::optional<pb::Reply>>();
    desk_->handle(request, [answer](pb::Reply reply) { *answer = std::move(reply); }, {});
    for (const Nanos patience = now() + 15 * kSecond; !*answer && now() < patience;) round();
    if (!*answer) return "(no answer)";
    last_ = **answer;
    return (last_.done() ? "done: " : "refused: ") + last_.reason();
  }
  // Gives an order that nobody waits for.
  void begin(const std::string& text) {
    pb::Request request;
    EXPECT_TRUE(google::protobuf::TextFormat::ParseFromString(text, &request)) << text;
    request.set_as(who);
    desk_->handle(request, [](pb::Reply) {}, {});
  }
  bool done(const std::string& text) { return ask(text).starts_with("done: "); }
  pb::Status status() {
    EXPECT_TRUE(done("status: true"));
    return last_.status();
  }
  bool led() {
    const pb::Status s = status();
    return s.state() == "engaged" && s.slave_state() == "engaged";
  }

  // SIGKILL, and another start.
  void start_master() {
    desk_.reset();
    loop_.reset();
    boxes_ = std::make_unique<MasterMailboxes>();
    news_ = LoopNews();
    if (now() > 1000 * kSecond) net_.restart_master();
    const Result<Scene> scene = library_.load(scene_);
    ASSERT_TRUE(scene.is_ok()) << scene.message();
    OrderDeskOptions options;
    options.presence = presence_;
    options.load_scene = [this](const std::string& name) { return library_.load(name); };
    options.loop_scene = [this](const Scene& s) { return loop_scene(s); };
    desk_ = std::make_unique<OrderDesk>(*boxes_, *scene, options);
    loop_ = std::make_unique<HapticLoop>(device, loop_scene(*scene), *boxes_, now());
    holds = false;
  }
  void start_slave() {
    if (slave_) net_.restart_slave();
    slave_boxes_ = std::make_unique<SlaveMailboxes>();
    slave_ = std::make_unique<RobotLoop>(arm, follow_settings_of(kArm), *slave_boxes_, clock_now);
    slave_report_ = SlaveReport();
    slave_known_ = false;
    robot_due_ = now();
  }
  void end_slave() { slave_.reset(); }
  bool slave_runs() const { return slave_ != nullptr; }
  LinkFaults& to_slave() { return net_.link().to_slave().faults; }
  LinkFaults& to_master() { return net_.link().to_master().faults; }
  void cut_network(bool cut) { to_slave().loss = to_master().loss = cut ? 1.0 : 0.0; }
  void cut_way_to_slave(bool cut) { to_slave().loss = cut ? 1.0 : 0.0; }
  bool by_button() const { return presence_ == Presence::kButton; }
  // The slave holds another scene, and has no file of the master's.
  void give_slave_the_scene(bool has) {
    slave_has_scene_ = has;
    FollowSettings other = follow_settings_of(kArm);
    if (!has) other.scene = scene_name("another");
    slave_boxes_->settings.publish(other);
  }

  std::string who = "anna";
  ScriptedArm arm;
  ScriptedDevice device;
  bool sensor = true;             // sound
  bool master_stalls = false;     // its haptic loop stands still
  bool other_master = false;      // leads the slave, which says so
  bool holds = false;             // `handrail engage --hold` runs
  std::function<void()> weather;  // changes the network, once a round; empty: it stays

 private:
  static Nanos& clock() noexcept {
    static Nanos value = 0;
    return value;
  }
  static Nanos clock_now() noexcept { return clock(); }

  LoopScene loop_scene(const Scene& scene) {
    LoopScene out{haptic_settings(scene, omni_capabilities(false)),
                  runs_.make(scene, omni_capabilities(false))};
    out.haptic.presence = presence_;
    out.haptic.ladder.good_for = kSecond;
    return out;
  }
  FollowSettings follow_settings_of(const std::string& name) {
    const Result<Scene> scene = library_.load(name);
    EXPECT_TRUE(scene.is_ok()) << scene.message();
    return follow_settings(*scene, ScriptedArm::kCycle, true, 1000.0);
  }

  void round() {
    clock() += kMillisecond;
    if (weather) weather();
    net_.deliver(now());
    if (slave_ && now() >= robot_due_) turn_robot();
    if (slave_) slave_io();
    if (!master_stalls) loop_->tick(now());
    master_io();
  }
  void turn_robot() {
    arm.busy_for = 0;
    const Nanos next = slave_->turn();
    robot_due_ = std::max(next, now() + (next == 0 ? ScriptedArm::kCycle : 0)) + arm.busy_for;
  }
  void slave_io() {
    // No two readings of a real sensor are alike.
    noise_ = -noise_ + 1e-3 * static_cast<double>(now() / kMillisecond % 7);
    Wrench f_E_T;
    f_E_T.force.z() = 0.1 * noise_;
    slave_boxes_->force.publish({f_E_T, sensor, false, now()});
    slave_boxes_->master.publish({net_.slave().newest(), net_.slave().snapshot()});
    slave_known_ = slave_boxes_->report.take(slave_report_) || slave_known_;
    if (!slave_known_) return;
    SlaveState told = slave_report_.state;
    follow_scene(told);
    if (other_master) return refuse();
    // While the loop waits for the controller, what it said stands.
    const Nanos made =
        now() < robot_due_ && arm.busy_for > 0 ? now() : slave_report_.good_until - kStateStands;
    net_.send_slave(now(), told, made);
  }
  void follow_scene(SlaveState& told) {
    const MasterState& master = net_.slave().newest();
    const std::string wanted(text_of(master.scene));
    const bool idle = told.state == SessionState::kOff || told.state == SessionState::kFault;
    if (wanted.empty() || !idle || first_difference(master, told) == Reason::kNone) return;
    if (slave_has_scene_) return slave_boxes_->settings.publish(follow_settings_of(wanted));
    if (told.state == SessionState::kOff) told.reason = Reason::kSceneNotLoaded;
  }
  // What a slave answers whose link another master has.
  void refuse() {
    std::array<std::uint8_t, kMaxDatagram> out{};
    const std::size_t size =
        codec_.encode(Refusal{net_.master().session(), false,
                              fixed_text<LeaderName>("process 4711 on this computer"), kSecond},
                      out);
    net_.link().to_master().inject(std::span(out).first(size), now());
  }
  void master_io() {
    boxes_->slave.publish({net_.master().newest(), net_.master().snapshot()});
    news_.take(*boxes_);
    desk_->tick(now(), news_, net_.master().newest(), net_.master().snapshot());
    if (holds && now() % (50 * kMillisecond) == 0) keep_holding();
    if (!news_.report()) return;
    const HapticReport& report = *news_.report();
    if (report.walls.present || other_master) return;
    net_.send_master(now(), report.out.link, report.good_until - kStateStands);
  }
  void keep_holding() {
    pb::Request request;
    request.set_as(who);
    request.set_hold_alive(true);
    desk_->handle(request, [this](const pb::Reply& reply) { holds = holds && reply.done(); }, {});
  }

  const Presence presence_;
  const std::string scene_;
  SceneLibrary library_;
  WallRuns runs_;
  CellNet net_;
  Codec codec_;
  std::unique_ptr<MasterMailboxes> boxes_;
  LoopNews news_;
  std::unique_ptr<OrderDesk> desk_;
  std::unique_ptr<HapticLoop> loop_;
  std::unique_ptr<SlaveMailboxes> slave_boxes_;
  std::unique_ptr<RobotLoop> slave_;
  SlaveReport slave_report_;
  bool slave_known_ = false;
  bool slave_has_scene_ = true;
  Nanos robot_due_ = 0;
  double noise_ = 1.0;
  pb::Reply last_;
};

}  // namespace handrail
