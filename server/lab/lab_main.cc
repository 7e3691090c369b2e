// handrail-lab: experiments in virtual time, with the daemons' own steps.
#include <algorithm>
#include <atomic>
#include <charconv>
#include <cmath>
#include <cstdio>
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
#include "server/lab/replay/replay_command.h"
#include "server/lab/scenes/price_command.h"
#include "server/lab/sequences/sequence_command.h"
#include "server/lab/stability/stability_command.h"
#include "server/lab/study_words.h"
#include "server/lab/unknown_command.h"
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

const CLI::Validator kNotEmpty(
    [](const std::string& text) { return text.empty() ? "expected something" : std::string(); },
    "");
// CLI11 wraps a negative number around, takes one that is too large for the largest, nothing for 0,
// and 010 for 8.
const CLI::Validator kSeed(
    [](std::string& text) {
      std::uint64_t seed = 0;
      std::from_chars(text.data(), text.data() + text.size(), seed);
      return text == std::to_string(seed)
                 ? std::string()
                 : "'" + shown(text) + "': expected a whole number from 0 to " +
                       std::to_string(~std::uint64_t{0});
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

void add_replay(CLI::App& app, ReplayCommand& replay) {
  CLI::App* sub = app.add_subcommand(
      "replay", "do again what a recording holds: the same inputs through the same steps");
  sub->add_option("FILE", replay.file, "recording, .mcap")->required();
  sub->add_option("--link", replay.link,
                  "another network under the same hand: delay=MS,jitter=MS,loss=PERCENT")
      ->check(kNotEmpty);
  sub->add_option("--tool", replay.tool, "a tool of the scene in place of each of its sort");
  sub->add_option("--scene", replay.scene, "another scene in place of all");
  sub->add_option("--set", replay.set,
                  "KEY=VALUE of the scenes, such as guidance.stiffness_n_mm=1");
  sub->add_flag("--other-processor", replay.other_processor,
                "recorded on another kind of processor: compare within 1e-9");
  sub->add_flag("--no-images", replay.no_images,
                "for a file of a stranger: begin only where its program began");
  sub->add_flag("--json", replay.json, "print the result as JSON");
}

void add_recordings(CLI::App& app, JoinCommand& join, RecordingCsvCommand& csv) {
  CLI::App* both = app.add_subcommand(
      "recording-join", "how far the clocks of a master's and a slave's recording are apart");
  both->add_option("FIRST", join.first, "recording of one side")->required();
  both->add_option("SECOND", join.second, "recording of the other side")->required();
  both->add_option("--out", join.out, "write both as one file, .mcap");
  both->add_flag("--json", join.json, "print the result as JSON");
  CLI::App* table = app.add_subcommand("recording-csv", "a recording as a table");
  table->add_option("FILE", csv.file, "recording, .mcap")->required();
  table->add_option("--out", csv.out, "CSV file to write")->required();
  table->add_option("--trial", csv.trial, "that trial of the recorded experiment alone")
      ->check(CLI::Range(1, 1000000));
  table->add_option("--hz", csv.hz, "at most so many rows a second; without it every tick")
      ->check(kFinite)
      ->check(CLI::Range(0.1, 1000.0));
  table->add_flag("--packets", csv.packets, "every datagram as it came or went, a row each")
      ->excludes("--trial", "--hz");
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
  sub.add_option("--walls", command.walls, "felt as drawn, or painted first and felt so")
      ->check(CLI::IsMember({"exact", "subpixel", "published"}))
      ->capture_default_str();
  sub.add_option("--pixel", command.pixel, "of a painted map [mm]")
      ->check(kFinite)
      ->check(CLI::Range(0.02, 1.0))
      ->capture_default_str();
  sub.add_flag("--published-damper", command.published_damper,
               "the walls' damper as (2.1) has it, to the letter");
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
  auto* replay = sub->add_flag("--replay", faults.replay,
                               "record every run as the daemons would, and do it again: what "
                               "differs is a violation");
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
      ->excludes(replay)
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
  sub->add_flag("--quick", delay.quick, "0, 200 and 1000 ms, and the worst link of all");
  sub->add_option("--seed", delay.seed, "other networks and hands")
      ->check(kSeed)
      ->capture_default_str();
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

void add_stability(CLI::App& app, StabilityCommand& stability) {
  CLI::App* sub = app.add_subcommand(
      "stability",
      "whether it is stable: theory, walls, effects; both sides across the link; the arm; a day");
  sub->add_flag("--quick", stability.quick, "one seed of each case, without the long ones");
  sub->add_option("--case", stability.only, "a case of --list, or the first parts of its name");
  sub->add_option("--seed", stability.seed, "the first: other kicks and moments")
      ->check(kSeed)
      ->capture_default_str();
  sub->add_option("--seeds", stability.seeds,
                  "of each case; without it 20, or 1 of --case and of the long ones")
      ->check(CLI::Range(1, 100000));
  sub->add_flag("--list", stability.list, "print the cases' names and run none");
  add_threads(*sub, stability.threads);
  sub->add_flag("--json", stability.json, "print a line of JSON a run");
  sub->add_option("--figures", stability.figures, "folder for the figures (SVG); the table of one");
}

void add_sequences(CLI::App& app, SequenceCommand& sequences) {
  CLI::App* sub =
      app.add_subcommand("tool-sequences",
                         "random hands, orders, links and arms: whether the master's step keeps to "
                         "its bounds on force, torque and command");
  sub->add_option("--sequences", sequences.sequences, "how many, of a second each")
      ->check(CLI::Range(std::uint64_t{1}, std::uint64_t{1} << 40))
      ->capture_default_str();
  sub->add_option("--seed", sequences.seed, "of the first; the others follow")
      ->check(kSeed)
      ->capture_default_str();
  sub->add_option("--results", sequences.results, "file that says how far it has come");
  sub->add_flag("--resume", sequences.resume, "go on from that file");
  sub->add_flag("--cases", sequences.cases, "the named cases of tools and turns instead");
  add_threads(*sub, sequences.threads);
  sub->add_flag("--json", sequences.json, "print every figure as JSON");
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
  StabilityCommand stability;
  add_stability(app, stability);
  SequenceCommand sequences;
  add_sequences(app, sequences);
  PriceCommand prices;
  add_price_check(app, prices);
  ReplayCommand recording;
  add_replay(app, recording);
  JoinCommand join;
  RecordingCsvCommand recording_csv;
  add_recordings(app, join, recording_csv);
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
  if (app.got_subcommand("recording-join")) return run_join_command(join);
  if (app.got_subcommand("recording-csv")) return run_recording_csv_command(recording_csv);
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
  if (app.got_subcommand("stability")) return run_stability_command(stability, cancelled);
  if (app.got_subcommand("replay")) {
    return run_replay_command(recording, [] { return cancelled.load(); });
  }
  if (app.got_subcommand("tool-sequences")) return run_sequence_command(sequences, cancelled);
  if (const auto code = run_studies(app, studies, cancelled)) return *code;
  return run_fault_command(faults, cancelled);
}

}  // namespace
}  // namespace handrail

int main(int argc, char** argv) {
  return handrail::end_output("handrail-lab", handrail::run(argc, argv));
}
