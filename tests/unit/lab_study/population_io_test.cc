#include "server/lab/study/population_io.h"
#include "server/base/plain_text.h"
#include "server/base/read_file.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstring>

#include "server/base/units.h"
#include "server/scene/text_io.h"
#include "tests/support/temp_folder.h"
#include "tests/unit/lab_study/population_samples.h"

namespace handrail {
namespace {

using ::testing::HasSubstr;

std::string error_of(const std::string& text) {
  return parse_population("/x/p.operators", text).message();
}
// The error when the speed has that block; its line is 9, its block starts behind "parameter { ".
std::string speed_error(const std::string& rest) {
  return error_of(population_text("speed_mm_s", rest));
}

Population shipped() {
  const Result<std::string> file = find_population("linear-movement");
  EXPECT_TRUE(file.is_ok()) << file.message();
  const Result<Population> people = load_population(file ? *file : "");
  EXPECT_TRUE(people.is_ok()) << people.message();
  return people ? *people : Population();
}

void expect_same_bits(const Population& a, const Population& b) {
  EXPECT_EQ(a.name, b.name);
  EXPECT_EQ(a.description, b.description);
  EXPECT_EQ(a.comment, b.comment);
  ASSERT_EQ(a.parameters.size(), b.parameters.size());
  for (std::size_t i = 0; i < a.parameters.size(); ++i) {
    const ParameterRange &p = a.parameters[i], &q = b.parameters[i];
    EXPECT_EQ(p.field, q.field);
    EXPECT_EQ(p.median, q.median) << p.name;
    EXPECT_EQ(p.spread, q.spread) << p.name;
    EXPECT_EQ(p.low, q.low) << p.name;
    EXPECT_EQ(p.high, q.high) << p.name;
    EXPECT_EQ(p.fitted, q.fitted) << p.name;
    EXPECT_EQ(p.source, q.source) << p.name;
  }
}

TEST(PopulationIo, ReadsAParameterInItsUnit) {
  Result<Population> people = parse_population(
      "/x/p.operators",
      population_text("turn_speed_deg_s",
                      "median: 90 spread: 0.1 low: 45 high: 180 fitted: true source: 'a book'"));
  ASSERT_TRUE(people.is_ok()) << people.message();
  const ParameterRange& turn = *people->find("turn_speed_deg_s");
  EXPECT_DOUBLE_EQ(turn.median, 90 * kDeg);
  EXPECT_DOUBLE_EQ(turn.low, 45 * kDeg);
  EXPECT_DOUBLE_EQ(turn.high, 180 * kDeg);
  EXPECT_EQ(turn.spread, 0.1);
  EXPECT_TRUE(turn.fitted);
  EXPECT_EQ(turn.source, "a book");
  EXPECT_FALSE(people->find("gain")->fitted);
  EXPECT_EQ(people->name, "p");
  EXPECT_EQ(people->file, "/x/p.operators");
}

TEST(PopulationIo, TakesParametersInAnyOrder) {
  const auto& table = operator_parameter_table();
  const std::string text = population_text();
  const std::size_t end = text.find('\n') + 1;
  const std::size_t second = text.find('\n', end) + 1;
  const Result<Population> people = parse_population(
      "p", text.substr(0, end) + text.substr(second) + text.substr(end, second - end));
  ASSERT_TRUE(people.is_ok()) << people.message();
  for (std::size_t i = 0; i < table.size(); ++i) {
    EXPECT_EQ(people->parameters[i].field, table[i].field);
  }
}

// Where one parameter more than the table has stands.
std::string one_too_many() {
  const std::size_t size = operator_parameter_table().size();
  return "/x/p.operators:" + std::to_string(size + 2) + ":13: field 'parameter[" +
         std::to_string(size) + "].name': ";
}

TEST(PopulationIo, RefusesAnUnknownParameter) {
  EXPECT_EQ(error_of(population_text() + parameter_text("speed_mm", kPlainRange)),
            one_too_many() + "no parameter 'speed_mm'; did you mean 'speed_mm_s'?");
  EXPECT_EQ(error_of("name: 'p' " + parameter_text("colour_of_the_hat", kPlainRange)),
            "/x/p.operators:1:23: field 'parameter[0].name': no parameter 'colour_of_the_hat'");
}

TEST(PopulationIo, RefusesAParameterGivenTwice) {
  EXPECT_EQ(error_of(population_text() + parameter_text("gain", kPlainRange)),
            one_too_many() + "'gain' is given twice");
}

TEST(PopulationIo, WhatOnlyPeopleAtAScrewHaveIsLeftOutAltogetherOrNotAtAll) {
  std::string all = population_text(), none, but_one;
  for (const ParameterInfo& info : operator_parameter_table()) {
    const std::size_t start = all.find("parameter { name: '" + std::string(info.name) + "'");
    const std::string line = all.substr(start, all.find('\n', start) + 1 - start);
    if (!info.of_screws) none += line;
    if (std::string(info.name) != "press_mm") but_one += line;
  }
  const auto without = parse_population("p", "name: 'p'\n" + none);
  ASSERT_TRUE(without.is_ok()) << without.message();
  EXPECT_FALSE(without->knows_screws());
  EXPECT_EQ(without->median().press, OperatorParameters().press);
  const auto with = parse_population("p", all);
  ASSERT_TRUE(with.is_ok()) << with.message();
  EXPECT_TRUE(with->knows_screws());
  EXPECT_NE(error_of("name: 'p'\n" + but_one).find("press_mm is missing"), std::string::npos);
}

TEST(PopulationIo, WantsEveryParameter) {
  std::string text = population_text();
  const std::size_t start = text.find("parameter { name: 'gain'");
  text.erase(start, text.find('\n', start) + 1 - start);
  EXPECT_EQ(error_of(text),
            "/x/p.operators:2:1: field 'parameter': gain is missing, expected every one once");
  EXPECT_EQ(error_of("name: 'p'"),
            "/x/p.operators:1:1: field 'parameter': vision_delay_ms is missing, expected every one "
            "once");
}

TEST(PopulationIo, WantsTheMedianBetweenItsBounds) {
  EXPECT_EQ(speed_error("median: 40 spread: 0.2 low: 50 high: 90 source: 's'"),
            "/x/p.operators:9:32: field 'parameter[7].median': 40 is outside its bounds, 50 to 90");
  EXPECT_EQ(speed_error("median: 95 spread: 0.2 low: 50 high: 90 source: 's'"),
            "/x/p.operators:9:32: field 'parameter[7].median': 95 is outside its bounds, 50 to 90");
  EXPECT_EQ(speed_error("median: 50 spread: 0.2 low: 50 high: 50 source: 's'"), "");
}

TEST(PopulationIo, WantsBoundsThatTheModelCanWorkWith) {
  EXPECT_EQ(speed_error("median: 40 spread: 0.2 low: 0.5 high: 90 source: 's'"),
            "/x/p.operators:9:55: field 'parameter[7].low': 0.5 is outside the 1 to 1000 that "
            "speed_mm_s can be");
  EXPECT_EQ(speed_error("median: 40 spread: 0.2 low: 10 high: 1001 source: 's'"),
            "/x/p.operators:9:63: field 'parameter[7].high': 1001 is outside the 1 to 1000 that "
            "speed_mm_s can be");
}

TEST(PopulationIo, WantsASpreadInRange) {
  EXPECT_EQ(speed_error("median: 40 spread: 2.5 low: 10 high: 90 source: 's'"),
            "/x/p.operators:9:43: field 'parameter[7].spread': 2.5 is outside 0 to 2");
  EXPECT_EQ(speed_error("median: nan spread: 0.1 low: 10 high: 90 source: 's'"),
            "/x/p.operators:9:32: field 'parameter[7].median': nan is not a finite number");
}

TEST(PopulationIo, WantsASource) {
  EXPECT_EQ(speed_error("median: 40 spread: 0.2 low: 10 high: 90"),
            "/x/p.operators:9:1: field 'parameter[7].source': missing, but required");
  EXPECT_EQ(speed_error("median: 40 spread: 0.2 low: 10 high: 90 source: ''"),
            "/x/p.operators:9:72: field 'parameter[7].source': empty, expected where the numbers "
            "are from");
}

TEST(PopulationIo, WantsAFittedParametersBoundsAboveZero) {
  EXPECT_EQ(error_of(population_text(
                "pause_s", "median: 1 spread: 0.2 low: 0 high: 9 fitted: true source: 's'")),
            "/x/p.operators:16:51: field 'parameter[14].low': 0, but a fitted parameter's is above "
            "0");
}

TEST(PopulationIo, WantsAName) {
  EXPECT_EQ(error_of("name: ''"), "/x/p.operators:1:1: field 'name': empty");
  EXPECT_EQ(error_of(""), "/x/p.operators:1:1: field 'name': missing, but required");
}

TEST(PopulationIo, SaysWhichFileItCannotRead) {
  EXPECT_EQ(load_population("/no/such.operators").message(),
            "/no/such.operators: cannot open: No such file or directory");
  const TempFolder folder;
  const std::string file = folder.write("a.operators", "name: 'a'\nparametr { }");
  EXPECT_EQ(load_population(file).message(),
            file + ":2:1: field 'parametr': no such field; did you mean 'parameter'?");
}

TEST(PopulationIo, FindsShippedOnesByNameAndOthersByFile) {
  EXPECT_EQ(*find_population("linear-movement"),
            HANDRAIL_SOURCE_DIR "/server/lab/library/linear-movement.operators");
  EXPECT_EQ(*find_population("mine.operators"), "mine.operators");
  EXPECT_EQ(*find_population("./mine"), "./mine");
  EXPECT_EQ(find_population("none").message().find("population 'none' not found in /"), 0U);
}

TEST(PopulationIo, TheShippedMediansAreOfTheModelsDefaultsOrder) {
  const OperatorParameters defaults, medians = shipped().median();
  for (const ParameterInfo& info : operator_parameter_table()) {
    const double ratio = medians.*info.field / (defaults.*info.field);
    EXPECT_GT(ratio, 0.1) << info.name;
    EXPECT_LT(ratio, 10.0) << info.name;
  }
}

TEST(PopulationIo, TheShippedOneSaysWhereEachParameterIsFrom) {
  int fitted = 0;
  for (const ParameterRange& p : shipped().parameters) {
    fitted += p.fitted;
    EXPECT_EQ(p.fitted, p.source.starts_with("fitted to the published NV medians")) << p.name;
    EXPECT_GT(p.source.size(), 40U) << p.name;
  }
  EXPECT_GT(fitted, 0);
}

TEST(PopulationIo, WritesTheShippedFileAsItIs) {
  const Population people = shipped();
  EXPECT_EQ(to_text(people), *read_file(people.file, 1 << 20));
}

TEST(PopulationIo, ABaseGivesWhatIsNotNamed) {
  const Population base = shipped();
  const Result<Population> people = parse_population(
      "/x/p.operators", "name: 'p' base: 'linear-movement'\n" +
                            parameter_text("gain",
                                           "median: 0.5 spread: 0.3 low: 0.25 high: 1 "
                                           "fitted: true source: 's'"));
  ASSERT_TRUE(people.is_ok()) << people.message();
  ASSERT_EQ(people->parameters.size(), base.parameters.size());
  EXPECT_EQ(people->base, "linear-movement");
  int of_base_fitted = 0;
  for (std::size_t i = 0; i < base.parameters.size(); ++i) {
    const ParameterRange &p = people->parameters[i], &q = base.parameters[i];
    ASSERT_EQ(p.field, q.field);
    of_base_fitted += q.fitted;
    if (p.field == &OperatorParameters::gain) {
      EXPECT_TRUE(p.fitted);
      EXPECT_EQ(p.spread, 0.3);
      continue;
    }
    EXPECT_FALSE(p.fitted) << p.name;  // it is the base's fit that sets it
    EXPECT_EQ(p.median, q.median) << p.name;
    EXPECT_EQ(p.low, q.low) << p.name;
    EXPECT_EQ(p.high, q.high) << p.name;
    EXPECT_EQ(p.source, q.source) << p.name;
  }
  EXPECT_GT(of_base_fitted, 0);
}

TEST(PopulationIo, ABaseIsAShippedPopulationWithoutOne) {
  EXPECT_THAT(error_of("name: 'p' base: 'linear'"),
              HasSubstr("/x/p.operators:1:11: field 'base': population 'linear' not found in /"));
  EXPECT_EQ(error_of("name: 'p'\nbase: 'screw-fastening'"),
            "/x/p.operators:2:1: field 'base': 'screw-fastening' has a base, expected a population "
            "without");
  EXPECT_THAT(error_of("name: 'p' base: '/no/such.operators'"),
              HasSubstr("field 'base': /no/such.operators: cannot open: No such file"));
  const TempFolder folder;
  const std::string self = folder.path() + "/self.operators";  // its own base
  folder.write("self.operators", "name: 'p'\nbase: '" + self + "'");
  EXPECT_EQ(load_population(self).message(),
            self + ":2:1: field 'base': '" + self + "' has a base, expected a population without");
  EXPECT_EQ(error_of("name: 'p'\nbase: 'linear-movement'\n" + parameter_text("gain", kPlainRange) +
                     parameter_text("gain", kPlainRange)),
            "/x/p.operators:4:13: field 'parameter[1].name': 'gain' is given twice");
  EXPECT_THAT(
      error_of("name: 'p'\nbase: 'linear-movement'\n" + parameter_text("press_mm", kPlainRange)),
      HasSubstr("insert_tolerance_mm is missing"));
}

TEST(PopulationIo, PeopleAtTheScrewAreThoseOfTheLinearMovement) {
  const Population linear = shipped();
  const Result<Population> screw = load_population(*find_population("screw-fastening"));
  ASSERT_TRUE(screw.is_ok()) << screw.message();
  EXPECT_TRUE(screw->knows_screws());
  EXPECT_EQ(screw->median().drift, linear.median().drift);
  EXPECT_NE(screw->median().turn_speed, linear.median().turn_speed);
  EXPECT_EQ(to_text(*screw), *read_file(screw->file, 1 << 20));
}

TEST(PopulationIo, WritesAFileThatReadsBackToTheSameBits) {
  Population people = shipped();
  people.comment = "# one\n#two\n";
  people.description = "a \"quoted\" \\ word,\nµm";
  people.parameters[0].source = "it's 5 µm";
  Random random(11);
  for (int round = 0; round < 50; ++round) {
    // Decimals of the file's unit, of 1 to 17 digits.
    for (ParameterRange& p : people.parameters) {
      const ParameterInfo& info =
          operator_parameter_table()[static_cast<std::size_t>(&p - people.parameters.data())];
      double value = info.least + (info.most - info.least) * (0.01 + 0.9 * random.uniform());
      if (round % 2 == 0) value = std::strtod(number_text(value).substr(0, 6).c_str(), nullptr);
      p.median = value * p.unit;
      p.low = std::max(info.least, 0.5 * value) * p.unit;
      p.high = info.most * p.unit;
      p.spread = random.uniform();
    }
    const std::string text = to_text(people);
    const Result<Population> back = parse_population("p", text);
    ASSERT_TRUE(back.is_ok()) << back.message();
    expect_same_bits(people, *back);
    EXPECT_EQ(to_text(*back), text);
  }
}

TEST(PopulationIo, WritesShortDecimals) {
  Result<Population> people = parse_population("p", population_text());
  ASSERT_TRUE(people.is_ok()) << people.message();
  people->find("speed_mm_s")->median = 41.3 * kMm;
  people->find("turn_speed_deg_s")->median = 36.1 * kDeg;
  EXPECT_THAT(to_text(*people), HasSubstr("median: 41.3  spread: 0.2  low: 25  high: 75\n"));
  EXPECT_THAT(to_text(*people), HasSubstr("median: 36.1  spread: 0.2  low: 25  high: 75\n"));
}

TEST(PopulationIo, KeepsOnlyTheCommentAtTheHead) {
  const Result<Population> people =
      parse_population("p", "# head\n#\n" + population_text() + "# tail\n");
  ASSERT_TRUE(people.is_ok()) << people.message();
  EXPECT_EQ(people->comment, "# head\n#\n");
  EXPECT_EQ(to_text(*people).find("# head\n#\nname: \"p\"\n"), 0U);
}

}  // namespace
}  // namespace handrail
