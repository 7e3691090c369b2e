#include "server/lab/cell/cell.h"

#include <algorithm>

#include "devices/net_ft/rdt_packet.h"

namespace handrail {
namespace {

constexpr PeerId kSlave = 1;
constexpr Nanos kRepeat = kMillisecond;  // between two sends of the slave's IO, as in its daemon

}  // namespace

Cell::Cell(const CellOptions& options)
    : options_(options),
      rig_(options.rig, 0),
      client_({options.packet_bytes, options.rig.controller.period}),
      to_slave_(options.transit, options.tick),
      to_master_(options.transit, kRepeat),
      net_(options.net ? std::make_unique<CellNet>(*options.net) : nullptr),
      line_(options.robot_line ? std::make_unique<RobotLine>(*options.robot_line) : nullptr),
      repeat_next_(kRepeat) {
  if (net_) {
    begin_epochs(options_.epoch.value_or(net_->master().session()), haptic_);
    follow_.fault_epoch = options_.epoch.value_or(net_->slave().session());
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
    net_->send_master(now_, instead_ != nullptr ? *instead_ : haptic_out_.link, haptic_made_);
  } else {
    to_slave_.send(haptic_out_.link, now_);
  }
}

void Cell::step_master(const HandReading& hand, const HapticOrder& order) noexcept {
  haptic_made_ = now_;
  haptic_in_.unseen = now_ - master_at_;
  master_at_ = now_;
  haptic_in_.hand = hand;
  haptic_in_.order = order;
  hear_slave();
  haptic_step(options_.haptic, haptic_in_, to_seconds(options_.tick), haptic_, haptic_out_);
}

void Cell::hear_slave() noexcept {
  if (!net_) {
    haptic_in_.slave_known |= to_master_.receive(now_, haptic_in_.slave);
    haptic_in_.slave_age = to_master_.age(now_);
    return;
  }
  const LinkSnapshot& link = net_->master().snapshot();
  haptic_in_.slave_known = link.peer_epoch != 0;
  haptic_in_.slave = net_->master().newest();
  haptic_in_.slave_age = link.age(net_->master_now(now_));
  haptic_in_.link = link.view(net_->master_now(now_));
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

void Cell::restart_master() {
  net_->restart_master();
  haptic_ = HapticState();
  haptic_out_ = HapticOutput();
  haptic_in_ = HapticInput();
  master_at_ = now_;
  begin_epochs(options_.epoch.value_or(net_->master().session()), haptic_);
}

void Cell::restart_slave() {
  net_->restart_slave();
  follow_ = FollowState();
  follow_.fault_epoch = options_.epoch.value_or(net_->slave().session());
  follow_in_ = FollowInput();
  follow_out_ = FollowOutput();
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
  if (!follow_.placed) {
    if (event != RobotEvent::kReply) return;
    place(options_.follow, reply_.q_commanded, follow_);
  }
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
  follow_step(options_.follow, follow_in_, follow_, follow_out_);
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
