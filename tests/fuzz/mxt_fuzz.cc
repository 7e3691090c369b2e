// The robot driver's packets and its session, and the simulated controller's end. The first byte's
// lowest bit chooses the short form; then a row of acts, each a byte and what it needs.
#include <cmath>

#include "devices/melfa/mxt_client.h"
#include "devices/rig/controller.h"
#include "tests/fuzz/fuzz_target.h"

namespace handrail {
namespace {

using fuzz::require;

// A packet that decodes is the same when it was encoded and is decoded again.
void check_mxt_codec(fuzz::Bytes bytes) {
  for (const auto decode : {decode_mxt_request, decode_mxt_reply}) {
    MxtPacket packet, again;
    if (decode(bytes, packet) != MxtParse::kOk) continue;
    std::array<std::uint8_t, kMxtLong> buffer;
    const auto encoded = encode_mxt(packet, bytes.size(), buffer);
    require(encoded.size() == bytes.size(), "a packet keeps its size");
    require(decode(encoded, again) == MxtParse::kOk, "what was encoded decodes");
    require(again.type == packet.type && again.c_count == packet.c_count &&
                again.t_count == packet.t_count && again.command == packet.command,
            "and is the same");
  }
}

class MxtSession {
 public:
  explicit MxtSession(fuzz::Bytes bytes)
      : in_(bytes),
        client_({.packet_bytes = in_.take<std::uint8_t>() % 2 == 0 ? kMxtLong : kMxtShort}) {}

  void run() {
    send(client_.start(now_));
    const std::size_t most = fuzz::most_acts(in_.left());
    for (std::size_t acts = 0; !in_.empty() && acts < most; ++acts) {
      act(in_.take<std::uint8_t>() % 9);
      require(!client_.open() || client_.deadline() <= now_ + 20 * kMxtPeriod,
              "an open session waits for something");
      require(controller_.arm().joints().allFinite(), "the arm stands somewhere");
    }
  }

 private:
  void act(int what) {
    switch (what) {
      case 0: now_ += kMicrosecond * in_.take<std::uint16_t>(); break;
      case 1: cycle(); break;
      case 2: poll(); break;
      case 3: {
        q_target_[in_.take<std::uint8_t>() % kJoints] += 1e-4 * in_.take<std::int8_t>();
        send(client_.send(q_target_, now_));
        break;
      }
      case 4: send(client_.ask()); break;
      case 5: hear_made_up(); break;
      case 6: {
        const fuzz::Bytes part = in_.take_bytes(in_.take<std::uint8_t>());
        check_mxt_codec(part);
        hear(part);
        break;
      }
      case 7: {
        const fuzz::Bytes part = in_.take_bytes(in_.take<std::uint8_t>());
        check_mxt_codec(part);
        controller_.on_datagram(part, 2);
        break;
      }
      default: in_.take<std::uint8_t>() % 8 == 0 ? send(client_.end()) : send(client_.start(now_));
    }
  }
  void send(MxtClient::Bytes bytes) {
    if (!bytes.empty()) controller_.on_datagram(bytes, 1);
  }
  // A cycle of the controller, whose replies come after a while or never.
  void cycle() {
    now_ += kMxtPeriod;
    controller_.tick(now_);
    const auto how = in_.take<std::uint8_t>();
    now_ += 20 * kMicrosecond * (how >> 1);
    for (const Controller::Outgoing& out : controller_.replies()) {
      if (out.to == 1 && how % 2 == 0) hear(out.bytes());
    }
  }
  void poll() {
    now_ = std::max(now_, std::min(client_.deadline(), now_ + kSecond));
    const auto event = client_.poll(now_, reply_);
    if (event) check(*event);
    if (event && client_.opening()) send(client_.packet());
  }
  // A reply as anybody could make one up.
  void hear_made_up() {
    MxtPacket packet;
    packet.type = {MxtType::kFeedbackJoint, MxtType::kJoint};
    const auto how = in_.take<std::uint8_t>();
    if ((how & 1) != 0) std::swap(packet.type[0], packet.type[1]);
    packet.send_type = packet.type[0];
    packet.t_count = in_.take<std::uint16_t>();
    for (std::size_t b = 0; b < 2; ++b) {
      for (std::size_t i = 0; i < static_cast<std::size_t>(kJoints); ++i) {
        packet.block[b].set_real(i, (how & 2) != 0 ? in_.take<float>() : q_target_[0]);
      }
    }
    std::array<std::uint8_t, kMxtLong> buffer;
    hear(encode_mxt(packet, (how & 4) != 0 ? kMxtLong : kMxtShort, buffer));
  }
  void hear(fuzz::Bytes bytes) {
    const RobotReply before = reply_;
    const auto event = client_.on_datagram(bytes, now_, reply_);
    if (event) check(*event);
    if (event == RobotEvent::kRejected) {
      require(reply_.q_measured == before.q_measured && reply_.q_commanded == before.q_commanded,
              "what is dropped says nothing of the arm");
    }
    require(reply_.q_measured.allFinite() && reply_.q_commanded.allFinite(),
            "an arm stands somewhere");
  }
  void check(RobotEvent event) {
    require(reply_.cycles >= 1, "an event is of a cycle");
    require(event != RobotEvent::kLost || !client_.open(), "a lost session is closed");
  }

  fuzz::Input in_;
  Nanos now_ = kSecond;
  MxtClient client_;
  Controller controller_{ControllerOptions{}};
  RobotReply reply_;
  JointVector q_target_ = JointVector::Zero();
};

}  // namespace

HANDRAIL_FUZZ(mxt) {
  check_mxt_codec(bytes);
  MxtSession(bytes).run();
}

}  // namespace handrail
