// handrail-links: which links can be driven, by the real daemons over the encrypted link.
#include <spdlog/fmt/fmt.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <string>
#include <vector>

#include "client/cli/interrupt.h"
#include "server/base/version.h"
#include "server/lab/console/console.h"
#include "tests/links/cell.h"
#include "tests/links/results.h"

namespace {

using handrail::LinkCase;
using handrail::LinkCell;
using handrail::LinkFigures;
using handrail::LinkMapOptions;
using handrail::Result;
using handrail::Status;
using handrail::links::Motion;
using handrail::links::RunPlan;

struct Arguments {
  LinkMapOptions table;
  RunPlan plan;
  std::uint64_t seed = 1;
  std::string results = "build/links", commit = "unknown";
  bool coarse = false, json = false;
};

int complain(const std::string& text, int code) {
  std::fprintf(stderr, "handrail-links: %s\n", text.c_str());
  return code;
}

double load_now() {
  double load = 0.0;
  return ::getloadavg(&load, 1) == 1 ? load : -1.0;
}

// The hand's motion first, then strokes, where it can be engaged.
Result<LinkFigures> measure_both(const Arguments& arguments, const LinkCase& link,
                                 const std::string& folder) {
  RunPlan plan = arguments.plan;
  auto figures = handrail::links::measure(plan, link, folder);
  if (!figures || !figures->engaged) return figures;
  plan.motion = Motion::kStrokes;
  plan.engage_s = std::min(plan.engage_s, figures->after + 2.0);  // strokes wait for its end
  auto strokes = handrail::links::measure(plan, link, folder);
  if (!strokes) return strokes;
  figures->speed = strokes->speed;
  figures->violations += strokes->violations;
  return figures;
}

int run(const Arguments& arguments) {
  handrail::catch_interrupts();
  const handrail::links::Results results(
      arguments.results, {arguments.commit, arguments.plan.drive_s, arguments.plan.strokes});
  const std::string folder = std::filesystem::absolute(arguments.results).string() + "/run";
  const std::vector<LinkCase> cases = handrail::link_cases(arguments.table);
  std::vector<LinkCell> cells;
  std::uint64_t violations = 0;
  for (LinkCase link : cases) {
    link.seed = arguments.seed;
    auto figures = results.find(link);
    if (!figures) {
      std::fprintf(stderr, "handrail-links: %zu of %zu: %g +- %g ms, %g %%, load %.1f\n",
                   cells.size() + 1, cases.size(), link.delay_ms, link.jitter_ms, 100.0 * link.loss,
                   load_now());
      const auto measured = measure_both(arguments, link, folder);
      if (handrail::interrupted()) {
        return complain("stopped; the same command goes on from here", handrail::kCancelled);
      }
      if (!measured) return complain(measured.message(), handrail::kFailed);
      figures = *measured;
      if (const Status kept = results.add(link, *figures, load_now()); !kept) {
        return complain(kept.message(), handrail::kFailed);
      }
    }
    violations += figures->violations;
    cells.push_back({link, *figures, 1, figures->engaged ? 1 : 0});
  }
  std::fputs(
      (arguments.json ? handrail::link_json(cells) : handrail::link_table(arguments.table, cells))
          .c_str(),
      stdout);
  if (violations == 0) return handrail::kDone;
  return complain(fmt::format("the arm broke its limits {} times", violations), handrail::kFailed);
}

// As many cells, and as long, as fit into some five minutes.
void make_coarse(Arguments& out) {
  if (out.table.delays_ms.empty()) out.table.delays_ms = {0, 50, 200};
  if (out.table.jitters_ms.empty()) out.table.jitters_ms = {0, 50};
  if (out.table.losses.empty()) out.table.losses = {0, 10};
  out.plan.drive_s = 6.0;
  out.plan.strokes = 2;
}

// Of a side, by ourselves: its program, the folder, and what else it needs.
int run_side(const std::vector<std::string>& words) {
  if (words[0] == "--far") return handrail::links::run_far(words.at(1));
  RunPlan plan;
  plan.motion = words.at(2) == "sines" ? Motion::kSines : Motion::kStrokes;
  plan.engage_s = std::atof(words.at(3).c_str());
  plan.drive_s = std::atof(words.at(4).c_str());
  return handrail::links::run_near(plan, words.at(1));
}

}  // namespace

int main(int argc, char** argv) {
  if (handrail::says_version("handrail-links", argc, argv)) return 0;
  const std::vector<std::string> words(argv + 1, argv + argc);
  if (!words.empty() && (words[0] == "--near" || words[0] == "--far")) return run_side(words);

  Arguments arguments;
  LinkMapOptions& table = arguments.table;
  const LinkMapOptions full = table;
  table.delays_ms.clear();
  table.jitters_ms.clear();
  table.losses.clear();
  CLI::App app(
      "Puts real daemons, encrypted, over links of every delay, jitter and loss, and prints what\n"
      "`handrail-lab links` prints of virtual time: engaged after, the tip's speed, holds a "
      "minute.\n"
      "Some 80 s a cell. Each cell is kept in a file; the same command goes on where it was "
      "stopped.\n"
      "Exit codes: 0 done, 1 it failed or the arm broke its limits, 2 usage, 130 stopped.",
      "handrail-links");
  app.add_option("--delay", table.delays_ms, "one way [ms]")
      ->delimiter(',')
      ->check(CLI::Range(0.0, 1000.0));
  app.add_option("--jitter", table.jitters_ms, "+-, at most the delay [ms]")
      ->delimiter(',')
      ->check(CLI::Range(0.0, 1000.0));
  app.add_option("--loss", table.losses, "[%]")->delimiter(',')->check(CLI::Range(0.0, 100.0));
  app.add_flag("--in-order", table.in_order, "a queue keeps the order");
  app.add_flag("--coarse", arguments.coarse, "fewer cells and shorter drives: about four minutes");
  app.add_option("--seconds", arguments.plan.drive_s, "of the hand's motion in a cell (60)")
      ->check(CLI::Range(1.0, 3600.0));
  app.add_option("--strokes", arguments.plan.strokes, "in a cell (8)")->check(CLI::Range(1, 100));
  app.add_option("--seed", arguments.seed, "of network and hand (1)");
  app.add_option("--results", arguments.results, "folder of the cells' files (build/links)");
  app.add_option("--commit", arguments.commit, "of this build; cells of another are not used");
  app.add_flag("--json", arguments.json, "one object, for programs");
  try {
    app.parse(argc, argv);
  } catch (const CLI::Success& asked) {
    return app.exit(asked);
  } catch (const CLI::ParseError& wrong) {
    return complain(std::string(wrong.what()) + " (see handrail-links --help)", handrail::kUsage);
  }
  if (arguments.coarse) make_coarse(arguments);
  if (table.delays_ms.empty()) table.delays_ms = full.delays_ms;
  if (table.jitters_ms.empty()) table.jitters_ms = full.jitters_ms;
  if (table.losses.empty()) {
    table.losses = full.losses;
  } else {
    for (double& loss : table.losses) loss /= 100.0;
  }
  return run(arguments);
}
