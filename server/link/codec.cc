#include "server/link/codec.h"

#include <algorithm>
#include <array>

#include "server/link/check.h"
#include "server/link/codec_fields.h"
#include "server/link/frame.h"

namespace handrail {
namespace {

Reject check(const DatagramHeader& h) {
  const bool times = h.sent >= 0 && h.echo_sent >= 0 && h.echo_held >= 0;
  const bool echo = h.echo_session != 0 ? h.echo_sequence != 0
                                        : h.echo_sequence == 0 && h.echo_sent == 0 &&
                                              h.echo_held == 0 && h.received_of_100 == 0;
  return h.received_of_100 <= 100 && h.session != 0 && h.sequence != 0 && times && echo
             ? Reject::kNone
             : Reject::kHeader;
}

template <typename Message>
void put_header(const DatagramHeader& h, Message& m) {
  m.set_session(h.session);
  m.set_sequence(h.sequence);
  m.set_sent_ns(h.sent);
  m.set_echo_session(h.echo_session);
  m.set_echo_sequence(h.echo_sequence);
  m.set_echo_sent_ns(h.echo_sent);
  m.set_echo_held_ns(h.echo_held);
  m.set_received_of_100(h.received_of_100);
}
template <typename Message>
bool header_present(const Message& m) {
  return m.has_session() && m.has_sequence() && m.has_sent_ns() && m.has_echo_session() &&
         m.has_echo_sequence() && m.has_echo_sent_ns() && m.has_echo_held_ns() &&
         m.has_received_of_100();
}
template <typename Message>
DatagramHeader take_header(const Message& m) {
  return {m.session(),       m.sequence(),     m.sent_ns(),      m.echo_session(),
          m.echo_sequence(), m.echo_sent_ns(), m.echo_held_ns(), m.received_of_100()};
}

// Writes the message into a datagram; 0 when it is too long.
template <typename Message>
std::size_t write(DatagramKind kind, const Message& m, std::span<std::uint8_t> out) {
  const std::size_t size = kFrameBytes + m.ByteSizeLong();
  if (size > out.size() || size > kMaxDatagram) return 0;
  m.SerializeWithCachedSizesToArray(out.data() + kFrameBytes);
  seal_frame(kind, out.first(size));
  return size;
}

// Reads the message of a datagram, whatever its fields say.
template <typename Message>
Reject read(DatagramKind kind, std::span<const std::uint8_t> bytes, Message& m) {
  std::span<const std::uint8_t> payload;
  const Reject framing = open_frame(kind, bytes, payload);
  if (framing != Reject::kNone) return framing;
  if (!m.ParseFromArray(payload.data(), static_cast<int>(payload.size()))) return Reject::kProtobuf;
  if (!m.GetReflection()->GetUnknownFields(m).empty()) return Reject::kUnknownField;
  return Reject::kNone;
}

template <typename State, typename Message>
std::size_t encode_as(DatagramKind kind, const DatagramHeader& header, const State& state,
                      std::span<std::uint8_t> out, Message& m, Reject& cause) {
  cause = check(header);
  if (cause == Reject::kNone) cause = check(state);
  if (cause != Reject::kNone) return 0;
  m.Clear();
  put_header(header, m);
  put(state, m);
  const std::size_t size = write(kind, m, out);
  if (size == 0) cause = Reject::kSize;
  return size;
}

template <typename State, typename Message>
Reject decode_as(DatagramKind kind, std::span<const std::uint8_t> bytes, DatagramHeader& header,
                 State& state, Message& m) {
  const Reject unread = read(kind, bytes, m);
  if (unread != Reject::kNone) return unread;
  if (!header_present(m) || !present(m)) return Reject::kMissingField;
  header = take_header(m);
  const Reject in_header = check(header);
  if (in_header != Reject::kNone) return in_header;
  if (const Reject untaken = take(m, state); untaken != Reject::kNone) return untaken;
  const Reject in_state = check(state);
  if (in_state != Reject::kNone) return in_state;
  return tools_match(m, state) ? Reject::kNone : Reject::kTool;
}

}  // namespace

struct Codec::Messages {
  pb::MasterDatagram master;
  pb::SlaveDatagram slave;
  pb::RefusalDatagram refusal;
};

Codec::Codec() : messages_(std::make_unique<Messages>()) {
  // Grow every reused buffer to its full size now, by sending the longest datagrams to ourselves.
  std::array<std::uint8_t, kMaxDatagram> buffer;
  DatagramHeader header{.session = 1, .sequence = 1};
  MasterState master;
  SlaveState slave;
  std::fill(master.scene.begin(), master.scene.end() - 1, 'x');
  slave.scene = master.scene;
  slave.surface = Surface();
  Reject cause;
  const std::span<const std::uint8_t> bytes(buffer);
  (void)decode(bytes.first(encode(header, master, buffer, cause)), header, master);
  (void)decode(bytes.first(encode(header, slave, buffer, cause)), header, slave);
  Refusal refusal{.refused_session = 1};
  std::fill(refusal.leader.begin(), refusal.leader.end() - 1, 'x');
  (void)decode(bytes.first(encode(refusal, buffer)), refusal);
}
Codec::~Codec() = default;
Codec::Codec(Codec&&) noexcept = default;
Codec& Codec::operator=(Codec&&) noexcept = default;

std::size_t Codec::encode(const DatagramHeader& header, const MasterState& state,
                          std::span<std::uint8_t> out, Reject& cause) noexcept {
  return encode_as(DatagramKind::kMaster, header, state, out, messages_->master, cause);
}
std::size_t Codec::encode(const DatagramHeader& header, const SlaveState& state,
                          std::span<std::uint8_t> out, Reject& cause) noexcept {
  return encode_as(DatagramKind::kSlave, header, state, out, messages_->slave, cause);
}
Reject Codec::decode(std::span<const std::uint8_t> bytes, DatagramHeader& header,
                     MasterState& state) noexcept {
  return decode_as(DatagramKind::kMaster, bytes, header, state, messages_->master);
}
Reject Codec::decode(std::span<const std::uint8_t> bytes, DatagramHeader& header,
                     SlaveState& state) noexcept {
  return decode_as(DatagramKind::kSlave, bytes, header, state, messages_->slave);
}

std::size_t Codec::encode(const Refusal& refusal, std::span<std::uint8_t> out) noexcept {
  if (!sound(refusal)) return 0;
  pb::RefusalDatagram& m = messages_->refusal;
  m.Clear();
  m.set_refused_session(refusal.refused_session);
  m.set_retired(refusal.retired);
  const std::string_view leader = text_of(refusal.leader);
  m.mutable_leader()->assign(leader);
  m.set_led_for_ns(refusal.led_for);
  return write(DatagramKind::kRefusal, m, out);
}
Reject Codec::decode(std::span<const std::uint8_t> bytes, Refusal& refusal) noexcept {
  pb::RefusalDatagram& m = messages_->refusal;
  const Reject unread = read(DatagramKind::kRefusal, bytes, m);
  if (unread != Reject::kNone) return unread;
  if (!m.has_refused_session() || !m.has_retired() || !m.has_leader() || !m.has_led_for_ns()) {
    return Reject::kMissingField;
  }
  if (!is_leader_name(m.leader())) return Reject::kHeader;
  refusal = {m.refused_session(), m.retired(), fixed_text<LeaderName>(m.leader()), m.led_for_ns()};
  return sound(refusal) ? Reject::kNone : Reject::kHeader;
}

}  // namespace handrail
