#include "devices/melfa/mxt_client.h"

#include <algorithm>
#include <cstdlib>
#include <utility>

#include "server/base/deletable.h"

namespace handrail {
namespace {

// Replies of which the earliest tells whether the phase has moved: half a second of them.
constexpr int kPhaseWindow = 64;
// So much later it has, of a period: a controller of 7.11 ms, for which 7.1 ms are reckoned, needs
// 89 cycles for it.
constexpr int kMoved = 8;
// So many replies in a row that come as late as the first of them, within 0.2 ms, tell it at once:
// where each comes at any time in half a cycle, they do so by chance once in four hours.
constexpr int kAlike = 8;     // [replies]
constexpr int kAlikeBy = 32;  // of a period
// A reply may come so much before its cycle, of a period, 0.2 ms: after all silent cycles that do
// not begin it anew, a controller of 7.09 ms is 0.14 ms early.
constexpr int kEarly = 32;
// A reply later than this in its cycle, of a period, may be of the cycle before. The phase is known
// no better (kMoved).
constexpr int kPrompt = kMoved;  // of a period
// Silent cycles after which the controller may be another one, with cycles of its own: none starts
// anew in less than 0.1 s. What was sent before is not answered any more, on any way in one
// building.
constexpr int kAnother = 14;
// Of a cycle, for a packet without a reply to get to the controller: 0.9 ms. A reply is waited for
// until then, since a joint faster than half its rating cannot go on without. Over a longer way
// half a cycle, and no session opens over one that takes longer still.
constexpr int kSpare = 8;
constexpr int kSpareFar = 2;  // of a cycle
// Of a cycle, by which the packet that tries this is later than any other will be: 0.44 ms, twice
// what 99.9 % of the wake-ups of a real-time thread take on a virtual machine.
constexpr int kMargin = 16;
constexpr int kTries = 3;  // answers of each may be late: this thread, too, may be
// Answers in time in a row. A way that wavers by 0.3 ms about 0.5 ms was short enough once in 170
// runs; three times in a row by chance it is once in millions.
constexpr int kInTime = 3;  // [answers]
// What was sent is not answered any more after 0.1 s on any way in one building.
constexpr int kGone = 14;  // [cycles]
// Packets after one whose reply with the measured joints is missing, or after a reply too many,
// that ask for the target instead: what comes later than 28 ms is not reckoned with.
constexpr int kDoubt = 3;  // [packets]

// The packet's first block of that type; null: there is none.
const MxtBlock* first_of(const MxtPacket& packet, MxtType type) {
  for (std::size_t b = 0; b < packet.block.size(); ++b) {
    if (packet.type[b] == type) return &packet.block[b];
  }
  return nullptr;
}

}  // namespace

Nanos MxtClientOptions::longest_way() const noexcept {
  return period / kSpareFar - period / kMargin;
}

MxtClient::Bytes MxtClient::start(Nanos now) noexcept {
  open_ = true;
  answered_ = anew_ = has_measured_ = has_commanded_ = asked_measured_ = false;
  opening_ = Opening::kAsked;
  tries_ = 0;
  in_time_ = 0;
  repeated_ = false;
  doubt_ = 0;
  q_heard_.fill(JointVector::Zero());
  losses_ = 0;
  c_count_ = 0;
  deadline_ = now + 2 * options_.period;
  return write(MxtCommand::kNull);
}

// So long before the end of a cycle its packet is sent, at the latest.
Nanos MxtClient::spare() const noexcept {
  return options_.period / (tries_ < kTries ? kSpare : kSpareFar);
}

// Cycles that have begun since the present one did.
int MxtClient::cycles_begun(Nanos now) const noexcept {
  constexpr Nanos kMost = 1'000'000;
  return static_cast<int>(std::clamp<Nanos>((now - cycle_) / options_.period, 0, kMost));
}

// Whether a packet that is sent now may miss the cycle that begins `cycles` after the present one.
// The opening has tried how late it may be; half of that is for a way that wavers.
bool MxtClient::too_late(int cycles, Nanos now) const noexcept {
  const Nanos end = cycle_ + (cycles + 1) * options_.period;
  return now > end - spare() + options_.period / (2 * kMargin) && kept(Check::kInTime);
}

// Whether the cycle that begins `cycles` after the present one cannot be told of now. Its packet
// may come too late: it passes unseen. Or, where nothing proves that it has begun, it may not have,
// by what is known of the phase: only a controller that keeps packets answers alike so. What is put
// off is told once that cycle, or the next one, has surely begun, and was not heard promptly.
bool MxtClient::put_off(int cycles, bool proven, Nanos now) noexcept {
  const Nanos begins = cycle_ + cycles * options_.period;
  const Nanos sure = begins + options_.period / kMoved + 1;
  const bool late = too_late(cycles, now);
  if (!late && (proven || now >= sure || !kept(Check::kBegun))) return false;
  if (!late && cycles == 1 && deadline_ != sure && learn_phase(now - begins, false)) return false;
  deadline_ = sure + (late ? options_.period : 0);
  return true;
}

void MxtClient::begin_cycle(int cycles, Nanos now, RobotReply& reply) noexcept {
  cycle_ += cycles * options_.period;
  deadline_ = cycle_ + 2 * options_.period - spare();
  reply.cycles = cycles;
  reply.anew = anew_;
  reply.has_measured = has_measured_;
  reply.has_commanded = has_commanded_;
  reply.fresh = cycle_answered_ = has_measured_ || has_commanded_;
  const bool prompt = now - cycle_ <= options_.period / kPrompt || !kept(Check::kPrompt);
  reply.prompt = reply.fresh && prompt;
  has_measured_ = has_commanded_ = false;
  told_ = Told::kNothing;
}

// Whether enough came alike. `late`: of a reply, behind where its cycle was thought to begin,
// before which none is sent. `may_begin`: it may be the next cycle's, for which no packet has been
// sent.
bool MxtClient::learn_phase(Nanos late, bool may_begin) noexcept {
  const bool alike = std::abs(late - run_late_) <= options_.period / kAlikeBy;
  alike_ = alike ? alike_ + 1 : 1;
  if (!alike) run_late_ = late;
  least_late_ = std::min(least_late_, late);
  const bool sure = late < 0 || alike_ >= kAlike;
  if (++seen_ < kPhaseWindow && !sure) return false;
  const Nanos least = sure ? late : least_late_;
  if (least < 0 || least > options_.period / kMoved) {
    // So late that it is an early one of the next cycle: that one is not left out.
    const bool next = may_begin && 2 * least > options_.period;
    const Nanos moved = next ? least - options_.period : least;
    cycle_ += moved;
    deadline_ += moved;
  }
  forget_phase();
  return sure;
}

// A reply came now. One that begins a cycle where those before it do is a vote for that phase,
// which the earliest of them tells. None comes before its cycle: an earlier one is the first vote
// for another phase. A later one is a vote less, and where none is left the first for another.
void MxtClient::find_phase(Nanos now) noexcept {
  const Nanos period = options_.period;
  cycle_ += (now - cycle_ + period / 2) / period * period;
  const bool alike = alike_ > 0 && std::abs(now - cycle_) <= period / kMoved;
  if (alike) {
    cycle_ = std::min(cycle_, now);
    ++alike_;
  } else if (now < cycle_ || --alike_ <= 0) {
    cycle_ = now;
    alike_ = 1;
  }
  deadline_ = cycle_ + 2 * period - spare();
}

void MxtClient::forget_phase() noexcept {
  least_late_ = kForever;
  run_late_ = -options_.period;
  seen_ = alike_ = 0;
}

// The packet last sent asked for `q_measured`, and this is its reply. Of a target that is held
// already it may be any other's.
bool MxtClient::taken(const JointVector& q_measured) noexcept {
  const bool again = std::ranges::find(q_heard_, q_measured) != q_heard_.end();
  q_heard_[heard_next_++ % q_heard_.size()] = q_measured;
  return asked_measured_ && (held_ || !again);
}

// Whether the reply says that the controller holds the target last sent.
bool MxtClient::hear(const JointVector* q_measured, bool commanded, RobotReply& reply) noexcept {
  bool took = commanded && reply.q_commanded == q_sent_;
  if (commanded || !short_form()) {
    held_ = took;
  } else {
    took = taken(*q_measured);
    if (took) {
      reply.q_commanded = q_sent_;
      held_ = has_commanded_ = true;
    } else {
      doubt_ = kDoubt;
    }
    asked_measured_ = false;
  }
  if (commanded || took) q_held_ = reply.q_commanded;
  return took;
}

// How long before its cycle a reply may come that says or not that the controller `took` the newest
// target. One that has the present cycle's target is the next cycle's, whatever the phase seems to
// be. Who has not told this cycle anything yet cannot be answered. A target that was held before is
// held at any time: such a reply may be a little early.
Nanos MxtClient::most_early(bool took) const noexcept {
  if (told_ == Told::kNothing) return 0;
  if (told_ == Told::kNew && kept(Check::kPhase)) return took ? options_.period : 0;
  return options_.period / kEarly;
}

std::optional<RobotEvent> MxtClient::on_datagram(Bytes bytes, Nanos now,
                                                 RobotReply& reply) noexcept {
  if (!open_) return RobotEvent::kLost;
  MxtPacket packet;
  const bool whole =
      bytes.size() == options_.packet_bytes && decode_mxt_reply(bytes, packet) == MxtParse::kOk;
  const MxtBlock* measured = whole ? first_of(packet, MxtType::kFeedbackJoint) : nullptr;
  const MxtBlock* commanded = whole ? first_of(packet, MxtType::kJoint) : nullptr;
  const bool asked = short_form() && (answered_ || has_measured_);
  if (measured == nullptr && !(commanded != nullptr && asked)) {
    ++counters_.rejected;
    return RobotEvent::kRejected;
  }
  if (measured != nullptr) reply.q_measured = measured->joints();
  if (commanded != nullptr) reply.q_commanded = commanded->joints();
  has_measured_ = has_measured_ || measured != nullptr;
  has_commanded_ = has_commanded_ || commanded != nullptr;
  reply.missed_cycles = packet.t_count;
  if (options_.gripper)
    reply.gripper = state_of(*options_.gripper, packet.io).value_or(reply.gripper);
  ++counters_.replies;
  losses_ = 0;
  if (opening()) {
    const bool second = packet.type[0] == MxtType::kJoint;
    if (!(anew_ ? hear_anew(now) : hear_opening(second, now))) return std::nullopt;
    q_sent_ = reply.q_commanded;
  }
  const bool took = hear(&reply.q_measured, commanded != nullptr, reply);
  if (opening()) {
    cycle_ -= options_.period;
    begin_cycle(1, now, reply);
    forget_phase();
    answered_ = true;
    anew_ = false;
    return RobotEvent::kReply;
  }
  int cycles = cycles_begun(now);
  if (cycles == 0) cycles = cycles_begun(now + most_early(took));
  // One of before that is late would prove nothing, if the present cycle's is still to come.
  const bool proven = cycles == 1 && (took || told_ != Told::kNew || cycle_answered_);
  if (cycles > 0 && put_off(cycles, proven, now)) {
    ++counters_.late;
    return std::nullopt;
  }
  const bool late = cycles == 0;
  const bool second = late && cycle_answered_;
  // Where the controller does not have the present packet's target, that packet came after the
  // cycle that this reply is of, and is the next one's.
  const bool may_begin = late && (took || told_ != Told::kNew);
  if (late) {
    ++counters_.late;
    cycle_answered_ = true;
  } else {
    begin_cycle(cycles, now, reply);
  }
  if (!second) learn_phase(now - cycle_, may_begin);
  if (!late) return RobotEvent::kReply;
  // By what was learnt just now it may be the next one's after all.
  cycles = cycles_begun(now);
  if (cycles == 0) return std::nullopt;
  begin_cycle(cycles, now, reply);
  return RobotEvent::kReply;
}

std::optional<RobotEvent> MxtClient::poll(Nanos now, RobotReply& reply) noexcept {
  if (!open_) return RobotEvent::kLost;
  if (now < deadline_) return std::nullopt;
  if (!answered_) return poll_opening(now);
  const int cycles = std::max(cycles_begun(now), 1);
  if (put_off(cycles, cycles == 1, now)) return std::nullopt;
  if (lost()) return RobotEvent::kLost;
  if (losses_ > kAnother && !anew_) {
    anew_ = true;
    forget_phase();
  }
  begin_cycle(cycles, now, reply);
  cycle_answered_ = false;
  if (anew_) write(MxtCommand::kNull);
  return RobotEvent::kSilence;
}

// A cycle has passed without a reply. True: it was the last one allowed.
bool MxtClient::lost() noexcept {
  open_ = ++losses_ < options_.max_losses;
  counters_.silences += open_ ? 1 : 0;
  return !open_;
}

// Whether the reply that came now opens the session; `second`: it is one to the second packet.
bool MxtClient::hear_opening(bool second, Nanos now) noexcept {
  if (opening_ == Opening::kAsked && !second) begin_try(now);
  if (!second || opening_ == Opening::kAsked || opening_ == Opening::kHeard) return false;
  if (opening_ == Opening::kAskedAgain) {
    if (2 * (now - first_) <= 3 * options_.period || !kept(Check::kWay)) {
      cycle_ = now;
      if (++in_time_ == kInTime) return true;
      begin_try(now);
      return false;
    }
    in_time_ = 0;
    if (++tries_ < 2 * kTries && !repeated_) {
      begin_try(now);
    } else {
      give_up_opening(now);
    }
  }
  ++counters_.far;
  return false;
}

// Whether the reply that came now tells where the cycles begin. Those before that say nothing of
// the arm.
bool MxtClient::hear_anew(Nanos now) noexcept {
  find_phase(now);
  if (alike_ >= kAlike || !kept(Check::kBegun)) return true;
  has_measured_ = has_commanded_ = false;
  return false;
}

// A reply came now, and nothing else is on its way. The next packet goes so late in its cycle that
// an answer in the next one means: all others will be there in time.
void MxtClient::begin_try(Nanos now) noexcept {
  first_ = now;
  deadline_ = now + options_.period - spare() + options_.period / kMargin;
  opening_ = Opening::kHeard;
  asked_measured_ = false;
}

std::optional<RobotEvent> MxtClient::poll_opening(Nanos now) noexcept {
  if (opening_ == Opening::kAskedAgain) {
    give_up_opening(now);
    return std::nullopt;
  }
  const bool heard = opening_ == Opening::kHeard;
  if (!heard && lost()) return RobotEvent::kLost;
  if (!heard) {
    has_measured_ = has_commanded_ = false;
    in_time_ = 0;
  }
  repeated_ = opening_ == Opening::kAsked || (heard && repeated_);
  if (tries_ == 2 * kTries) tries_ = 0;
  opening_ = heard ? Opening::kAskedAgain : Opening::kAsked;
  deadline_ = now + 2 * options_.period;
  write(MxtCommand::kNull);
  return RobotEvent::kSilence;
}

void MxtClient::give_up_opening(Nanos now) noexcept {
  opening_ = Opening::kGivenUp;
  deadline_ = now + kGone * options_.period;
}

MxtClient::Bytes MxtClient::send(const JointVector& q_target, Nanos now) noexcept {
  if (!open_ || opening() || too_late(0, now)) return {};
  return write(MxtCommand::kMove, q_target);
}

MxtClient::Bytes MxtClient::ask() noexcept {
  if (!open_ || opening()) return {};
  return write(MxtCommand::kNull);
}

MxtClient::Bytes MxtClient::end() noexcept {
  if (!open_) return {};
  open_ = false;
  return write(MxtCommand::kEnd);
}

MxtClient::Bytes MxtClient::write(MxtCommand command, const JointVector& q_target) noexcept {
  MxtPacket packet;
  packet.command = command;
  packet.c_count = c_count_++;
  if (command == MxtCommand::kMove) {
    packet.send_type = MxtType::kJoint;
    packet.block[0].set_joints(q_target);
    const JointVector q = packet.block[0].joints();
    const bool may_be_held = (q == q_sent_ || q == q_held_) && kept(Check::kPhase);
    told_ = (held_ && q == q_sent_) || may_be_held ? Told::kSame : Told::kNew;
    held_ = held_ && q == q_sent_;
    q_sent_ = q;
  }
  if (command != MxtCommand::kEnd) packet.type = {MxtType::kFeedbackJoint, MxtType::kJoint};
  if (asked_measured_) doubt_ = kDoubt;
  asked_measured_ = answered_ ? command == MxtCommand::kMove && doubt_ == 0 : !has_measured_;
  doubt_ = std::max(doubt_ - 1, 0);
  // A second packet that opens a session, and a short one in doubt.
  const bool held_first = (!answered_ || short_form()) && command != MxtCommand::kEnd;
  if (held_first && !asked_measured_) std::swap(packet.type[0], packet.type[1]);
  if (options_.gripper && open_ && !opening()) packet.io = io_of(*options_.gripper, grip_);
  ++counters_.sent;
  packet_ = encode_mxt(packet, options_.packet_bytes, buffer_);
  return packet_;
}

}  // namespace handrail
