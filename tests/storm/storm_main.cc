// handrail-storm: the real programs, paused, cut off, ended and started anew at random while the
// hand drives at speed; judged at the clock of the rig's controller.
#include <spdlog/fmt/fmt.h>

#include <charconv>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <random>
#include <string>

#include "client/cli/interrupt.h"
#include "tests/storm/results.h"

namespace {

using handrail::storm::Figures;
using handrail::storm::Outcome;
using handrail::storm::Results;
using handrail::storm::Run;
using handrail::storm::Sequence;

constexpr int kViolated = 1, kBadInput = 2, kInterrupted = 130;

const char kUsage[] =
    "usage: handrail-storm [--sequences N] [--seed S] [--results FILE] [--keep FOLDER]\n"
    "\n"
    "Starts rig, slave and master, drives at speed, pauses, cuts off, ends and restarts them at\n"
    "random, follows `handrail why` out of it and drives again. In every sequence the arm keeps "
    "its\n"
    "limits at the controller's clock, stands after a stop until reset and engage, and follows "
    "again\n"
    "in the end. One line a sequence; exit code 1 when anything was violated.\n"
    "\n"
    "  --sequences N    seeds S to S+N-1 (50)\n"
    "  --seed S         of the first; drawn and printed when absent\n"
    "  --results FILE   a line a sequence; those in it are not run again\n"
    "  --keep FOLDER    of each violated sequence: taps, outputs, story and traces\n";

struct Arguments {
  std::uint64_t sequences = 50, seed = 0;
  std::string results, keep;
};

int complain(const std::string& text) {
  std::fprintf(stderr, "handrail-storm: %s\n", text.c_str());
  return kBadInput;
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
    if (i + 1 == argc) return complain("'" + name + "': unknown, or its value is missing");
    const std::string value = argv[++i];
    if (name == "--sequences") {
      if (!read_number(value, 1, out.sequences)) {
        return complain("--sequences '" + value + "': expected a number from 1 on");
      }
    } else if (name == "--seed") {
      seeded = read_number(value, 0, out.seed);
      if (!seeded) return complain("--seed '" + value + "': expected a number from 0 on");
    } else if (name == "--results") {
      out.results = value;
    } else if (name == "--keep") {
      out.keep = value;
    } else {
      return complain("'" + name + "': unknown; expected --sequences, --seed, --results or --keep");
    }
  }
  // Small enough to be typed.
  if (!seeded) out.seed = std::random_device()() % 1'000'000;
  return 0;
}

void keep(const std::string& folder, const Sequence& sequence, const Outcome& outcome,
          const Run& run) {
  using namespace handrail;
  const std::filesystem::path to = std::filesystem::path(folder) / std::to_string(sequence.seed);
  std::error_code error;
  std::filesystem::create_directories(to, error);
  for (const auto& entry : std::filesystem::directory_iterator(run.cell().folder().path(), error)) {
    if (!entry.is_regular_file()) continue;
    std::filesystem::copy_file(entry.path(), to / entry.path().filename(),
                               std::filesystem::copy_options::overwrite_existing, error);
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

void print(const handrail::storm::Line& r) {
  const Figures& f = r.figures;
  fmt::print(
      "{}: {} in {:.1f} s; step {:.2f}, acceleration {:.2f}, jerk {:.2f} of the limits; {} cycles "
      "held, {} halts up to {:.1f}; {}{}{}\n",
      r.seed, r.ok ? "ok" : "VIOLATED", r.seconds, f.step, f.acceleration, f.jerk, f.held, f.halts,
      f.hardest_halt, r.done, r.ok ? "" : "\n    ", r.violated);
  std::fflush(stdout);
}

}  // namespace

int main(int argc, char** argv) {
  for (int i = 1; i < argc; ++i) {
    if (std::string(argv[i]) != "--help" && std::string(argv[i]) != "-h") continue;
    std::fputs(kUsage, stdout);
    return 0;
  }
  Arguments arguments;
  if (const int code = read_arguments(argc, argv, arguments); code != 0) return code;
  Results results;
  if (const auto opened = results.open(arguments.results); !opened) {
    return complain(opened.message());
  }
  // Taps and sockets lie in memory where there is such a folder: no disk holds a control thread.
  if (std::filesystem::is_directory("/dev/shm")) ::setenv("TMPDIR", "/dev/shm", 0);
  handrail::catch_interrupts();
  fmt::print("storm: {} sequences from seed {}\n", arguments.sequences, arguments.seed);
  std::uint64_t ran = 0, violated = 0;
  Figures all;
  for (std::uint64_t i = 0; i < arguments.sequences && !handrail::interrupted(); ++i) {
    const std::uint64_t seed = arguments.seed + i;
    if (!results.has(seed)) {
      const Sequence sequence = handrail::storm::draw(seed);
      Run run(sequence, handrail::interrupted);
      const Outcome outcome = run.go();
      if (!outcome.complete) break;
      if (!outcome.violations.empty() && !arguments.keep.empty()) {
        keep(arguments.keep, sequence, outcome, run);
      }
      if (const auto added = results.add(line_of(sequence, outcome)); !added) {
        return complain(added.message());
      }
    }
    const auto& result = results.of(seed);
    print(result);
    ++ran;
    violated += result.ok ? 0 : 1;
    all.add(result.figures);
  }
  fmt::print(
      "storm: {} of {} sequences violated; of {} targets {} beyond a limit, up to {:.2f} of a "
      "step, "
      "{:.2f} of acceleration, {:.2f} of jerk; {} cycles held in motion, {} halts up to {:.1f} of "
      "acceleration\n",
      violated, ran, all.targets, all.breaches, all.step, all.acceleration, all.jerk, all.held,
      all.halts, all.hardest_halt);
  if (violated == 0 && ran > 0) {
    // Rule of three.
    fmt::print("storm: with 95 % confidence fewer than {:.1f} % of such sequences are\n",
               std::min(100.0, 300.0 / static_cast<double>(ran)));
  }
  if (handrail::interrupted()) return kInterrupted;
  return violated == 0 ? 0 : kViolated;
}
