#include "server/lab/replay/replay_command.h"

#include <spdlog/fmt/fmt.h>

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <utility>

#include "server/base/clock.h"
#include "server/base/plain_text.h"
#include "server/base/units.h"
#include "server/base/version.h"
#include "server/lab/console/console.h"
#include "server/lab/replay/recording_csv.h"
#include "server/lab/replay/recording_join.h"
#include "server/lab/replay/replay.h"

namespace handrail {
namespace {

void print_line(const char* what, const std::string& value) {
  std::printf("  %-30s%s\n", what, value.c_str());
}

// Recorded and asked for, side by side.
void print_both(const ReplayResult& r) {
  std::printf("  %-30s%12s%12s\n", "", "recorded", "asked for");
  const auto row = [](const char* what, double was, double is, const char* unit) {
    std::printf("  %-30s%12.3f%12.3f %s\n", what, was, is, unit);
  };
  row("largest force on the hand", r.was.most_force, r.is.most_force, "N");
  row("mean force on the hand", r.was.mean_force, r.is.mean_force, "N");
  row("way of the command", r.was.way / kMm, r.is.way / kMm, "mm");
  row("hand furthest off the tool", r.was.most_off / kMm, r.is.most_off / kMm, "mm");
  row("time that the hand led", r.was.engaged, r.is.engaged, "s");
  print_line("orders refused", fmt::format("{:>12} {:>11}", r.was.refused, r.is.refused));
  std::printf("  %-30s%12s%12.3f mm\n", "commands apart, at most", "", r.apart / kMm);
  std::printf(
      "The hand is the recorded one: it did not feel what is asked here, and would have moved\n"
      "otherwise. Ask so about moments, and for what the hand would have felt, not for where a "
      "trial\n"
      "would have ended.\n");
}

void print_text(const ReplayCommand& command, const ReplayResult& r, bool asked, double took) {
  std::printf("%s: %s %s, %s\n", command.file.c_str(), r.program.c_str(), r.version.c_str(),
              shown(r.why).c_str());
  print_line("length", fmt::format("{:.3f} s, {} {}", r.seconds, r.entries,
                                   r.program == "handrail-slave" ? "cycles" : "ticks"));
  print_line("done again", fmt::format("{} in {:.2f} s, {:.0f} times as fast as it was", r.replayed,
                                       took, took > 0.0 ? r.seconds / took : 0.0));
  if (r.missing > 0) {
    print_line("missing in between",
               fmt::format("{}, {} of them not kept by the recorder", r.missing, r.lost));
  }
  for (const auto& event : r.happened) {
    print_line("happened",
               fmt::format("{:.3f} s: {}", to_seconds(event.at - r.begun), shown(event.text, 200)));
  }
  if (!r.damage.empty()) print_line("the file", r.damage);
  if (asked) return print_both(r);
  if (!r.same_build) {
    print_line("another build", fmt::format("this is {}: compared within {:g}, from where the "
                                            "program began",
                                            program_version(), kOtherBuild));
  }
  if (!r.first) {
    print_line("result", !r.same_build             ? "the same within that"
                         : command.other_processor ? "the same within 1e-9"
                                                   : "the same to the bit");
    return;
  }
  print_line("different", fmt::format("{} of {}", r.different, r.replayed));
  print_line("the first", fmt::format("number {}, {:.3f} s after the first: {}", r.first->number,
                                      r.first->at, r.first->field));
}

std::string quoted(const std::string& text) {
  std::string out = "\"";
  for (const char c : shown(text, 400)) {
    if (c == '"' || c == '\\') out += '\\';
    out += c;
  }
  return out + "\"";
}

void print_json(const ReplayResult& r, double took) {
  std::string marks;
  for (const auto& event : r.happened) {
    marks += fmt::format("{}{{\"at_s\": {}, \"text\": {}}}", marks.empty() ? "" : ", ",
                         to_seconds(event.at - r.begun), quoted(event.text));
  }
  const auto summary = [](const ReplaySummary& s) {
    return fmt::format(
        "{{\"most_force_n\": {}, \"mean_force_n\": {}, \"way_mm\": {}, "
        "\"most_off_mm\": {}, \"engaged_s\": {}, \"refused\": {}}}",
        s.most_force, s.mean_force, s.way / kMm, s.most_off / kMm, s.engaged, s.refused);
  };
  std::string first = "null";
  if (r.first) {
    first = fmt::format("{{\"number\": {}, \"at_s\": {}, \"field\": {}}}", r.first->number,
                        r.first->at, quoted(r.first->field));
  }
  std::printf(
      "%s\n",
      fmt::format("{{\"program\": {}, \"version\": {}, \"why\": {}, \"same_build\": {}, "
                  "\"seconds\": {}, \"begun_s\": {:.6f}, \"entries\": {}, \"replayed\": {}, "
                  "\"lost\": {}, \"missing\": {}, "
                  "\"different\": {}, \"first\": {}, \"damage\": {}, \"took_s\": {}, "
                  "\"recorded\": {}, \"asked\": {}, \"apart_mm\": {}, \"happened\": [{}]}}",
                  quoted(r.program), quoted(r.version), quoted(r.why), r.same_build, r.seconds,
                  to_seconds(r.begun), r.entries, r.replayed, r.lost, r.missing, r.different, first,
                  quoted(r.damage), took, summary(r.was), summary(r.is), r.apart / kMm, marks)
          .c_str());
}

}  // namespace

int run_replay_command(const ReplayCommand& command, const std::function<bool()>& cancelled) {
  auto overrides = parse_overrides(command.set);
  if (!overrides) return complain(overrides.status(), kUsage);
  ReplayOptions options;
  options.overrides = *overrides;
  options.scene = command.scene;
  options.tool = command.tool;
  if (!command.link.empty()) {
    const auto words = link_words(command.link);
    if (!words) return complain(words.status(), kUsage);
    options.link = *words;
  }
  options.images = !command.no_images;
  options.exact = !command.other_processor;
  options.cancelled = cancelled;
  std::ifstream in(command.file, std::ios::binary);
  if (!in) {
    return complain(Status::error(command.file + ": cannot be read: " + std::strerror(errno)),
                    kUsage);
  }
  const Nanos begun = monotonic_now();
  const auto result = replay(in, options);
  const double took = to_seconds(monotonic_now() - begun);
  if (cancelled()) return kCancelled;
  if (!result) return complain(Status::error(command.file + ": " + result.message()), kUsage);
  const bool asked = !options.as_recorded();
  if (command.json) {
    print_json(*result, took);
  } else {
    print_text(command, *result, asked, took);
  }
  if (result->replayed == 0) {
    return complain(Status::error(command.file + ": nothing could be done again: it holds no image "
                                                 "that this build can go on from"),
                    kFailed);
  }
  return asked || (!result->first && result->damage.empty()) ? kDone : kFailed;
}

int run_join_command(const JoinCommand& command) {
  std::ifstream first(command.first, std::ios::binary), second(command.second, std::ios::binary);
  for (const auto& [in, name] : {std::pair(&first, &command.first), {&second, &command.second}}) {
    if (*in) continue;
    return complain(Status::error(*name + ": cannot be read: " + std::strerror(errno)), kUsage);
  }
  const auto joined = join_recordings(first, second, command.out);
  if (!joined) {
    return complain(Status::error(command.first + ", " + command.second + ": " + joined.message()),
                    kUsage);
  }
  if (command.json) {
    std::printf(
        "{\"offset_ms\": %.6f, \"bound_ms\": %.6f, \"measures\": %llu, \"both_s\": %.3f, "
        "\"messages\": %llu}\n",
        1e3 * to_seconds(joined->offset), 1e3 * to_seconds(joined->bound),
        static_cast<unsigned long long>(joined->measures), to_seconds(joined->both),
        static_cast<unsigned long long>(joined->messages));
    return kDone;
  }
  std::printf(
      "the slave's clock is %.3f ms ahead of the master's, to %.3f ms (half of the shortest round\n"
      "trip of %llu datagrams); both recorded for %.3f s\n",
      1e3 * to_seconds(joined->offset), 1e3 * to_seconds(joined->bound),
      static_cast<unsigned long long>(joined->measures), to_seconds(joined->both));
  if (!command.out.empty()) {
    std::printf("%s: %llu messages, the slave's times on the master's calendar\n",
                command.out.c_str(), static_cast<unsigned long long>(joined->messages));
  }
  return kDone;
}

int run_recording_csv_command(const RecordingCsvCommand& command) {
  std::ifstream in(command.file, std::ios::binary);
  if (!in) {
    return complain(Status::error(command.file + ": cannot be read: " + std::strerror(errno)),
                    kUsage);
  }
  // What was there stays until the new one is whole.
  const std::string part = command.out + ".part";
  std::ofstream out(part);
  const auto cannot = [&](const Status& why, int code) {
    std::error_code ignored;
    std::filesystem::remove(part, ignored);
    return complain(why, code);
  };
  const auto unwritable = [&] {
    return Status::error(command.out + ": cannot be written: " + std::strerror(errno));
  };
  if (!out) return cannot(unwritable(), kFailed);
  const auto rows = command.packets ? write_packets_csv(in, out)
                                    : write_recording_csv(in, out, command.hz, command.trial);
  if (!rows) return cannot(Status::error(command.file + ": " + rows.message()), kUsage);
  out.close();
  if (!out || std::rename(part.c_str(), command.out.c_str()) != 0)
    return cannot(unwritable(), kFailed);
  std::printf("%s: %llu rows\n", command.out.c_str(), static_cast<unsigned long long>(*rows));
  return kDone;
}

}  // namespace handrail
