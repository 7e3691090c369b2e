#include "client/experiment/questionnaire.h"

#include <optional>

#include "client/experiment/experiment_task.h"
#include "server/base/plain_text.h"

namespace handrail {
namespace {

constexpr const char* kGuidance = "I feel that the virtual constraints do provide guidance.";

constexpr Statement kWrench[] = {
    {"resemblance", "It feels like a real omni-directional wrench.", 3.8, 4.0, 3.0, 5.0},
    {"guidance", kGuidance, 4.6, 5.0},
    {"tightening effect", "It feels like a screw that is being tightened.", 4.5, 4.5},
};
constexpr Statement kGearshift[] = {
    {"resemblance", "It feels like a real manual gearshift.", 3.5, 3.5, 3.0, 4.0},
    {"guidance", kGuidance, 4.5, 4.5},
    {"visual effect", "What I see of the gearshift helps me.", 4.6, 5.0},
};

// A line as it was typed; none at the input's end.
std::optional<std::string> typed_line(std::istream& in) {
  constexpr std::size_t kLongest = 64;
  std::string out;
  bool any = false;
  for (char c = 0; in.get(c); any = true) {
    if (c == '\n') return out;
    if (out.size() < kLongest) out += c;
  }
  return any ? std::optional(out) : std::nullopt;
}

std::string trimmed(const std::string& text) {
  const auto from = text.find_first_not_of(" \t\r");
  if (from == std::string::npos) return {};
  return text.substr(from, text.find_last_not_of(" \t\r") - from + 1);
}

// 0: it is none.
unsigned score_in(const std::string& text) {
  if (text.size() != 1 || text[0] < '0' + static_cast<int>(kLeastScore) ||
      text[0] > '0' + static_cast<int>(kMostScore)) {
    return 0;
  }
  return static_cast<unsigned>(text[0] - '0');
}

// 0: nobody answers any more.
unsigned ask_one(const Statement& statement, std::istream& in, std::ostream& out) {
  for (;;) {
    out << "  " << statement.text << " (1 to 5): " << std::flush;
    const std::optional<std::string> line = typed_line(in);
    if (!line) return 0;
    const std::string answer = trimmed(*line);
    if (const unsigned score = score_in(answer); score != 0) return score;
    out << "  '" << shown(answer) << "' is no score, expected a number from 1 (not at all) to 5\n";
  }
}

}  // namespace

std::span<const Statement> statements_of(const std::string& experiment) {
  if (scene_of_experiment(experiment) == "wrench") return kWrench;
  if (experiment == "gearshift") return kGearshift;
  return {};
}

unsigned score_of(const pb::ExperimentAnswers& answers, const std::string& statement) {
  for (const pb::ExperimentAnswer& answer : answers.answer()) {
    if (answer.statement() == statement) return answer.score();
  }
  return 0;
}

pb::ExperimentAnswers ask(std::span<const Statement> statements,
                          const pb::ExperimentAnswers& before, std::istream& in,
                          std::ostream& out) {
  pb::ExperimentAnswers answers;
  bool there = true;
  for (const Statement& statement : statements) {
    pb::ExperimentAnswer& answer = *answers.add_answer();
    answer.set_statement(statement.name);
    unsigned score = score_of(before, statement.name);
    if (score == 0 && there) {
      score = ask_one(statement, in, out);
      there = score != 0;
    }
    if (score != 0) answer.set_score(score);
  }
  return answers;
}

}  // namespace handrail
