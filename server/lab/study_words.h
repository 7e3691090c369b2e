// The words of handrail-lab's studies and fits, and what several of its commands have in common.
#pragma once

#include <CLI/CLI.hpp>
#include <atomic>
#include <map>
#include <optional>
#include <string>

#include "server/lab/study/linear/linear_command.h"
#include "server/lab/study/screw/screw_command.h"

namespace handrail {

inline void add_operators(CLI::App& sub, int& operators, const char* what) {
  sub.add_option("--operators", operators, what)
      ->check(CLI::Range(1, 100000))
      ->capture_default_str();
}

inline void add_threads(CLI::App& sub, int& threads,
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

inline constexpr const char* kVary = "Vary one thing, printed beside the study as it is";

inline const std::map<std::string, BumperSettings::Form> kForms = {
    {"published", BumperSettings::Form::kPublished}, {"default", BumperSettings::Form::kDefault}};

// What all studies have in common. `block`: of the scene, that the study needs.
inline void add_study(CLI::App& sub, StudyCommand& study, const std::string& block) {
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
  sub.add_option("--record", study.record,
                 "folder for recordings of every trial, as the daemons write them")
      ->check(CLI::Validator(
          [](const std::string& text) { return text.empty() ? "expected a folder" : ""; }, ""));
  sub.add_option("--set", study.settings,
                 "KEY=VALUE: a scene's field, rig.FIELD, operator.PARAMETER, haptic.rate_hz, "
                 "haptic.torque, link.delay_ms; all --set together are one variation")
      ->allow_extra_args(false)
      ->group(kVary);
  sub.add_option("--sweep", study.sweeps, "KEY=VALUE,VALUE,...: a variation for each value")
      ->allow_extra_args(false)
      ->group(kVary);
}

inline void add_linear(CLI::App& app, StudyWords& words) {
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

inline void add_screw(CLI::App& app, StudyWords& words) {
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

inline void add_fit(CLI::App& fits, FitCommand& fit, const char* name, const std::string& mode,
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

inline void add_studies(CLI::App& app, StudyWords& words) {
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
inline std::optional<int> run_studies(const CLI::App& app, const StudyWords& words,
                                      const std::atomic<bool>& cancelled) {
  if (app.got_subcommand("linear-movement")) return run_linear_command(words.linear, cancelled);
  if (app.got_subcommand("screw-fastening")) return run_screw_command(words.screw, cancelled);
  if (!app.got_subcommand("fit")) return std::nullopt;
  return app.get_subcommand("fit")->got_subcommand("linear-movement")
             ? run_linear_fit(words.linear_fit, cancelled)
             : run_screw_fit(words.screw_fit, cancelled);
}

}  // namespace handrail
