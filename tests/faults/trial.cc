#include "tests/faults/trial.h"

#include <spdlog/fmt/fmt.h>
#include <spdlog/fmt/ranges.h>

#include <filesystem>
#include <fstream>

namespace handrail::faults {
namespace {

constexpr const char* kEverywhere =
    "joint limits; each stop in its bound; no motion unled; every program ends well";
constexpr std::size_t kMostFound = 6;  // that are told

}  // namespace

Trial::Trial(const RowRun& run, std::string done, std::string asked)
    : run_(run), done_(std::move(done)), asked_(std::move(asked)) {
  asked_ += (asked_.empty() ? "" : "; ") + std::string(kEverywhere);
}

std::unique_ptr<Bed> Trial::bed(BedOptions options, bool idle) {
  options.seed = run_.seed + 1000 * beds_++;
  options.interrupted = run_.interrupted;
  auto out = std::make_unique<Bed>(options);
  const Status started = out->start();
  std::string why = started ? "" : started.message();
  if (started && !idle && !out->engage(30 * kSecond)) {
    why = "cannot be engaged: " + out->engage_said() + out->printed(Who::kMaster) +
          out->printed(Who::kSlave);
  }
  if (why.empty()) return out;
  if (!over()) found_.push_back("no start: " + why);
  return nullptr;
}

BedVerdict Trial::end(std::unique_ptr<Bed> bed) {
  BedVerdict out = bed->finish();
  if (over()) return out;
  limits_.add(out.limits);
  const AuditReport& audit = out.link.report;
  if (audit.stops > 0 &&
      (stops_ == 0 || audit.worst.took - audit.worst.allowed > worst_.took - worst_.allowed)) {
    worst_ = audit.worst;
  }
  stops_ += audit.stops;
  lateness_ = std::max(lateness_, out.link.lateness);
  found_.insert(found_.end(), out.violations.begin(), out.violations.end());
  keep(*bed);
  return out;
}

RowResult Trial::result() const {
  RowResult out;
  out.done = done_;
  out.asked = asked_;
  out.measured = fmt::format("{}", fmt::join(measured_, "; "));
  if (stops_ > 0) {
    out.measured += fmt::format(
        "{}{} stops, the nearest to its bound {:.1f} of {:.1f} ms, up to {:.1f} ms late granted",
        measured_.empty() ? "" : "; ", stops_, in_ms(worst_.took), in_ms(worst_.allowed),
        in_ms(lateness_));
  }
  if (limits_.targets > 0) {
    out.measured +=
        fmt::format("; of {} targets {} beyond a limit (jerk {:.2f}), {} cycles held, {} halts",
                    limits_.targets, limits_.breaches, limits_.jerk, limits_.held, limits_.halts);
  }
  if (over()) {
    out.outcome = Outcome::kStopped;
  } else if (!found_.empty()) {
    out.outcome = Outcome::kFailed;
    const auto told = std::min(found_.size(), kMostFound);
    out.why = fmt::format(
        "{}", fmt::join(found_.begin(), found_.begin() + static_cast<std::ptrdiff_t>(told), " | "));
    if (told < found_.size()) out.why += fmt::format(" | and {} more", found_.size() - told);
  } else if (!skipped_.empty()) {
    out.outcome = Outcome::kSkipped;
    out.why = skipped_;
  }
  keep_if(out.outcome == Outcome::kFailed);
  return out;
}

// Configurations, outputs and taps; no keys.
void Trial::keep(const Bed& bed) const {
  constexpr std::uintmax_t kMost = 200 << 20;  // of a file [bytes]
  if (run_.keep.empty()) return;
  const std::filesystem::path to = run_.keep;
  std::error_code error;
  std::filesystem::create_directories(to, error);
  for (const auto& entry : std::filesystem::directory_iterator(bed.folder(), error)) {
    if (!entry.is_regular_file() || entry.file_size() > kMost) continue;
    std::filesystem::copy_file(entry.path(),
                               to / fmt::format("{}-{}", beds_, entry.path().filename().string()),
                               std::filesystem::copy_options::overwrite_existing, error);
  }
}

void Trial::keep_if(bool failed) const {
  if (run_.keep.empty()) return;
  const std::filesystem::path in = run_.keep;
  std::error_code error;
  if (!failed) std::filesystem::remove_all(in, error);
  if (!failed) return;
  std::ofstream found(in / "found.txt");
  for (const std::string& line : found_) found << line << "\n";
}

void judge_acceptance(Trial& trial, const BedVerdict& verdict) {
  const std::uint64_t fresh = verdict.fresh;
  if (!verdict.accepted) {
    trial.check(false, "the slave does not say what it accepted");
    return;
  }
  trial.measure(fmt::format(
      "{} accepted of {} fresh; {} overtaken, {} duplicated, {} replayed, {} corrupted, {} "
      "injected",
      *verdict.accepted, fresh, verdict.truth.overtaken,
      verdict.truth.delivered(Origin::kDuplicate), verdict.truth.delivered(Origin::kReplay),
      verdict.truth.delivered(Origin::kCorrupt), verdict.truth.delivered(Origin::kInjected)));
  trial.check(*verdict.accepted <= fresh,
              fmt::format("{} accepted that were not the newest of the master's",
                          *verdict.accepted - std::min(*verdict.accepted, fresh)));
}

}  // namespace handrail::faults
