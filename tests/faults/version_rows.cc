// The row of peers who have the right key and speak another version of the wire contract.
#include <spdlog/fmt/fmt.h>

#include <cstdlib>

#include "server/base/clock.h"
#include "server/link/codec.h"
#include "tests/faults/trial.h"

namespace handrail::faults::rows {
namespace {

// The number behind `name` in `text`, or 0.
std::uint64_t number_after(const std::string& text, const std::string& name) {
  const std::size_t at = text.rfind(name);
  return at == text.npos ? 0 : std::strtoull(text.c_str() + at + name.size(), nullptr, 10);
}

}  // namespace

RowResult x10(const RowRun& run) {
  Trial trial(
      run,
      "the master's own key in a program that says an older and a newer version, an unknown "
      "field, kind and a cut message; then what it may say",
      "each refused by its cause, all of what is sound accepted, no motion; the log names both "
      "versions");
  auto bed = trial.bed();
  if (!bed) return trial.result();
  bed->drive(500 * kMillisecond);
  bed->signal(Who::kMaster, "TERM");
  bed->must_stop(monotonic_now() + kSecond);  // it brakes before it ends
  bed->wait(2 * kSecond);
  const int span = run.full ? 10'000 : 1000;
  const Status ran = bed->run(
      "near", "peer",
      fmt::format("exec {}/handrail-faults-peer {} 10.77.0.2 {} older newer field kind short same",
                  HANDRAIL_BIN_DIR, bed->keys(Who::kMaster), span));
  if (!ran) bed->problem(ran.message());
  const Nanos give_up = monotonic_now() + 30 * kSecond + 6 * span * kMillisecond;
  while (!bed->over() && monotonic_now() < give_up &&
         bed->printed("near", "peer").find("DONE") == std::string::npos) {
    bed->wait(50 * kMillisecond);
  }
  const std::string sent = bed->printed("near", "peer");
  if (const Status started = bed->start(Who::kMaster); !started) bed->problem(started.message());
  trial.check(bed->over() || bed->engage(30 * kSecond), "the master cannot be engaged again");
  bed->wait(200 * kMillisecond);
  const std::string early = bed->printed(Who::kSlave);
  bed->signal(Who::kSlave, "TERM");
  bed->wait(kSecond);
  const std::string log = bed->printed(Who::kSlave);
  if (const Status started = bed->start(Who::kSlave); !started) bed->problem(started.message());
  (void)bed->connected(5 * kSecond);
  (void)trial.end(std::move(bed));
  struct Cause {
    const char* variants[2];
    const char* text;
  };
  for (const Cause& cause : {Cause{{"older=", "newer="}, "another protocol version "},
                             Cause{{"field=", nullptr}, "unknown field or enum value "},
                             Cause{{"kind=", nullptr}, "wrong direction "},
                             Cause{{"short=", nullptr}, "malformed payload "}}) {
    std::uint64_t wanted = 0;
    for (const char* variant : cause.variants) {
      if (variant != nullptr) wanted += number_after(sent, variant);
    }
    const std::uint64_t counted = number_after(log, cause.text);
    trial.measure(fmt::format("{}{} of {}", cause.text, counted, wanted));
    trial.check(trial.over() || (wanted > 0 && counted == wanted),
                fmt::format("{}: not each counted", cause.text));
  }
  trial.measure(fmt::format("sound ones sent {}", number_after(sent, "same=")));
  trial.check(trial.over() || number_after(sent, "same=") > 0, "no sound one was sent: " + sent);
  trial.check(trial.over() || early.find(fmt::format("speaks wire version {}, this program {}",
                                                     kWireVersion - 1, kWireVersion)) != early.npos,
              "the slave's log does not name the other version");
  return trial.result();
}

}  // namespace handrail::faults::rows
