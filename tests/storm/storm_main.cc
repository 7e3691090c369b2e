// handrail-storm: the real programs, paused, cut off, ended and started anew at random while the
// hand drives at speed; judged at the clock of the rig's controller.
#include <spdlog/fmt/fmt.h>
#include <unistd.h>

#include <charconv>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <random>
#include <string>

#include "client/cli/interrupt.h"
#include "server/base/output.h"
#include "server/base/version.h"
#include "server/lab/console/console.h"
#include "tests/storm/crowded.h"
#include "tests/storm/demos.h"
#include "tests/storm/results.h"
#include "tests/storm/soak.h"

namespace {

using handrail::storm::Outcome;
using handrail::storm::Results;
using handrail::storm::Run;
using handrail::storm::Sequence;
using handrail::storm::Summary;

const char kUsage[] =
    "usage: handrail-storm [--sequences N] [--seed S] [--results FILE] [--keep FOLDER] [--json]\n"
    "       handrail-storm --demos N [--seed S]\n"
    "       handrail-storm --crowded STOPS [--pairs N] [--seed S] [--json]\n"
    "       handrail-storm --soak MINUTES [--seed S] [--keep FOLDER]\n"
    "\n"
    "Starts rig, slave and master, drives at speed, pauses, cuts off, ends and restarts them at\n"
    "random, follows `handrail why` out of it and drives again. In every sequence the arm keeps "
    "its\n"
    "limits at the controller's clock, stands after a stop until reset and engage, and follows "
    "again\n"
    "in the end. One line a sequence. Exit codes: 0 nothing was violated, 1 something was, 2 "
    "usage\n"
    "or bad file, 130 stopped.\n"
    "\n"
    "  --demos N        N times `handrail demo`, once every 20 s with one of its programs paused "
    "for\n"
    "                   20 to 500 ms; each has to end with its table\n"
    "  --crowded STOPS  stops and engages so often while logs and a disk are stuck and 1000 "
    "clients\n"
    "                   crowd in, in windows with and without: how long a stop takes to the slave "
    "and how\n"
    "                   late the loops are; takes half a minute a pair of windows, more with "
    "over\n"
    "                   30 stops in each\n"
    "  --pairs N        so many windows with and without, for --crowded (10)\n"
    "  --soak MINUTES   faults and clients without a restart; no program may grow by more than 1 "
    "MiB "
    "an\n"
    "                   hour\n"
    "  --sequences N    seeds S to S+N-1 (50)\n"
    "  --seed S         of the first; drawn and printed when absent\n"
    "  --results FILE   a line a sequence; those in it are not run again\n"
    "  --keep FOLDER    of each violated sequence: taps, outputs, story and traces (handrail-storm "
    "in\n"
    "                   the folder for temporary files)\n"
    "  --json           the summary alone, for programs\n";

constexpr std::uint64_t kMostStops = 100'000;  // half a day
constexpr std::uint64_t kMostMinutes = 1440;   // a day

struct Arguments {
  std::uint64_t sequences = 50, seed = 0, demos = 0, crowded = 0, soak = 0;
  std::uint64_t pairs = handrail::storm::kPairs;
  std::string results;
  // Named here, before the taps go elsewhere.
  std::filesystem::path keep =
      std::filesystem::temp_directory_path() / ("handrail-storm-" + std::to_string(::getuid()));
  bool json = false;
};

int complain(const std::string& text) {
  std::fprintf(stderr, "handrail-storm: %s\n", text.c_str());
  return handrail::kUsage;
}

bool read_number(const std::string& text, std::uint64_t low, std::uint64_t& out) {
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), out);
  return error == std::errc() && end == text.data() + text.size() && out >= low;
}

// 0: go on.
int read_arguments(int argc, char** argv, Arguments& out) {
  bool seeded = false;
  for (int i = 1; i < argc; ++i) {
    const std::string name = argv[i];
    if (name == "--json") {
      out.json = true;
      continue;
    }
    if (i + 1 == argc) return complain("'" + name + "': unknown, or its value is missing");
    const std::string value = argv[++i];
    if (name == "--sequences") {
      if (!read_number(value, 1, out.sequences)) {
        return complain("--sequences '" + value + "': expected a number from 1 on");
      }
    } else if (name == "--demos") {
      if (!read_number(value, 1, out.demos)) {
        return complain("--demos '" + value + "': expected a number from 1 on");
      }
    } else if (name == "--crowded") {
      if (!read_number(value, 1, out.crowded) || out.crowded > kMostStops) {
        return complain("--crowded '" + value + "': expected a number from 1 to " +
                        std::to_string(kMostStops));
      }
    } else if (name == "--pairs") {
      using namespace handrail::storm;
      if (!read_number(value, kFewestPairs, out.pairs) || out.pairs > kMostPairs) {
        return complain("--pairs '" + value + "': expected a number from " +
                        std::to_string(kFewestPairs) + " to " + std::to_string(kMostPairs));
      }
    } else if (name == "--soak") {
      if (!read_number(value, 1, out.soak) || out.soak > kMostMinutes) {
        return complain("--soak '" + value + "': expected whole minutes from 1 to " +
                        std::to_string(kMostMinutes));
      }
    } else if (name == "--seed") {
      seeded = read_number(value, 0, out.seed);
      if (!seeded) return complain("--seed '" + value + "': expected a number from 0 on");
    } else if (name == "--results") {
      out.results = value;
    } else if (name == "--keep") {
      out.keep = value;
    } else {
      return complain(
          "'" + name +
          "': unknown; expected --sequences, --demos, --crowded, --pairs, --soak, --seed, "
          "--results, --keep or --json");
    }
  }
  // Small enough to be typed.
  if (!seeded) out.seed = std::random_device()() % 1'000'000;
  return 0;
}

// Copies what a sequence left, into a folder of its own.
void keep(const std::filesystem::path& to, const Sequence& sequence, const Outcome& outcome,
          const Run& run) {
  using namespace handrail;
  std::error_code error;
  std::filesystem::remove_all(to, error);
  std::filesystem::create_directories(to, error);
  for (const auto& entry : std::filesystem::directory_iterator(run.cell().folder().path(), error)) {
    if (!entry.is_regular_file()) continue;
    std::filesystem::copy_file(entry.path(), to / entry.path().filename(), error);
  }
  std::ofstream story(to / "story.txt");
  story << text(sequence) << "\n\n";
  for (const auto& line : outcome.story) {
    story << fmt::format("{:8.3f} s  {}\n", to_seconds(line.at - outcome.start), line.what);
  }
  for (const auto& v : outcome.violations) {
    story << fmt::format("\n{:.3f} s: {}\n", to_seconds(v.at - outcome.start), v.what);
    for (const std::string& path : run.cell().taps()) {
      const auto tap = read_tap(path);
      if (tap) story << storm::trace(*tap, v.at, 8, 8);
    }
  }
  if (error || !story) {
    std::fprintf(stderr, "handrail-storm: %s: %s\n", to.c_str(), error.message().c_str());
  }
}

// How to see a violated sequence again.
std::string again(std::uint64_t seed, const std::filesystem::path& kept) {
  const bool there = std::filesystem::exists(kept);
  return fmt::format("    again: handrail-storm --sequences 1 --seed {}; {}\n", seed,
                     there ? "kept: " + kept.string() : "nothing of it in " + kept.string());
}

int run_demos(const Arguments& arguments) {
  std::uint64_t failed = 0;
  for (std::uint64_t i = 0; i < arguments.demos; ++i) {
    const std::uint64_t seed = arguments.seed + i;
    const auto out = handrail::storm::run_demo(seed, handrail::interrupted);
    if (!out.complete) {
      (void)complain(fmt::format("stopped after {} of {} demos", i, arguments.demos));
      return handrail::kCancelled;
    }
    failed += out.problem.empty() ? 0 : 1;
    fmt::print("demo {}: {} pauses, {}\n", seed, out.pauses,
               out.problem.empty() ? "ended with its table" : "FAILED: " + out.problem);
    std::fflush(stdout);
  }
  fmt::print("{} of {} demos ended with their table\n", arguments.demos - failed, arguments.demos);
  return failed == 0 ? handrail::kDone : handrail::kFailed;
}

int run_crowded(const Arguments& arguments) {
  handrail::storm::CrowdedOptions options;
  options.stops = static_cast<int>(arguments.crowded);
  options.pairs = static_cast<int>(arguments.pairs);
  options.seed = arguments.seed;
  std::fprintf(stderr, "handrail-storm: %d stops in %d pairs of windows from seed %llu\n",
               options.stops, options.pairs, static_cast<unsigned long long>(options.seed));
  const auto out =
      handrail::storm::run_crowded(options, handrail::interrupted, [](int window, int of) {
        std::fprintf(stderr, "handrail-storm: window %d of %d\n", window, of);
      });
  if (!out.complete) {
    (void)complain(fmt::format("stopped after {} windows", out.windows.size()));
    return handrail::kCancelled;
  }
  if (!out.problem.empty()) {
    (void)complain(out.problem);
    return handrail::kFailed;
  }
  std::fputs((arguments.json ? to_json(options, out) : for_people(out)).c_str(), stdout);
  return figures_of(out.windows).reached() ? handrail::kDone : handrail::kFailed;
}

int run_soak(const Arguments& arguments) {
  const auto say = [](const std::string& line) {
    fmt::print("{}\n", line);
    std::fflush(stdout);
  };
  say(fmt::format("soak: {} min from seed {}", arguments.soak, arguments.seed));
  const auto kept = arguments.keep / ("soak-" + std::to_string(arguments.seed));
  const auto out = handrail::storm::run_soak(
      arguments.seed, static_cast<double>(arguments.soak), handrail::interrupted, say,
      [&](const Sequence& sequence, const Outcome& outcome, const Run& run) {
        keep(kept, sequence, outcome, run);
        say("kept: " + kept.string());
      });
  std::fputs(for_people(out).c_str(), stdout);
  if (!out.complete) return handrail::kCancelled;
  return out.violations.empty() && !grows(out) ? handrail::kDone : handrail::kFailed;
}

// A line a sequence; those that `results` has are not run again. 0: all, or as many as came before
// it was stopped.
int run_sequences(const Arguments& arguments, Results& results, Summary& all) {
  handrail::Progress progress;
  for (std::uint64_t i = 0; i < arguments.sequences && !handrail::interrupted(); ++i) {
    const std::uint64_t seed = arguments.seed + i;
    const auto kept = arguments.keep / std::to_string(seed);
    progress.show(
        fmt::format("{} of {} sequences, {} violated", i, arguments.sequences, all.red.size()));
    if (!results.has(seed)) {
      const Sequence sequence = handrail::storm::draw(seed);
      Run run(sequence, handrail::interrupted);
      const Outcome outcome = run.go();
      if (!outcome.complete) break;
      if (!outcome.violations.empty()) keep(kept, sequence, outcome, run);
      if (const auto added = results.add(line_of(sequence, outcome)); !added) {
        return complain(added.message());
      }
    }
    const auto& line = results.of(seed);
    all.add(line);
    progress.clear();
    std::FILE* const to = arguments.json ? stderr : stdout;
    if (!arguments.json || !line.ok) std::fputs(for_people(line).c_str(), to);
    if (!line.ok) std::fputs(again(seed, kept).c_str(), to);
    std::fflush(to);
  }
  return 0;
}

// How to go on with sequences that were stopped.
std::string goes_on(const Arguments& arguments) {
  if (arguments.results.empty()) return "with --results FILE it could go on";
  return fmt::format("--sequences {} --seed {} --results {} goes on", arguments.sequences,
                     arguments.seed, arguments.results);
}

int run_storm(const Arguments& arguments) {
  std::error_code error;
  std::filesystem::create_directories(arguments.keep, error);
  if (error) return complain(arguments.keep.string() + ": " + error.message());
  Results results;
  if (const auto opened = results.open(arguments.results); !opened) {
    return complain(opened.message());
  }
  if (!arguments.json) {
    fmt::print("storm: {} sequences from seed {}\n", arguments.sequences, arguments.seed);
    std::fflush(stdout);
  }
  Summary all;
  if (const int code = run_sequences(arguments, results, all); code != 0) return code;
  if (all.ran < arguments.sequences) {
    (void)complain(fmt::format("stopped after {} of {} sequences, {} violated; {}", all.ran,
                               arguments.sequences, all.red.size(), goes_on(arguments)));
    return handrail::kCancelled;
  }
  std::fputs((arguments.json ? to_json(all) : for_people(all)).c_str(), stdout);
  return all.red.empty() ? handrail::kDone : handrail::kFailed;
}

int run(int argc, char** argv) {
  for (int i = 1; i < argc; ++i) {
    if (std::string(argv[i]) != "--help" && std::string(argv[i]) != "-h") continue;
    std::fputs(kUsage, stdout);
    return 0;
  }
  Arguments arguments;
  if (const int code = read_arguments(argc, argv, arguments); code != 0) return code;
  if (arguments.demos > 0) {
    handrail::catch_interrupts();
    return run_demos(arguments);
  }
  // Taps and sockets lie in memory where there is such a folder: no disk holds a control thread.
  if (std::filesystem::is_directory("/dev/shm")) ::setenv("TMPDIR", "/dev/shm", 0);
  handrail::catch_interrupts();
  if (arguments.crowded > 0) return run_crowded(arguments);
  if (arguments.soak > 0) return run_soak(arguments);
  return run_storm(arguments);
}

}  // namespace

int main(int argc, char** argv) {
  if (handrail::says_version("handrail-storm", argc, argv)) return 0;
  return handrail::end_output("handrail-storm", run(argc, argv));
}
