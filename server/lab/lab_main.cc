// handrail-lab: experiments in virtual time, with the daemons' own steps.
#include <CLI/CLI.hpp>
#include <algorithm>
#include <atomic>
#include <cmath>
#include <cstdio>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "server/base/output.h"
#include "server/base/plain_text.h"
#include "server/lab/accuracy/command.h"
#include "server/lab/contact/bumper_command.h"
#include "server/lab/ctrl_c.h"
#include "server/lab/delay/delay_command.h"
#include "server/lab/faults/fault_command.h"
#include "server/lab/hand/hand_command.h"
#include "server/lab/links/link_command.h"
#include "server/lab/scenes/price_command.h"
#include "server/lab/study/linear/linear_command.h"
#include "server/lab/study/screw/screw_command.h"
#include "server/lab/walls/wall_command.h"

namespace handrail {
namespace {

// Numbers only: CLI11's range lets `nan` through.
const CLI::Validator kFinite(
    [](std::string& text) {
      double value = 0.0;
      const bool number = CLI::detail::lexical_cast(text, value);
      return number && std::isfinite(value) ? std::string() : text + " is no finite number";
    },
    "");

const CLI::Validator kPngFile(
    [](std::string& text) {
      return text.ends_with(".png") ? std::string()
                                    : text + " is no name of a PNG file, as map.png";
    },
    "");

const std::atomic<bool>& cancelled = ctrl_c();

void add_hand(CLI::App& app, HandCommand& hand) {
  CLI::App* sub = app.add_subcommand("hand", "drive the simulated arm by a recorded hand");
  sub->add_option("FILE", hand.file, "CSV: t_s,x_mm,y_mm[,z_mm]")->required();
  sub->add_option("--tool", hand.tool, "tool to hold on to")
      ->check(CLI::IsMember(hand_tools()))
      ->capture_default_str();
  sub->add_option("--scene", hand.scene, "scene to run in")->capture_default_str();
  sub->add_flag("--one-way", hand.one_way, "forward along device +X only");
  sub->add_flag("--json", hand.json, "print the result as JSON");
}

void add_operators(CLI::App& sub, int& operators, const char* what) {
  sub.add_option("--operators", operators, what)
      ->check(CLI::Range(1, 100000))
      ->capture_default_str();
}

void add_threads(CLI::App& sub, int& threads,
                 const char* what = "0: one a core; results do not depend on it") {
  sub.add_option("--threads", threads, what)->check(CLI::Range(0, 1024))->capture_default_str();
}

// The words of studies and fits.
struct StudyWords {
  LinearCommand linear;
  ScrewCommand screw;
  FitCommand linear_fit{"linear-movement"};
  FitCommand screw_fit{"screw-fastening"};
};

constexpr const char* kVary = "Vary one thing, printed beside the study as it is";

const std::map<std::string, BumperSettings::Form> kForms = {
    {"published", BumperSettings::Form::kPublished}, {"default", BumperSettings::Form::kDefault}};

// What all studies have in common. `block`: of the scene, that the study needs.
void add_study(CLI::App& sub, StudyCommand& study, const std::string& block) {
  add_operators(sub, study.operators, "how many");
  sub.add_option("--trials", study.trials, "successful trials of each in each mode")
      ->check(CLI::Range(1, 100))
      ->capture_default_str();
  sub.add_option("--seed", study.seed, "another seed, other people")->capture_default_str();
  add_threads(sub, study.threads);
  sub.add_option("--scene", study.scene, "scene, with a " + block)->capture_default_str();
  sub.add_option("--population", study.population, "name or file of the operators' population")
      ->capture_default_str();
  sub.add_flag("--json", study.json, "print everything, every trial too, as JSON");
  sub.add_option("--figures", study.figures, "folder for the figures (SVG)");
  sub.add_option("--set", study.settings,
                 "KEY=VALUE: a scene's field, rig.FIELD, operator.PARAMETER, haptic.rate_hz, "
                 "link.delay_ms; all --set together are one variation")
      ->allow_extra_args(false)
      ->group(kVary);
  sub.add_option("--sweep", study.sweeps, "KEY=VALUE,VALUE,...: a variation for each value")
      ->allow_extra_args(false)
      ->group(kVary);
}

void add_linear(CLI::App& app, StudyWords& words) {
  CLI::App* sub = app.add_subcommand(
      "linear-movement", "simulated operators from A to B to C, without tools (NV) and with (V)");
  add_study(*sub, words.linear, "task");
  sub->add_option("--smoother", words.linear.smoother, "published, low-lag, or a number of samples")
      ->group(kVary);
  sub->add_option("--rate", words.linear.rate, "of the haptic loop [Hz]")->group(kVary);
  sub->add_option("--tool-method", words.linear.tool_method, "exact or published (Algorithm 2)")
      ->check(CLI::IsMember({"exact", "published"}))
      ->group(kVary);
}

void add_screw(CLI::App& app, StudyWords& words) {
  CLI::App* sub = app.add_subcommand(
      "screw-fastening",
      "simulated operators tighten a screw, without contact protection (NC) and with (C), without "
      "tools (NV) and with (V)");
  add_study(*sub, words.screw, "screw");
  const auto choose = [&words](const std::string& form) { words.screw.bumper = kForms.at(form); };
  sub->add_option_function<std::string>("--bumper", choose, "of the modes with protection")
      ->check(CLI::IsMember({"published", "default"}))
      ->default_str("default");
}

void add_fit(CLI::App& fits, FitCommand& fit, const char* name, const std::string& mode,
             const std::string& block) {
  CLI::App* sub = fits.add_subcommand(name, "to mode " + mode);
  add_operators(*sub, fit.operators, "how many");
  sub->add_option("--evaluations", fit.evaluations, "candidates to try, at most")
      ->check(CLI::Range(1, 100000))
      ->capture_default_str();
  sub->add_option("--seed", fit.seed, "other people than a study's")->capture_default_str();
  add_threads(*sub, fit.threads, "0: one a core; the fit does not depend on it");
  sub->add_option("--scene", fit.scene, "scene, with a " + block)->capture_default_str();
  sub->add_option("--population", fit.population, "name or file to start from")
      ->capture_default_str();
  sub->add_option("--out", fit.out, "file to write; without it the population's own");
  sub->add_flag("--check", fit.check,
                "write nothing; exit 1 if the file is not what the fit gives");
}

void add_studies(CLI::App& app, StudyWords& words) {
  add_linear(app, words);
  add_screw(app, words);
  CLI::App* fits = app.add_subcommand(
      "fit",
      "fit a population's free parameters to the dissertation's medians without tools and "
      "protection");
  fits->require_subcommand(1);
  add_fit(*fits, words.linear_fit, "linear-movement", "NV of the linear movement", "task");
  add_fit(*fits, words.screw_fit, "screw-fastening", "NC-NV of screw fastening", "screw");
}

// The exit code of the study or the fit that was asked for; nothing if none was.
std::optional<int> run_studies(const CLI::App& app, const StudyWords& words) {
  if (app.got_subcommand("linear-movement")) return run_linear_command(words.linear, cancelled);
  if (app.got_subcommand("screw-fastening")) return run_screw_command(words.screw, cancelled);
  if (!app.got_subcommand("fit")) return std::nullopt;
  return app.get_subcommand("fit")->got_subcommand("linear-movement")
             ? run_linear_fit(words.linear_fit, cancelled)
             : run_screw_fit(words.screw_fit, cancelled);
}

void add_accuracy(CLI::App& app, AccuracyCommand& accuracy) {
  CLI::App* sub = app.add_subcommand(
      "accuracy", "what accuracy costs in time, choice by choice, measured on this machine");
  sub->add_option("--only", accuracy.only, "one choice")->check(CLI::IsMember(accuracy_choices()));
  sub->add_flag("--json", accuracy.json, "print the rows as JSON");
  sub->add_option("--figures", accuracy.figures, "folder for the figures (SVG)");
}

// What `handrail scene` starts.
void add_scene_tools(CLI::App& app, SceneToolCommand& tool) {
  CLI::App* explain = app.add_subcommand(
      "scene-explain", "what a scene simulates, where, and what it costs; what it does not");
  explain->add_option("SCENE", tool.scene, "name, or a file")->required();
  explain->add_flag("--json", tool.json, "print it as JSON");
  CLI::App* stability = app.add_subcommand(
      "scene-stability", "what of a scene's walls, tools and springs a device can hold");
  stability->add_option("SCENE", tool.scene, "name, or a file")->required();
  stability->add_flag("--json", tool.json, "print it as JSON");
  CLI::App* preview =
      app.add_subcommand("scene-preview", "draw a scene's walls, forces and a proxy's way");
  preview->add_option("SCENE", tool.scene, "name, or a file")->required();
  preview->add_option("--out", tool.out, "PNG file to write")->required()->check(kPngFile);
  CLI::App* resolve = app.add_subcommand(
      "scene-resolve", "copy a scene with the cheapest setting that meets a wish");
  resolve->add_option("SCENE", tool.scene, "name, or a file")->required();
  resolve->add_option("--accuracy", tool.accuracy, "largest error, such as 0.01mm or 10um");
  resolve->add_option("--budget", tool.budget, "largest cost of an update, such as 500ns");
  resolve->add_option("--out", tool.out, "scene file to write, NAME.scene")->required();
}

void add_effects(CLI::App& app, SceneToolCommand& tool) {
  CLI::App* sub = app.add_subcommand(
      "effects", "leave each effect of a scene's rig out in turn: what changes, what it costs");
  sub->add_option("SCENE", tool.scene, "name, or a file")->required();
  sub->add_flag("--json", tool.json, "print it as JSON");
}

// What wrench and gearshift have in common.
void add_walls(CLI::App& sub, WallCommand& command) {
  add_operators(sub, command.operators, "how many; the first is the typical one");
  sub.add_option("--seed", command.seed, "another seed, other people")->capture_default_str();
  add_threads(sub, command.threads);
  sub.add_option("--scene", command.scene, "scene, drawn alike")->capture_default_str();
  sub.add_flag("--json", command.json, "print the result as JSON");
  sub.add_option("--figures", command.figures, "folder for the figures (SVG)");
  sub.add_option("--traces", command.traces, "CSV file for every tick of the first operator");
  sub.add_option("--hand", command.hand, "CSV of a recorded hand, t_s,x_mm,y_mm, to play instead");
}

void add_wrench(CLI::App& app, WrenchCommand& wrench) {
  CLI::App* sub = app.add_subcommand(
      "wrench", "tighten and loosen a screw by half turns, led by a guiding ball");
  sub->add_option("--c", wrench.c, "of B_w = c alpha [N s/(m rad)]; without it the scene's")
      ->check(kFinite)
      ->check(CLI::Range(0.0, 1e6));
  sub->add_option("--turns", wrench.turns, "half turns to tighten")
      ->check(CLI::Range(1, 1000))
      ->capture_default_str();
  sub->add_option("--loosen", wrench.loosen, "half turns to loosen afterwards")
      ->check(CLI::Range(0, 1000))
      ->capture_default_str();
  add_walls(*sub, wrench);
}

void add_gearshift(CLI::App& app, GearshiftCommand& gearshift) {
  add_walls(*app.add_subcommand("gearshift", "shift from neutral through all gears and back"),
            gearshift);
}

void add_price_check(CLI::App& app, PriceCommand& prices) {
  CLI::App* sub = app.add_subcommand(
      "price-check", "whether leaving an effect out of a scene saves the price it is listed at");
  sub->add_option("SCENE", prices.scene, "scene of walls")->required();
}

void add_faults(CLI::App& app, FaultCommand& faults) {
  CLI::App* sub = app.add_subcommand(
      "faults",
      "put faults into network, programs and devices; an auditor judges what the arm does");
  sub->add_option("--row", faults.row, "one row of the matrix, such as N2");
  sub->add_option("--seed,--seeds", faults.seeds,
                  "other networks, hands and moments; one, several as 1..50, or 1..50,2024")
      ->capture_default_str();
  auto* quick = sub->add_flag("--quick", faults.quick, "every row, fewer and shorter runs");
  auto* results = sub->add_option(
      "--results", faults.results,
      "file to add finished runs to; those it has are not run again, by the same program");
  auto* out = sub->add_option("--out", faults.out, "text file for the table");
  add_threads(*sub, faults.threads);
  sub->add_flag("--json", faults.json, "print the rows as JSON");
  auto* without = sub->add_option("--delete", faults.without,
                                  "leave a check out, such as jerk; needs the build 'deletable'")
                      ->excludes(results);
  sub->add_flag("--prove", faults.prove,
                "leave every check out in turn: 1 if a row does not turn red; same build")
      ->excludes(without)
      ->excludes(quick)
      ->excludes(results)
      ->excludes(out);
}

void add_bumper(CLI::App& app, BumperCommand& bumper) {
  CLI::App* sub = app.add_subcommand(
      "bumper", "push into surfaces of every stiffness with the published bumper and the default");
  sub->add_option("--arm", bumper.arm, "rigid, or the rig's with its servo lag; else both")
      ->check(CLI::IsMember({"rigid", "rig"}));
  sub->add_option("--form", bumper.form, "published or default; else both")
      ->check(CLI::IsMember({"published", "default"}));
  sub->add_option("--noise", bumper.noise, "of the sensor, standard deviation [N]")
      ->check(kFinite)
      ->check(CLI::Range(0.0, 9.0));
  add_threads(*sub, bumper.threads);
  sub->add_flag("--json", bumper.json, "print every cell as JSON");
  sub->add_option("--figures", bumper.figures, "folder for the figure (SVG)");
}

void add_delay(CLI::App& app, DelayCommand& delay) {
  CLI::App* sub = app.add_subcommand(
      "contact-delay", "touch surfaces over delay, felt through the spring and by a local model");
  sub->add_flag("--quick", delay.quick, "round trips of 0, 200 and 1000 ms alone");
  add_threads(*sub, delay.threads);
  sub->add_flag("--json", delay.json, "print a line of JSON for each cell");
}

void add_links(CLI::App& app, LinkCommand& links) {
  CLI::App* sub = app.add_subcommand(
      "links", "over which links one can engage and drive: delay, jitter and loss each way");
  const auto list = [sub](const char* name, std::vector<double>& to, double most, const char* of) {
    sub->add_option(name, to, of)->delimiter(',')->check(kFinite)->check(CLI::Range(0.0, most));
  };
  list("--delay", links.delays_ms, 1000.0, "one way [ms], such as 0,50,200,500");
  list("--jitter", links.jitters_ms, 1000.0, "uniform within +- [ms], at most the delay");
  list("--loss", links.losses, 100.0, "each datagram by itself [%], such as 0,10,20,40");
  sub->add_flag("--in-order", links.in_order, "a queue keeps the order; else they overtake");
  sub->add_option("--seeds", links.seeds, "networks and hands of each link")
      ->check(CLI::Range(1, 1000))
      ->capture_default_str();
  add_threads(*sub, links.threads);
  sub->add_flag("--json", links.json, "print every figure as JSON");
}

// Names the first of `words` that is no command of `app`, or of the command before it, and the
// nearest that is one, or all; also all where one is missing. Empty when nothing is wrong.
std::string unknown_command(const CLI::App& app, std::span<char* const> words) {
  const auto subs = app.get_subcommands([](const CLI::App*) { return true; });
  if (subs.empty() || (!words.empty() && words[0][0] == '-')) return {};
  const std::string word = words.empty() ? "" : words[0];
  std::vector<std::string> names;
  std::string known;
  for (const CLI::App* sub : subs) {
    if (sub->get_name() == word) return unknown_command(*sub, words.subspan(1));
    names.push_back(sub->get_name());
    known += (known.empty() ? "" : ", ") + sub->get_name();
  }
  if (words.empty()) return "expected a command: " + known + " (see handrail-lab --help)";
  const std::string nearest = nearest_name(word, names);
  return "no command '" + word + "'" +
         (nearest.empty() ? "; there are " + known : "; did you mean '" + nearest + "'?");
}

int run(int argc, char** argv) {
  CLI::App app{
      "Experiments in virtual time: the same master and slave steps as the daemons, "
      "without sockets or sleeping, bit-identical for the same input."};
  app.set_version_flag("--version", "handrail-lab " HANDRAIL_VERSION);
  app.require_subcommand(1);
  HandCommand hand;
  StudyWords studies;
  AccuracyCommand accuracy;
  SceneToolCommand tool;
  add_hand(app, hand);
  add_studies(app, studies);
  add_accuracy(app, accuracy);
  add_scene_tools(app, tool);
  add_effects(app, tool);
  WrenchCommand wrench;
  GearshiftCommand gearshift;
  add_wrench(app, wrench);
  add_gearshift(app, gearshift);
  FaultCommand faults;
  add_faults(app, faults);
  BumperCommand bumper;
  add_bumper(app, bumper);
  DelayCommand delay;
  add_delay(app, delay);
  LinkCommand links;
  add_links(app, links);
  PriceCommand prices;
  add_price_check(app, prices);
  const std::span<char* const> words(argv + 1, static_cast<std::size_t>(std::max(argc - 1, 0)));
  if (const std::string unknown = unknown_command(app, words); !unknown.empty()) {
    std::fprintf(stderr, "handrail-lab: %s\n", unknown.c_str());
    return 2;
  }
  try {
    app.parse(argc, argv);
  } catch (const CLI::Success& help) {
    return app.exit(help);
  } catch (const CLI::ParseError& error) {
    std::string command;
    for (const CLI::App* sub : app.get_subcommands()) command += " " + sub->get_name();
    std::fprintf(stderr, "handrail-lab: %s (see handrail-lab%s --help)\n", error.what(),
                 command.c_str());
    return 2;
  }
  if (app.got_subcommand("hand")) return run_hand_command(hand);
  let_ctrl_c_cancel();
  if (app.got_subcommand("accuracy")) return run_accuracy_command(accuracy, cancelled);
  if (app.got_subcommand("scene-explain")) return run_explain_command(tool, cancelled);
  if (app.got_subcommand("scene-stability")) return run_stability_check(tool);
  if (app.got_subcommand("effects")) return run_effects_command(tool, cancelled);
  if (app.got_subcommand("scene-preview")) return run_preview_command(tool);
  if (app.got_subcommand("scene-resolve")) return run_resolve_command(tool, cancelled);
  if (app.got_subcommand("wrench")) return run_wrench_command(wrench, cancelled);
  if (app.got_subcommand("gearshift")) return run_gearshift_command(gearshift, cancelled);
  if (app.got_subcommand("price-check")) return run_price_command(prices, cancelled);
  if (app.got_subcommand("bumper")) return run_bumper_command(bumper, cancelled);
  if (app.got_subcommand("contact-delay")) return run_delay_command(delay, cancelled);
  if (app.got_subcommand("links")) return run_link_command(links, cancelled);
  if (const auto code = run_studies(app, studies)) return *code;
  return run_fault_command(faults, cancelled);
}

}  // namespace
}  // namespace handrail

int main(int argc, char** argv) {
  return handrail::end_output("handrail-lab", handrail::run(argc, argv));
}
