// handrail-desk: the drivers of haptic devices against what stands in for their hardware.
#include <spdlog/fmt/fmt.h>

#include <CLI/CLI.hpp>
#include <cstdio>
#include <string>
#include <vector>

#include "client/cli/interrupt.h"
#include "server/base/version.h"
#include "server/lab/console/console.h"
#include "tests/desk/loop_trial.h"
#include "tests/desk/results.h"
#include "tests/desk/seats.h"
#include "tests/desk/spacenavd_soak.h"

namespace {

using namespace handrail::desk;

struct DeskArguments {
  SoakPlan soak;
  LoopPlan loop;
  bool json = false;
};

constexpr int kNotHere = 77;  // as tests say that something is not installed

int complain(const std::string& text, int code) {
  std::fprintf(stderr, "handrail-desk: %s\n", text.c_str());
  return code;
}

int run_soak(const DeskArguments& arguments) {
  const auto figures = soak(arguments.soak, handrail::interrupted);
  if (!figures) {
    const bool missing = figures.message().find("not installed") != std::string::npos;
    return complain(figures.message(), missing ? kNotHere : handrail::kFailed);
  }
  const std::string text =
      arguments.json ? soak_json(arguments.soak, *figures) : soak_text(arguments.soak, *figures);
  std::fputs(text.c_str(), stdout);
  if (handrail::interrupted()) return handrail::kCancelled;
  return whole(*figures) ? handrail::kDone : handrail::kFailed;
}

int run_loops(const DeskArguments& arguments) {
  const auto series = try_loops(arguments.loop, [](const std::string& next) {
    std::fprintf(stderr, "handrail-desk: %s\n", next.c_str());
    return !handrail::interrupted();
  });
  if (handrail::interrupted()) return complain("stopped", handrail::kCancelled);
  if (!series) return complain(series.message(), handrail::kFailed);
  std::fputs((arguments.json ? loop_json(*series) : loop_table(*series)).c_str(), stdout);
  return within_growth(*series) ? handrail::kDone : handrail::kFailed;
}

void add_options(CLI::App& app, CLI::App*& soaks, CLI::App*& loops, DeskArguments& out) {
  app.require_subcommand(1);
  soaks = app.add_subcommand("spacenavd", "Debian's spacenavd, each frame of it counted");
  soaks->add_option("--seconds", out.soak.seconds, "(600)")->check(CLI::Range(1.0, 86400.0));
  soaks->add_option("--rate", out.soak.rate, "frames a second (1000)")
      ->check(CLI::Range(1.0, 4000.0));
  loops = app.add_subcommand("loop", "the master's loop with each driver, in turn");
  std::vector<std::string> names;
  for (const SeatRow& row : seat_rows()) names.emplace_back(row.name);
  loops->add_option("--devices", out.loop.devices, "beside sim-omni (all)")
      ->delimiter(',')
      ->check(CLI::IsMember(names));
  loops->add_option("--rounds", out.loop.rounds, "(10)")->check(CLI::Range(1, 1000));
  loops->add_option("--seconds", out.loop.seconds, "of a device in a round (3)")
      ->check(CLI::Range(0.1, 600.0));
  for (CLI::App* const command : {soaks, loops}) {
    command->add_flag("--json", out.json, "one object, for programs");
  }
}

}  // namespace

int main(int argc, char** argv) {
  if (handrail::says_version("handrail-desk", argc, argv)) return 0;
  DeskArguments arguments;
  CLI::App app(
      "The drivers of haptic devices against what stands in for their hardware.\n"
      "Exit codes: 0 as it should be, 1 not, 2 usage, 77 something is not installed here, "
      "130 stopped.",
      "handrail-desk");
  CLI::App *soaks = nullptr, *loops = nullptr;
  add_options(app, soaks, loops, arguments);
  try {
    app.parse(argc, argv);
  } catch (const CLI::Success& asked) {
    return app.exit(asked);
  } catch (const CLI::ParseError& wrong) {
    return complain(std::string(wrong.what()) + " (see handrail-desk --help)", handrail::kUsage);
  }
  handrail::catch_interrupts();
  return soaks->parsed() ? run_soak(arguments) : run_loops(arguments);
}
