#include "client/experiment/wall_results_io.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "client/experiment/experiment_results_io.h"
#include "client/experiment/experiment_task.h"
#include "client/experiment/questionnaire.h"
#include "server/lab/figure/figure.h"
#include "server/lab/study/linear/linear_trial.h"
#include "server/lab/study/study_report_io.h"
#include "server/scene/json_io.h"

namespace handrail {
namespace {

struct WallFigure {
  const char* name;  // in WallTrial
  const char* title;
  const char* unit;
};
constexpr WallFigure kOfAll[] = {
    {"time_s", "time", "s"},
    {"max_wall_force_n", "largest force at a wall", "N"},
    {"mean_wall_force_n", "mean force at a wall", "N"},
    {"max_hand_from_lever_mm", "largest distance of hand and lever", "mm"},
};
constexpr WallFigure kOfGearshift[] = {{"wrong_gears", "gears out of turn", ""}};
constexpr WallFigure kOfWrench[] = {
    {"max_force_n", "largest force", "N"},
    {"max_from_ball_mm", "largest distance from the ball", "mm"},
    {"mean_from_ball_mm", "mean distance from the ball", "mm"},
    {"turned_rad", "turned", "rad"},
};

std::vector<WallFigure> figures_of(const std::string& experiment) {
  std::vector<WallFigure> out(std::begin(kOfAll), std::end(kOfAll));
  if (experiment == "gearshift")
    out.insert(out.end(), std::begin(kOfGearshift), std::end(kOfGearshift));
  if (scene_of_experiment(experiment) == "wrench")
    out.insert(out.end(), std::begin(kOfWrench), std::end(kOfWrench));
  return out;
}

const std::string& experiment_of(const std::vector<ExperimentRecord>& people) {
  return people.front().subject.experiment();
}

bool counts(const pb::ExperimentTrial& trial) { return !trial.practice() && !trial.interrupted(); }

// What a trial has no value of, as of a force where no wall was touched, counts for nothing.
ByPerson values_of(const std::vector<ExperimentRecord>& people, const WallFigure& figure) {
  const pb::WallTrial none;
  const auto* field = none.GetDescriptor()->FindFieldByName(figure.name);
  ByPerson out;
  for (const ExperimentRecord& person : people) {
    std::vector<double>& values = out.emplace_back();
    for (const pb::ExperimentTrial& trial : person.trials) {
      if (!counts(trial)) continue;
      const pb::WallTrial& walls = trial.walls();
      const auto* reflection = walls.GetReflection();
      if (walls.end() != name_of(TrialEnd::kDone)) {
        values.push_back(std::numeric_limits<double>::infinity());
      } else if (reflection->HasField(walls, field)) {
        const bool whole = field->cpp_type() == google::protobuf::FieldDescriptor::CPPTYPE_UINT32;
        values.push_back(whole ? reflection->GetUInt32(walls, field)
                               : reflection->GetDouble(walls, field));
      }
    }
  }
  return out;
}

std::vector<double> scores_of(const std::vector<ExperimentRecord>& people,
                              const Statement& statement) {
  std::vector<double> out;
  for (const ExperimentRecord& person : people) {
    if (const unsigned score = score_of(person.answers, statement.name); score != 0)
      out.push_back(score);
  }
  return out;
}

bool simulated(const std::vector<ExperimentRecord>& people) {
  return people.front().subject.simulated();
}

std::string of_people(const std::vector<ExperimentRecord>& people) {
  return fmt::format("{} {}{}", people.size(), simulated(people) ? "simulated " : "",
                     people.size() == 1 ? "person" : "people");
}

std::string digits(double value) {
  return std::isfinite(value) ? fmt::format("{:.3g}", value) : std::string("-");
}

std::string row(const std::string& label, const Summary& s) {
  return fmt::format("  {:<42}{:>8}{:>8}{:>8}{:>8}", label, digits(s.min), digits(s.mean),
                     digits(s.median), digits(s.max));
}

constexpr const char* kHeads = "     min    mean  median     max";

std::string scores_table(const std::vector<ExperimentRecord>& people) {
  if (simulated(people)) return "\nSimulated people were asked nothing: they feel nothing.\n";
  std::string out = fmt::format("\n{:<44}{}   published (8 people, Fig. 2.11)\n",
                                "How far people agree, 1 to 5", kHeads);
  for (const Statement& statement : statements_of(experiment_of(people))) {
    const Summary found = summarise(scores_of(people, statement));
    out += row(fmt::format("{} ({} answers)", statement.name, found.count), found);
    out += fmt::format("   mean {:.1f}, median {:.1f}", statement.mean, statement.median);
    if (statement.max > 0.0)
      out += fmt::format(", min {:.0f}, max {:.0f}", statement.min, statement.max);
    out += '\n';
  }
  return out;
}

std::string table(const std::vector<ExperimentRecord>& people) {
  std::size_t trials = 0, failed = 0;
  for (const ExperimentRecord& person : people) {
    for (const pb::ExperimentTrial& trial : person.trials) {
      trials += counts(trial);
      failed += counts(trial) && trial.walls().end() != name_of(TrialEnd::kDone);
    }
  }
  std::string out = fmt::format("{}: {}, {} trials that count, {} of them failed\n\n",
                                experiment_of(people), of_people(people), trials, failed);
  out += fmt::format("{:<44}{}\n", "", kHeads);
  for (const WallFigure& figure : figures_of(experiment_of(people))) {
    const std::string unit = *figure.unit == '\0' ? "" : fmt::format(" [{}]", figure.unit);
    out += row(figure.title + unit, summarise(pooled(values_of(people, figure)))) + '\n';
  }
  return out + scores_table(people);
}

void fill(const Statement& statement, const std::vector<double>& scores, pb::ScoreReport& out) {
  out.set_statement(statement.name);
  for (const double score : scores) out.add_score(static_cast<std::uint32_t>(score));
  if (!scores.empty()) {
    const Summary found = summarise(scores);
    out.set_min(found.min);
    out.set_mean(found.mean);
    out.set_median(found.median);
    out.set_max(found.max);
  }
  out.set_published_mean(statement.mean);
  out.set_published_median(statement.median);
  if (statement.max <= 0.0) return;
  out.set_published_min(statement.min);
  out.set_published_max(statement.max);
}

std::string json_of(const std::vector<ExperimentRecord>& people) {
  pb::WallExperiment out;
  out.set_experiment(experiment_of(people));
  out.set_simulated(simulated(people));
  out.set_people(static_cast<std::uint32_t>(people.size()));
  for (const WallFigure& figure : figures_of(experiment_of(people))) {
    pb::WallMeasure& measure = *out.add_measure();
    measure.set_measure(figure.name);
    fill(stats_of(values_of(people, figure), 1.0, kReportSeed), 0.0, *measure.mutable_values());
  }
  if (!simulated(people)) {
    for (const Statement& statement : statements_of(experiment_of(people)))
      fill(statement, scores_of(people, statement), *out.add_score());
  }
  for (const ExperimentRecord& person : people) {
    *out.add_subject() = person.subject;
    for (const pb::ExperimentTrial& trial : person.trials) {
      if (counts(trial)) *out.add_trial() = trial.walls();
    }
  }
  return json_of_set_fields(out, true) + '\n';
}

figure::Panel measure_panel(const WallFigure& figure, std::vector<double> values,
                            const std::string& who) {
  figure::Axis x, y;
  x.categories = {who};
  y.label = *figure.unit == '\0' ? figure.title : fmt::format("{} [{}]", figure.title, figure.unit);
  figure::Panel panel(figure.title, x, y);
  figure::Box box;
  box.values = std::move(values);
  box.style = figure::style_of(0);
  panel.box(std::move(box));
  return panel;
}

// Boxes of the answers, with what was published on them.
figure::Panel scores_panel(const std::vector<ExperimentRecord>& people) {
  figure::Axis x, y;
  y.label = "score, 1 to 5";
  y.low = kLeastScore - 0.2;
  y.high = kMostScore + 0.2;
  std::vector<figure::Box> boxes;
  std::vector<figure::Point> means;
  for (const Statement& statement : statements_of(experiment_of(people))) {
    x.categories.emplace_back(statement.name);
    const double at = static_cast<double>(x.categories.size());
    figure::Box box;
    box.at = at;
    box.values = scores_of(people, statement);
    box.style = figure::style_of(0);
    box.name = "people here";
    box.published = figure::Published{statement.median, "", "published median"};
    boxes.push_back(std::move(box));
    means.push_back({at, statement.mean});
  }
  figure::Panel panel("How far people agree", x, y);
  for (figure::Box& box : boxes) panel.box(std::move(box));
  panel.points(std::move(means), figure::style_of(1), "published mean");
  return panel;
}

}  // namespace

std::string wall_results_text(const std::vector<ExperimentRecord>& people, bool json) {
  return json ? json_of(people) : table(people);
}

Status draw_wall_results(const std::string& folder, const std::vector<ExperimentRecord>& people) {
  figure::Figure out(fmt::format("The {} at the running programs", experiment_of(people)),
                     of_people(people));
  const std::string who = simulated(people) ? "simulated people" : "people";
  for (const WallFigure& figure : figures_of(experiment_of(people)))
    out.add(measure_panel(figure, pooled(values_of(people, figure)), who));
  if (!simulated(people)) out.add(scores_panel(people));
  return out.write_file(folder + "/" + experiment_of(people) + "-people.svg");
}

}  // namespace handrail
