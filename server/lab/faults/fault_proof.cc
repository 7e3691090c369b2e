#include "server/lab/faults/fault_proof.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <array>

#include "server/lab/faults/fault_runner.h"

namespace handrail {
namespace {

constexpr std::uint64_t bit(Check check) {
  return std::uint64_t{1} << static_cast<unsigned>(check);
}

// A number that is none fails the workspace as well, and a force that grows the wrong way is not
// relieved.
// A hand whose stand the arm leaves without its check is drawn once in some 200 runs.
constexpr std::uint64_t kRareWay = 2;

constexpr std::array kProofs = {
    FaultProof{Check::kFinite, "finite", "X2a", 2, "not finite", bit(Check::kWorkspace)},
    FaultProof{Check::kWorkspace, "workspace", "X2a", 2, "outside the workspace"},
    FaultProof{Check::kRange, "range", "X2a", 2, "joint range"},
    FaultProof{Check::kSpeed, "speed", "X2a", 2, "joint speed"},
    FaultProof{Check::kAcceleration, "acceleration", "X2a", 2, "joint acceleration"},
    FaultProof{Check::kJerk, "jerk", "X2a", 2, "joint jerk"},
    FaultProof{Check::kFollowing, "following", "S5", 9, "not found"},
    FaultProof{Check::kSensor, "sensor", "S1a", 8, "more than a cycle held"},
    FaultProof{Check::kStuck, "stuck", "S2a", 2, "not found"},
    FaultProof{Check::kUnchanged, "unchanged", "S2e", 3, "not found"},
    FaultProof{Check::kEncoder, "encoder", "S1b", 8, "not engaged after one bad reading"},
    FaultProof{Check::kWatchdog, "watchdog", "N10a", 10, "stopped late"},
    FaultProof{Check::kLatch, "latch", "N9", 10, "moved without being led"},
    FaultProof{Check::kSequence, "sequence", "N5", 3, "not the newest applied"},
    FaultProof{Check::kConfirmed, "confirmed", "X11", 2, "moved without being led"},
    FaultProof{Check::kStopEpoch, "stop-epoch", "X4", 4, "the stop was not latched"},
    FaultProof{Check::kPresence, "presence", "S6", 2, "led by nobody"},
    FaultProof{Check::kLoopAge, "loop-age", "N3", 5, "ms of a wrong warning"},
    FaultProof{Check::kQuality, "quality", "N1d", 4, "ms engaged over a link that is not good"},
    FaultProof{Check::kStaleSend, "stale-send", "P5", 4, "stopped late"},
    FaultProof{Check::kToolTube, "tool-tube", "X2b", 1, "off the tool"},
    FaultProof{Check::kLease, "lease", "X9b", 2, "orders of two operators at a time"},
    FaultProof{Check::kStopInput, "stop-input", "S4", 3, "went on by itself"},
    FaultProof{Check::kContact, "contact", "N3c", 2, "over the promised force"},
    FaultProof{Check::kSensorSign, "sensor-sign", "S3c", 3, "not found"},
    FaultProof{Check::kRelief, "relief", "S3e", 3, "not found", bit(Check::kSensorSign)},
    FaultProof{Check::kHashes, "hashes", "D3", 8, "ms engaged with another scene"},
    FaultProof{Check::kToolReach, "tool-reach", "X2c", 1, "further by itself"},
    FaultProof{Check::kToolLatch, "tool-latch", "X2c", 1, "further by itself"},
    FaultProof{Check::kStay, "stay", "X2d", 4, "left a hand that stands", 0, kRareWay},
    FaultProof{Check::kReach, "reach", "R1a", 5, "target further away"},
    FaultProof{Check::kWay, "way", "R1b", 28, "engaged over too long a way"},
    FaultProof{Check::kPhase, "phase", "R1b", 20, "beyond the limits at the controller"},
    FaultProof{Check::kPrompt, "prompt", "R1b", 20, "beyond the limits at the controller"},
    FaultProof{Check::kInTime, "in-time", "R3b", 20, "beyond the limits at the controller"},
    FaultProof{Check::kBegun, "begun", "R3c", 20, "beyond the limits at the controller"},
    FaultProof{Check::kHeardEnd, "heard-end", "R2", 15, "moved without being led"},
    FaultProof{Check::kUnseen, "unseen", "R4", 7, "engaged after a long pause"},
    FaultProof{Check::kMasterHold, "master-hold", "N10b", 2, "stopped late"},
    FaultProof{Check::kArmRange, "arm-range", "R5", 4, "engaged with a blind arm",
               bit(Check::kFollowing)},
    FaultProof{Check::kEpochs, "epochs", "P8", 2, "stops confirmed before they can have arrived"},
    FaultProof{Check::kResetSeen, "reset-seen", "P8", 2, "released without a reset that saw it"},
    FaultProof{Check::kOneMaster, "one-master", "X9a", 1, "datagrams of the second master applied"},
    FaultProof{Check::kLag, "lag", "R1c", 4, "over the promised force"},
};
static_assert(kProofs.size() == static_cast<std::size_t>(Check::kCount));

void set_deleted([[maybe_unused]] std::uint64_t checks) {
#ifdef HANDRAIL_DELETABLE
  deleted_checks = checks;
#endif
}

}  // namespace

std::span<const FaultProof> fault_proofs() { return kProofs; }

bool delete_check(const std::string& name) {
  const auto proof = std::find_if(kProofs.begin(), kProofs.end(),
                                  [&](const FaultProof& p) { return name == p.name; });
  if (proof == kProofs.end()) return false;
  set_deleted(bit(proof->check) | proof->with);
  return !kept(proof->check);
}

std::vector<ProofResult> prove_faults(std::uint64_t seed, int threads,
                                      const std::atomic<bool>& cancelled) {
  std::vector<ProofResult> results;
  const std::span<const FaultRow> rows = fault_rows();
  for (const FaultProof& proof : kProofs) {
    const auto row = std::find_if(rows.begin(), rows.end(), [&](const FaultRow& r) {
      return std::string(r.id) == proof.row;
    });
    ProofResult result{&proof};
    set_deleted(0);
    const std::uint64_t from = proof.seed != 0 ? proof.seed : seed;
    result.with = runs_that_find(*row, proof.runs, proof.found, from, threads, cancelled);
    set_deleted(bit(proof.check) | proof.with);
    result.without = runs_that_find(*row, proof.runs, proof.found, from, threads, cancelled);
    set_deleted(0);
    if (cancelled) break;
    results.push_back(result);
  }
  return results;
}

std::string proof_json(const std::vector<ProofResult>& results) {
  std::string out = "{\"checks\": [";
  for (const ProofResult& r : results) {
    out += fmt::format(
        "{}\n  {{\"check\": \"{}\", \"row\": \"{}\", \"runs\": {}, \"found_with\": {}, "
        "\"found_without\": {}, \"proven\": {}}}",
        &r == results.data() ? "" : ",", r.proof->name, r.proof->row, r.proof->runs, r.with,
        r.without, r.proven());
  }
  return out + "\n]}\n";
}

std::string proof_table(const std::vector<ProofResult>& results) {
  std::string out = fmt::format("  {:<14}{:<6}{:>5}{:>12}{:>14}  {}\n", "check", "row", "runs",
                                "red with it", "red without", "what is found");
  for (const ProofResult& r : results) {
    out += fmt::format("  {:<14}{:<6}{:>5}{:>12}{:>14}  {}{}\n", r.proof->name, r.proof->row,
                       r.proof->runs, r.with, r.without, r.proof->found,
                       r.proven() ? "" : "   NOT PROVEN");
  }
  return out;
}

}  // namespace handrail
