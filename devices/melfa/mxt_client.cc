#include "devices/melfa/mxt_client.h"

namespace handrail {

MxtClient::Bytes MxtClient::start(Nanos now) noexcept {
  open_ = true;
  held_command_ = MxtCommand::kNull;
  losses_ = 0;
  c_count_ = 0;
  last_reply_ = -kForever;
  deadline_ = now + 2 * options_.period;
  return write(MxtCommand::kNull);
}

std::optional<RobotEvent> MxtClient::on_datagram(Bytes bytes, Nanos now,
                                                 RobotReply& reply) noexcept {
  if (!open_) return RobotEvent::kLost;
  MxtPacket packet;
  const MxtBlock* measured = nullptr;
  const MxtBlock* commanded = nullptr;
  if (bytes.size() == options_.packet_bytes && decode_mxt_reply(bytes, packet) == MxtParse::kOk) {
    for (std::size_t b = packet.block.size(); b-- > 0;) {
      if (packet.type[b] == MxtType::kFeedbackJoint) measured = &packet.block[b];
      if (packet.type[b] == MxtType::kJoint) commanded = &packet.block[b];
    }
  }
  if (measured == nullptr) {
    ++counters_.rejected;
    return RobotEvent::kRejected;
  }
  reply.q_measured = measured->joints();
  reply.q_commanded = commanded != nullptr ? commanded->joints() : reply.q_measured;
  reply.missed_cycles = packet.t_count;
  if (now - last_reply_ < options_.same_cycle) {
    ++counters_.twins;
    return std::nullopt;
  }
  ++counters_.replies;
  losses_ = 0;
  last_reply_ = now;
  deadline_ = now + 2 * options_.period;
  return RobotEvent::kReply;
}

std::optional<RobotEvent> MxtClient::poll(Nanos now) noexcept {
  if (!open_) return RobotEvent::kLost;
  if (now < deadline_) return std::nullopt;
  if (++losses_ >= options_.max_losses) {
    open_ = false;
    return RobotEvent::kLost;
  }
  deadline_ = now + 2 * options_.period;
  ++counters_.repeats;
  write(held_command_);
  return RobotEvent::kSilence;
}

MxtClient::Bytes MxtClient::send(const JointVector& q_target) noexcept {
  if (!open_) return {};
  q_held_ = q_target;
  held_command_ = MxtCommand::kMove;
  return write(MxtCommand::kMove);
}

MxtClient::Bytes MxtClient::end() noexcept {
  if (!open_) return {};
  open_ = false;
  return write(MxtCommand::kEnd);
}

MxtClient::Bytes MxtClient::write(MxtCommand command) noexcept {
  MxtPacket packet;
  packet.command = command;
  packet.c_count = c_count_++;
  if (command == MxtCommand::kMove) {
    packet.send_type = MxtType::kJoint;
    packet.block[0].set_joints(q_held_);
  }
  if (command != MxtCommand::kEnd) packet.type = {MxtType::kFeedbackJoint, MxtType::kJoint};
  ++counters_.sent;
  packet_ = encode_mxt(packet, options_.packet_bytes, buffer_);
  return packet_;
}

}  // namespace handrail
