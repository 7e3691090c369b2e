#include <algorithm>
#include <cmath>

#include "client/doctor/judge.h"
#include "client/doctor/wording.h"

namespace handrail {
namespace {

// Of sums of shares, which round.
constexpr double kRounding = 1e-9;
// What a link that loses this much is said of, though an engage takes it: under it the quality is
// EXCELLENT (server/model/link_state.h).
constexpr double kWorthSaying = 0.01;
constexpr char kLookAtNetwork[] =
    "use a cable in place of radio, and end what else fills the line: `ping` the other computer "
    "from here";

// True when there is a session whose figures are worth looking at.
bool judge_peer(const pb::Status& s, int own_wire, Findings& out) {
  const pb::PeerStatus& peer = s.peer();
  if (!peer.problem().empty()) {
    // The sentence without its end, which is what to do.
    std::string fact = peer.problem();
    const std::string tail = ": " + peer.next();
    if (fact.ends_with(tail)) fact.resize(fact.size() - tail.size());
    out.push_back({"link.peer", Level::kProblem, fact, peer.next()});
    return false;
  }
  const bool other = s.slave_program().has_wire_version() && !s.slave_program().has_version();
  if (other) return false;  // judge_programs says it
  if (peer.encrypted() && peer.name().empty()) {
    out.push_back({"link.peer", Level::kProblem, "no session yet with the slave at " + peer.place(),
                   "look again in some seconds"});
    return false;
  }
  const std::string who = peer.encrypted()
                              ? "session with " + peer.name() + ", key " + peer.key() + ", at " +
                                    peer.address() + ", for " + span_text(peer.age_s())
                              : "plain link on this computer, at " + peer.place();
  if (slave_is_heard(s)) {
    out.push_back({"link.peer", Level::kOk, who, ""});
    return true;
  }
  if (s.packet_age_ms() >= 0.0) {
    out.push_back({"link.peer", Level::kProblem,
                   who + ": the slave was last heard " + span_text(s.packet_age_ms() / 1e3) +
                       " ago, expected within 20 ms",
                   "see whether the slave still runs, and the network between"});
  } else if (peer.encrypted()) {
    out.push_back({"link.peer", Level::kProblem, who + ", but nothing that it says can be read",
                   formatted("handrail --version, on both computers: a slave before wire version 8 "
                             "says nothing to a master of %d",
                             own_wire)});
  } else {
    out.push_back({"link.peer", Level::kProblem,
                   "no slave has answered at " + peer.place() + ", on this computer",
                   "handrail-slave; or, for an arm at another computer, start the master with "
                   "--link THE-ARM'S-HOST"});
  }
  return false;
}

double median(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

// How much one differs from the next, on average.
double jitter(const std::vector<double>& values) {
  double sum = 0.0;
  for (std::size_t i = 1; i < values.size(); ++i) sum += std::abs(values[i] - values[i - 1]);
  return values.size() < 2 ? 0.0 : sum / static_cast<double>(values.size() - 1);
}

void judge_delay(const MasterFacts& master, const pb::LinkGate& gate, Findings& out) {
  if (master.round_trips_ms.empty()) return;
  out.push_back(
      {"link.round_trip", Level::kOk,
       formatted("there and back in %.1f ms (median), %.1f ms at worst, %.1f ms from one to the "
                 "next (jitter); %zu of them in %.1f s; nothing is asked of it",
                 median(master.round_trips_ms),
                 *std::max_element(master.round_trips_ms.begin(), master.round_trips_ms.end()),
                 jitter(master.round_trips_ms), master.round_trips_ms.size(), master.watched_s),
       ""});
  if (master.loop_ages_ms.empty()) return;
  const double oldest = *std::max_element(master.loop_ages_ms.begin(), master.loop_ages_ms.end());
  const std::string fact = formatted(
      "the newest command that the slave is known to have was %.1f ms old at worst; over %.0f ms "
      "it "
      "is said, over %.0f ms the force fades",
      oldest, gate.loop_warn_ms(), gate.loop_limit_ms());
  if (oldest > gate.loop_limit_ms()) {
    out.push_back({"link.loop", Level::kProblem, fact,
                   "a nearer way; or, if that is the way there is, a larger loop_limit_ms in the "
                   "master's configuration"});
  } else if (oldest > gate.loop_warn_ms()) {
    out.push_back({"link.loop", Level::kNote, fact, "move slower: what you see and feel is old"});
  } else {
    out.push_back({"link.loop", Level::kOk, fact, ""});
  }
}

struct Shares {
  double here, there, most;
};

void judge_shares(const char* check, const Shares& shares, const char* what, double window,
                  Findings& out) {
  const double worst = std::max(shares.here, shares.there);
  const bool asked = window > 0.0;
  const std::string fact =
      formatted("%s: %.1f %% here, %.1f %% at the slave; ", what, 100.0 * shares.here,
                100.0 * shares.there) +
      (asked ? formatted("at most %.0f %% in %g s is asked", 100.0 * shares.most, window)
             : "nothing is asked (good_link_ms is 0)");
  const Level level = asked && worst > shares.most + kRounding ? Level::kProblem
                      : worst > kWorthSaying + kRounding       ? Level::kNote
                                                               : Level::kOk;
  out.push_back({check, level, fact, level == Level::kOk ? "" : kLookAtNetwork});
}

// A link that began just now is heard for as long as it was looked at, and an engage waits for the
// rest; one with gaps is not.
void judge_heard(const pb::LinkGate& gate, double watched, Findings& out) {
  constexpr double kBlock = 0.1;  // of the window, by which it slides
  const double heard = gate.window_s() * gate.heard_share();
  if (gate.window_s() <= 0.0 || gate.heard_share() >= 1.0 - kRounding) return;
  const bool gaps = heard < std::min(watched, gate.window_s()) - kBlock * gate.window_s();
  out.push_back({"link.heard", gaps ? Level::kProblem : Level::kNote,
                 formatted("heard both ways for %.2f s without a gap of over 200 ms; %g s is asked",
                           heard, gate.window_s()),
                 gaps ? kLookAtNetwork : "look again in some seconds: the link is young"});
}

void judge_gate(const pb::LinkGate& gate, double watched, Findings& out) {
  judge_shares("link.loss", {gate.lost_share(), gate.peer_lost_share(), gate.most_lost_share()},
               "lost on the way", gate.window_s(), out);
  judge_shares("link.gaps", {gate.held_share(), gate.peer_held_share(), gate.most_held_share()},
               "time with nothing new for over 20 ms, in which the arm holds", gate.window_s(),
               out);
  judge_heard(gate, watched, out);
}

void judge_quality(const pb::Status& s, Findings& out) {
  const std::string fact = "quality " + s.link_quality() + " here, " + s.peer_quality() +
                           " at the slave; the arm holds while one is POOR";
  const auto is = [&s](const char* grade) {
    return s.link_quality() == grade || s.peer_quality() == grade;
  };
  const Level level = is("POOR") ? Level::kProblem : is("FAIR") ? Level::kNote : Level::kOk;
  out.push_back({"link.quality", level, fact, level == Level::kOk ? "" : kLookAtNetwork});
}

}  // namespace

void judge_link(const DoctorFacts& facts, Findings& out) {
  if (!facts.master.status) return;
  const pb::Status& s = status_of(facts);
  if (s.has_walls()) {
    out.push_back({"link.peer", Level::kOk,
                   "the scene has walls for the hand alone: no slave takes part in it", ""});
    return;
  }
  if (!judge_peer(s, facts.wire_version, out)) return;
  judge_delay(facts.master, s.gate(), out);
  judge_gate(s.gate(), facts.master.watched_s, out);
  judge_quality(s, out);
}

}  // namespace handrail
