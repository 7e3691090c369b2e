// Rows of recordings: of the disk, and of a program that is killed while it writes.
#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <optional>

#include "proto/record.pb.h"
#include "server/base/clock.h"
#include "server/record/mcap/mcap_reader.h"
#include "server/record/recording_repair.h"
#include "tests/faults/trial.h"

namespace handrail::faults::rows {
namespace {

constexpr Nanos kTold = kSecond;  // an operator knows by then

// A bed whose master writes down what it does, on a disk that is as one says.
struct RecordingBed {
  explicit RecordingBed(Trial& trial) {
    BedOptions options;
    options.master = "env POOR_DISK=FOLDER/disk LD_PRELOAD=" POOR_DISK;
    options.master_config = "recording {}";
    bed = trial.bed(options);
  }
  std::string mode() const { return bed->folder() + "/disk"; }
  std::string recordings() const { return bed->folder() + "/recordings"; }
  void disk(const std::string& is) {
    // At once: nobody reads half a word.
    std::ofstream(mode() + ".new") << is;
    std::filesystem::rename(mode() + ".new", mode());
  }
  void record() {
    std::string said;
    if (!bed->order("record { on: true }", &said)) bed->problem("cannot record: " + said);
  }
  std::vector<std::string> files() const {
    std::vector<std::string> out;
    std::error_code none;
    for (const auto& entry : std::filesystem::directory_iterator(recordings(), none))
      out.push_back(entry.path().string());
    std::sort(out.begin(), out.end());
    return out;
  }

  std::unique_ptr<Bed> bed;
};

// What a file holds.
struct Held {
  std::uint64_t ticks = 0, skipped = 0;  // ticks; numbers that are missing between them
  Nanos last = 0;                        // when the last of them was
  std::uint64_t gaps = 0, lost = 0;      // chunks and ticks that are said to be missing
  bool complete = false;
  std::string damage;
};

Held held_by(const std::string& file) {
  Held out;
  std::ifstream in(file, std::ios::binary);
  McapReader reader(in);
  pb::RecordedTick tick;
  pb::RecordedEvent event;
  std::uint64_t number = 0;
  while (const auto message = reader.next()) {
    const McapSchema* schema = reader.schema_of(message->channel);
    if (schema == nullptr) continue;
    const auto size = static_cast<int>(message->data.size());
    if (schema->name == "handrail.pb.RecordedTick" &&
        tick.ParseFromArray(message->data.data(), size)) {
      if (number != 0) out.skipped += tick.number() - number - 1;
      number = tick.number();
      ++out.ticks;
      out.last = tick.at_ns();
    } else if (schema->name == "handrail.pb.RecordedEvent" &&
               event.ParseFromArray(message->data.data(), size)) {
      if (event.kind() == pb::RecordedEvent::DISK) out.gaps += event.count();
      if (event.kind() == pb::RecordedEvent::LOST) out.lost += event.count();
    }
  }
  out.complete = reader.complete();
  out.damage = reader.damage();
  return out;
}

// How long it takes until the status is so; nothing: longer than `patience`.
template <typename So>
std::optional<Nanos> until(Bed& bed, Nanos patience, const So& so) {
  const Nanos begun = monotonic_now();
  while (monotonic_now() - begun < patience && !bed.over()) {
    bool is_so = false;
    bed.drive(50 * kMillisecond, [&](const pb::Status& s) { is_so = is_so || so(s.recording()); });
    if (is_so) return monotonic_now() - begun;
  }
  return std::nullopt;
}

// The disk is poor for a while, and good again; says how soon an operator knew of both.
void make_poor(Trial& trial, RecordingBed& at, const std::string& how, Nanos span) {
  at.disk(how);
  const auto told = until(*at.bed, 3 * kTold, [](const auto& r) { return r.has_problem(); });
  at.bed->drive(span);
  at.disk("good");
  const auto over = until(*at.bed, 5 * kTold, [](const auto& r) { return !r.has_problem(); });
  trial.check(told.has_value() && *told <= kTold, how + ": nobody was told within 1 s");
  trial.check(over.has_value(), how + ": it is not said that it is over");
  if (told && over)
    trial.measure(fmt::format("{}: told after {:.0f} ms, over after {:.0f} ms", how, in_ms(*told),
                              in_ms(*over)));
}

}  // namespace

RowResult d1(const RowRun& run) {
  Trial trial(run,
              "the disk of a recording is full, broken, and slow (1 s a write), and the folder is "
              "removed",
              "no gap; told within 1 s; what was written is whole, what is not is marked");
  RecordingBed at(trial);
  if (!at.bed) return trial.result();
  at.record();
  at.bed->drive(kSecond);
  const auto first = at.bed->status();
  const Nanos span = (run.full ? 30 : 1) * kSecond;
  for (const char* how : {"full", "broken", "slow"}) make_poor(trial, at, how, span);
  at.bed->drive(kSecond);
  const std::vector<std::string> before = at.files();
  const Held held = before.size() == 1 ? held_by(before[0]) : Held();
  trial.check(before.size() == 1, fmt::format("{} files of one recording", before.size()));
  trial.check(held.ticks > 3000, fmt::format("only {} ticks could be read", held.ticks));
  trial.check(held.gaps > 0, "no gap is marked");
  // The file is still being written: it need not be whole, but what is there is sound.
  trial.check(held.skipped > 0, "a disk that was full took everything");
  trial.measure(fmt::format("{} ticks readable, {} not, in {} chunks and {} lost", held.ticks,
                            held.skipped, held.gaps, held.lost));
  std::filesystem::remove_all(at.recordings());
  const auto again = until(*at.bed, 3 * kTold, [&](const auto&) { return !at.files().empty(); });
  trial.check(again.has_value(), "no other file after the folder was removed");
  at.bed->drive(kSecond);
  const auto last = at.bed->status();
  if (first && last)
    trial.measure(fmt::format("the loop late by {:.0f} us (99.9 %), {:.0f} before",
                              last->loop_lateness_us().p999(), first->loop_lateness_us().p999()));
  const BedVerdict verdict = trial.end(std::move(at.bed));
  judge_acceptance(trial, verdict);
  trial.check(verdict.link.trips == 0, "a gap of the link");
  return trial.result();
}

RowResult d2(const RowRun& run) {
  constexpr Nanos kReadable = 100 * kMillisecond;
  Trial trial(run, "the master is killed while it records, at random moments",
              "readable to within 100 ms of the kill; repaired it is whole");
  RecordingBed at(trial);
  if (!at.bed) return trial.result();
  const int kills = run.full ? 100 : 5;
  Nanos worst = 0;
  int repaired = 0, done = 0;
  for (; done < kills && !at.bed->over(); ++done) {
    at.record();
    const std::size_t before = at.files().size();
    at.bed->drive(from_seconds(0.3 + 1.2 * at.bed->random().uniform()));
    const Nanos killed = monotonic_now();
    at.bed->signal(Who::kMaster, "KILL");
    at.bed->wait(300 * kMillisecond);
    const std::vector<std::string> files = at.files();
    if (files.empty()) {
      trial.check(false, "no file");
      break;
    }
    trial.check(files.size() > before || before > 0, "no file of its own");
    const Held held = held_by(files.back());
    worst = std::max(worst, killed - held.last);
    trial.check(held.skipped == 0, "ticks are missing in the midst of a file");
    const std::string whole = at.bed->folder() + fmt::format("/whole{}.mcap", done);
    std::ifstream in(files.back(), std::ios::binary);
    const auto fixed = repair_recording(in, whole);
    const Held after = fixed ? held_by(whole) : Held();
    if (after.complete && after.ticks == held.ticks && held.ticks > 0) ++repaired;
    if (const Status started = at.bed->start(Who::kMaster); !started)
      at.bed->problem(started.message());
    if (!at.bed->engage()) at.bed->problem("cannot be engaged again");
  }
  const BedVerdict verdict = trial.end(std::move(at.bed));
  trial.measure(fmt::format("{} kills: readable to {:.0f} ms before at most, {} repaired", done,
                            in_ms(worst), repaired));
  trial.check(worst <= kReadable + verdict.link.lateness, "more than 100 ms are missing");
  trial.check(repaired == done, "not all could be repaired");
  return trial.result();
}

}  // namespace handrail::faults::rows
