#include "devices/rig/controller.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "devices/rig/mxt_monitor.h"
#include "server/kinematics/rv2a.h"

namespace handrail {
namespace {

constexpr double kStepTolerance = 1.01;   // a step may exceed the joint's top speed by 1 %
constexpr double kRangeTolerance = 1e-6;  // a range's end survives the float32 of the wire [rad]

}  // namespace

const char* describe(AlarmKind kind) noexcept {
  switch (kind) {
    case AlarmKind::kNone: return "none";
    case AlarmKind::kJointRange: return "target outside the joint's range";
    case AlarmKind::kOverSpeed: return "target further away than the joint gets in one cycle";
    case AlarmKind::kNotFinite: return "NaN or infinity in a command";
    case AlarmKind::kWrongMode: return "a command that is not a joint command";
    case AlarmKind::kTimeOut: return "no packet for as long as the time-out allows";
  }
  return "?";
}

Controller::Controller(const ControllerOptions& options) noexcept
    : options_(options), arm_(options.arm), switch_(options.drop_seed, options.drop_share) {}

void Controller::on_datagram(std::span<const std::uint8_t> bytes, PeerId from) noexcept {
  if (!switch_.passes()) return missed(bytes);
  if (incoming_count_ == (options_.queues ? kMaxQueued : kMaxPerCycle)) {
    ++counters_.ignored;
    return;
  }
  Incoming& in = incoming_[incoming_count_];
  in.from = from;
  in.size = bytes.size();
  in.parse = decode_mxt_request(bytes, in.packet);
  if (in.parse == MxtParse::kOk || in.parse == MxtParse::kNotFinite) {
    ++incoming_count_;
  } else {
    ++counters_.ignored;
  }
}

void Controller::serve(bool on) noexcept {
  serves_ = on;
  if (!on) session_.reset();
}

void Controller::missed(std::span<const std::uint8_t> bytes) noexcept {
  counters_.lost_moves += is_mxt_move(bytes) ? 1 : 0;
}

void Controller::leave_out() noexcept {
  for (std::size_t i = 0; i < incoming_count_; ++i) {
    counters_.lost_moves += incoming_[i].packet.command == MxtCommand::kMove ? 1 : 0;
  }
  incoming_count_ = 0;
}

void Controller::pass(Nanos now) noexcept {
  arm_.advance(to_seconds(now - arm_at_.value_or(now)));
  arm_at_ = now;
}

void Controller::tick(Nanos now) noexcept {
  ++counters_.cycles;
  pass(now);
  outgoing_count_ = 0;
  accepted_ = false;
  const std::size_t count =
      options_.queues ? std::min<std::size_t>(incoming_count_, 1) : incoming_count_;
  serve_all(count);
  std::move(incoming_.begin() + static_cast<std::ptrdiff_t>(count),
            incoming_.begin() + static_cast<std::ptrdiff_t>(incoming_count_), incoming_.begin());
  incoming_count_ -= count;
  if (session_ && options_.time_out_cycles >= 0 &&
      t_count_ >= std::max(options_.time_out_cycles, 1)) {
    raise(AlarmKind::kTimeOut, 0, t_count_);
  }
}

void Controller::serve_all(std::size_t count) noexcept {
  std::array<bool, kMaxPerCycle> answer{};
  bool heard = false;
  next_target_.reset();
  for (std::size_t i = 0; i < count; ++i) {
    const std::uint64_t packets_before = counters_.packets;
    answer[i] = serve(incoming_[i]);
    heard = heard || counters_.packets > packets_before;
  }
  if (alarm_.kind != AlarmKind::kNone) return;
  if (next_target_ && !accept_target(*next_target_)) return;
  for (std::size_t i = 0; i < count; ++i) {
    if (answer[i]) reply(incoming_[i]);
  }
  if (!session_ || heard) {
    t_count_ = 0;
  } else if (t_count_ < std::numeric_limits<std::uint16_t>::max()) {
    ++t_count_;
  }
}

// True when the packet deserves an answer.
bool Controller::serve(const Incoming& in) noexcept {
  const bool opens = in.packet.command == MxtCommand::kNull && in.parse == MxtParse::kOk;
  if (!serves_ || alarm_.kind != AlarmKind::kNone || (!opens && in.from != session_)) {
    ++counters_.ignored;
    return false;
  }
  switch (in.packet.command) {
    case MxtCommand::kNull:
      if (!opens) break;
      if (session_ != in.from) t_count_ = 0;
      session_ = in.from;
      ++counters_.packets;
      set_outputs(in.packet.io);
      return true;
    case MxtCommand::kMove:
      ++counters_.packets;
      if (in.packet.send_type != MxtType::kJoint) {
        raise(AlarmKind::kWrongMode, 0, static_cast<double>(in.packet.send_type));
      } else if (in.parse == MxtParse::kNotFinite) {
        raise(AlarmKind::kNotFinite, 0, 0.0);
      } else {
        counters_.lost_moves += next_target_ ? 1 : 0;
        set_outputs(in.packet.io);
        next_target_ = in.packet.block[0].joints();
      }
      return true;
    case MxtCommand::kEnd:
      ++counters_.packets;
      session_.reset();
      return false;
  }
  ++counters_.ignored;
  return false;
}

bool Controller::accept_target(const JointVector& q) noexcept {
  const JointLimits& limits = rv2a_limits();
  const double cycle = to_seconds(options_.period);
  for (int i = 0; i < kJoints; ++i) {
    const double step = q[i] - arm_.target()[i];
    if (q[i] < limits.lower[i] - kRangeTolerance || q[i] > limits.upper[i] + kRangeTolerance) {
      raise(AlarmKind::kJointRange, i + 1, q[i]);
    } else if (std::abs(step) > limits.max_speed[i] * cycle * kStepTolerance) {
      raise(AlarmKind::kOverSpeed, i + 1, step);
    }
    if (alarm_.kind != AlarmKind::kNone) return false;
  }
  arm_.command(q);
  accepted_ = true;
  return true;
}

void Controller::raise(AlarmKind kind, int joint, double value) noexcept {
  alarm_ = {kind, joint, value};
  session_.reset();
  t_count_ = 0;
}

void Controller::set_outputs(const MxtIo& io) noexcept {
  if (io.send_type != kMxtOutputs) return;
  for (std::size_t i = 0; i < kMxtIoBits && io.bit_top + i < kOutputs; ++i) {
    if ((io.bit_mask >> i & 1) != 0) outputs_[io.bit_top + i] = (io.data >> i & 1) != 0;
  }
}

MxtIo Controller::outputs_for(const MxtIo& asked) const noexcept {
  MxtIo io;
  io.send_type = asked.recv_type;
  io.bit_top = asked.bit_top;
  if (asked.recv_type != kMxtOutputs) return io;
  for (std::size_t i = 0; i < kMxtIoBits && asked.bit_top + i < kOutputs; ++i) {
    io.data = static_cast<std::uint16_t>(io.data | (outputs_[asked.bit_top + i] ? 1u << i : 0u));
  }
  return io;
}

void Controller::reply(const Incoming& in) noexcept {
  if (!switch_.passes()) return;
  MxtPacket packet;
  packet.command = in.packet.command;
  packet.send_type = in.packet.type[0];
  packet.type = in.packet.type;
  for (std::size_t b = 0; b < packet.block.size(); ++b) {
    packet.block[b] = monitor_block(packet.type[b], arm_);
  }
  packet.io = outputs_for(in.packet.io);
  packet.t_count = t_count_;
  packet.c_count = in.packet.c_count;
  Outgoing& out = outgoing_[outgoing_count_++];
  out.to = in.from;
  out.size = encode_mxt(packet, in.size, out.buffer).size();
  ++counters_.replies;
}

}  // namespace handrail
