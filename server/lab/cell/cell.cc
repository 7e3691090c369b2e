#include "server/lab/cell/cell.h"

#include <algorithm>

#include "devices/net_ft/rdt_packet.h"

namespace handrail {
namespace {

constexpr PeerId kSlave = 1;
constexpr Nanos kRepeat = kMillisecond;  // between two sends of the slave's IO, as in its daemon

KeptTiming timing_of(const LinkSnapshot& link) {
  return {link.received_at, link.peer_sent, link.round_trip};
}

// Both sides have one clock.
template <typename State>
KeptTiming timing_of(const Wire<State>& wire, Nanos now) {
  const Nanos age = wire.age(now);
  if (age >= kForever) return {};
  return {now - age, now - age - wire.transit(), 2 * wire.transit()};
}

}  // namespace

Cell::Cell(const CellOptions& options)
    : options_(options),
      rig_(options.rig, 0),
      client_({options.packet_bytes, options.rig.controller.period}),
      run_({options_.haptic, nullptr, kCellScene}),
      to_slave_(options.transit, options.tick),
      to_master_(options.transit, kRepeat),
      net_(options.net ? std::make_unique<CellNet>(*options.net) : nullptr),
      line_(options.robot_line ? std::make_unique<RobotLine>(*options.robot_line) : nullptr),
      repeat_next_(kRepeat) {
  given_.dt = to_seconds(options.tick);
  if (net_) {
    begin_master();
    begin_slave();
  }
  to_controller(client_.start(0));
  rig_.sensor().on_datagram(encode_rdt(RdtRequest{RdtCommand::kStream, 0}), kSlave);
}

void Cell::tick(const HandReading& hand, const HapticOrder& order) noexcept {
  now_ += options_.tick;
  sent_count_ = target_count_ = controller_cycle_count_ = 0;
  robot_cycle_ = false;
  run_rig();
  if (net_) net_->deliver(now_);
  if (!master_stalled_ && !(net_ && net_->master_stopped())) step_master(hand, order);
  if (net_) {
    net_->send_master(now_, instead_ != nullptr ? *instead_ : master().link, haptic_made_);
  } else {
    to_slave_.send(master().link, now_);
  }
}

void Cell::step_master(const HandReading& hand, const HapticOrder& order) noexcept {
  haptic_made_ = now_;
  given_.in.unseen = now_ - master_at_;
  master_at_ = now_;
  given_.in.hand = hand;
  given_.in.order = order;
  hear_slave();
  keeper_.before_tick(now_, run_);
  run_.tick(given_);
  keeper_.after_tick(net_ ? net_->master_now(now_) : now_, given_,
                     net_ ? timing_of(net_->master().snapshot()) : timing_of(to_master_, now_),
                     run_);
}

void Cell::hear_slave() noexcept {
  if (!net_) {
    given_.in.slave_known |= to_master_.receive(now_, given_.in.slave);
    given_.in.slave_age = to_master_.age(now_);
    return;
  }
  const LinkSnapshot& link = net_->master().snapshot();
  given_.in.slave_known = link.peer_epoch != 0;
  given_.in.slave = net_->master().newest();
  given_.in.slave_age = link.age(net_->master_now(now_));
  given_.in.link = link.view(net_->master_now(now_));
}

void Cell::hear_master(Nanos at) noexcept {
  if (!net_) {
    follow_in_.master_known |= to_slave_.receive(at, follow_in_.master);
    follow_in_.master_age = to_slave_.age(at);
    return;
  }
  const LinkSnapshot& link = net_->slave().snapshot();
  follow_in_.master_known = link.peer_epoch != 0;
  follow_in_.master = net_->slave().newest();
  follow_in_.master_age = link.age(net_->slave_now(at));
  follow_in_.master_sequence = link.sequence;
  follow_in_.link = link.view(net_->slave_now(at));
}

void Cell::begin_master() noexcept {
  const std::uint64_t unique = options_.epoch.value_or(net_->master().session());
  run_.begin(unique);
  keeper_.master_begins(unique);
}

void Cell::begin_slave() noexcept {
  follow_.fault_epoch = options_.epoch.value_or(net_->slave().session());
  keeper_.slave_begins(follow_.fault_epoch);
}

void Cell::restart_master() {
  net_->restart_master();
  run_ = HapticRun(run_.scene());
  given_.in = HapticInput();
  master_at_ = now_;
  begin_master();
}

void Cell::restart_slave() {
  net_->restart_slave();
  follow_ = FollowState();
  follow_in_ = FollowInput();
  follow_out_ = FollowOutput();
  begin_slave();
  reply_ = RobotReply();
  to_controller(client_.start(at_));
}

// What is due until now, in the order of its time. The slave's IO comes last at any instant, after
// the master's step: one that falls on a tick waits for the next.
void Cell::run_rig() noexcept {
  for (;;) {
    const Nanos at = rig_.next();
    if (net_) {
      const Nanos due = net_->next_due();
      if (due <= at && due <= repeat_next_ && due <= now_) {
        at_ = std::max(at_, due);
        net_->deliver(due);
        continue;
      }
    }
    if (const Nanos due = robot_due(); due <= at && due <= repeat_next_ && due <= now_) {
      at_ = due;
      run_line(due);
      continue;
    }
    if (repeat_next_ < at && repeat_next_ < now_) {
      at_ = std::max(at_, repeat_next_);
      if (net_) {
        net_->deliver(repeat_next_);
        net_->send_slave(repeat_next_, follow_out_.link, follow_made_);
      } else {
        to_master_.send(follow_out_.link, repeat_next_);
      }
      repeat_next_ += kRepeat;
      continue;
    }
    if (at > now_) break;
    at_ = std::max(at_, at);
    const RigEvent event = rig_.step(at);
    if (event == RigEvent::kSensor && !slave_stopped()) read_sensor(at);
    if (event == RigEvent::kControl) on_control(at);
  }
}

// When something is due between the slave and the controller.
Nanos Cell::robot_due() const noexcept {
  Nanos due = line_ ? line_->to_robot.next_due() : kForever;
  if (!slave_stopped()) {
    if (client_.open()) due = std::min(due, client_.deadline());
    if (line_) due = std::min(due, line_->to_slave.next_due());
  }
  return std::max(due, at_);
}

// As the driver does: everything that waits first, then the clock.
void Cell::run_line(Nanos at) noexcept {
  bool replied = false;
  if (line_) {
    std::array<std::uint8_t, kMxtLong> bytes;
    line_->to_robot.clear_deliveries();
    line_->to_robot.advance(at);
    while (const std::size_t size = line_->to_robot.receive(bytes, at)) {
      rig_.controller().on_datagram(std::span(bytes).first(size), kSlave);
    }
    if (slave_stopped()) return;
    line_->to_slave.clear_deliveries();
    line_->to_slave.advance(at);
    while (const std::size_t size = line_->to_slave.receive(bytes, at)) {
      const auto event = client_.on_datagram(std::span(bytes).first(size), at, reply_);
      replied = replied || event == RobotEvent::kReply;
    }
  }
  if (replied) return on_event(RobotEvent::kReply, at);
  const auto event = client_.poll(at, reply_);
  if (client_.opening() && event) to_controller(client_.packet());
  if (event) on_event(*event, at);
}

void Cell::on_control(Nanos at) noexcept {
  robot_cycle_ = true;
  robot_cycle_at_ = at;
  const Controller& controller = rig_.controller();
  if (controller_cycle_count_ < controller_cycles_.size()) {
    const bool took = controller.session() && controller.t_count() == 0;
    controller_cycles_[controller_cycle_count_++] = {at, took, controller.arm().target()};
  }
  for (const Controller::Outgoing& packet : controller.replies()) {
    if (line_) {
      line_->to_slave.send(packet.bytes(), at);
    } else if (!slave_stopped() &&
               client_.on_datagram(packet.bytes(), at, reply_) == RobotEvent::kReply) {
      on_event(RobotEvent::kReply, at);
    }
  }
}

void Cell::read_sensor(Nanos at) noexcept {
  const auto& record = rig_.sensor().record();
  if (!record) return;
  const auto decoded = decode_rdt_record(record->bytes);
  follow_in_.wrench_valid = decoded && decoded->status == 0;
  follow_in_.wrench_overrange = decoded && overrange(*decoded);
  if (!follow_in_.wrench_valid) return;
  const FtSourceOptions& scale = options_.rig.sensor;
  for (int i = 0; i < 3; ++i) {
    const auto k = static_cast<std::size_t>(i);
    follow_in_.f_E_T.force[i] = decoded->counts[k] / scale.counts_per_n;
    follow_in_.f_E_T.torque[i] = decoded->counts[k + 3] / scale.counts_per_n_m;
  }
  if (tap_ != nullptr) tap_->on_force(at, follow_in_.f_E_T, follow_in_.wrench_valid);
}

void Cell::on_event(RobotEvent event, Nanos at) noexcept {
  if (reply_.fresh && tap_ != nullptr) tap_->on_reply(at, reply_);
  const bool placed = !follow_.placed;
  if (placed && event != RobotEvent::kReply) return;
  follow_in_.q_measured = reply_.q_measured;
  follow_in_.q_commanded = reply_.q_commanded;
  follow_in_.has_measured = reply_.has_measured;
  follow_in_.has_commanded = reply_.has_commanded;
  follow_in_.answer = event == RobotEvent::kLost || !reply_.fresh ? Answer::kNone
                      : reply_.prompt                             ? Answer::kOnTime
                                                                  : Answer::kLate;
  follow_in_.cycles = reply_.cycles;
  follow_in_.anew = reply_.anew;
  follow_in_.robot_ready = event != RobotEvent::kLost;
  follow_in_.fault = event == RobotEvent::kLost ? Reason::kRobotLost : Reason::kNone;
  follow_in_.unseen = at - stepped_at_;
  stepped_at_ = at;
  hear_master(at);
  follow_made_ = at;
  keeper_.before_cycle(at, follow_, follow_out_);
  if (placed) place(options_.follow, reply_.q_commanded, follow_);
  follow_step(options_.follow, follow_in_, follow_, follow_out_);
  keeper_.after_cycle(
      net_ ? net_->slave_now(at) : at, placed ? &reply_.q_commanded : nullptr, follow_in_,
      net_ ? timing_of(net_->slave().snapshot()) : timing_of(to_slave_, at), follow_out_);
  follow_in_.stop_input = stop_open_;
  if (follow_out_.send == Send::kQuestion) to_controller(client_.ask());
  if (follow_out_.send != Send::kTarget) return;
  target_at_ = at;
  if (target_count_ < targets_.size()) targets_[target_count_++] = follow_out_.q_target;
  to_controller(client_.send(follow_out_.q_target, at));
}

void Cell::to_controller(MxtClient::Bytes bytes) noexcept {
  if (bytes.empty()) return;
  if (line_) {
    line_->to_robot.send(bytes, at_);
  } else {
    rig_.controller().on_datagram(bytes, kSlave);
  }
  MxtPacket packet;
  if (sent_count_ < sent_.size() && decode_mxt_request(bytes, packet) == MxtParse::kOk &&
      packet.command == MxtCommand::kMove) {
    sent_[sent_count_++] = packet.block[0].joints();
  }
}

}  // namespace handrail
