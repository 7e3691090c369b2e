#include "server/lab/study/population.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "server/base/units.h"
#include "tests/unit/lab_study/population_samples.h"

namespace handrail {
namespace {

Population population() {
  const Result<Population> read = parse_population("p.operators", population_text());
  EXPECT_TRUE(read.is_ok()) << read.message();
  return read ? *read : Population();
}

// Values of one parameter over `count` operators of one seed.
std::vector<double> drawn(const Population& people, double OperatorParameters::*field, int count) {
  Random random(7);
  std::vector<double> out;
  for (int i = 0; i < count; ++i) out.push_back(people.draw(random).*field);
  return out;
}

TEST(Population, TheTableHasEveryFieldOnceInOrder) {
  const auto& table = operator_parameter_table();
  EXPECT_EQ(table.size() * sizeof(double), sizeof(OperatorParameters));
  const OperatorParameters p;
  const auto* first = reinterpret_cast<const char*>(&p);
  std::set<std::string> names;
  for (std::size_t i = 0; i < table.size(); ++i) {
    const auto offset = reinterpret_cast<const char*>(&(p.*table[i].field)) - first;
    EXPECT_EQ(offset, static_cast<std::ptrdiff_t>(i * sizeof(double))) << table[i].name;
    EXPECT_TRUE(names.insert(table[i].name).second) << table[i].name;
    EXPECT_LT(table[i].least, table[i].most) << table[i].name;
  }
}

TEST(Population, NamesEndInTheirUnit) {
  for (const ParameterInfo& info : operator_parameter_table()) {
    const std::string name = info.name;
    const double unit = name.find("_mm") != std::string::npos && !name.ends_with("_n_mm") ? 1e-3
                        : name.ends_with("_ms")                                           ? 1e-3
                        : name.find("_deg") != std::string::npos                          ? kDeg
                        : name.ends_with("_n_mm")                                         ? 1e3
                                                                                          : 1.0;
    EXPECT_DOUBLE_EQ(info.unit, unit) << name;
  }
}

TEST(Population, FindsAParameterByName) {
  Population people = population();
  ASSERT_NE(people.find("speed_mm_s"), nullptr);
  EXPECT_EQ(people.find("speed_mm_s")->field, &OperatorParameters::speed);
  EXPECT_EQ(people.find("speed"), nullptr);
  EXPECT_EQ(people.find(""), nullptr);
}

TEST(Population, TheMedianOperatorHasEveryMedian) {
  Population people = population();
  people.find("mass_kg")->median = 0.7;
  const OperatorParameters person = people.median();
  EXPECT_EQ(person.mass, 0.7);
  EXPECT_DOUBLE_EQ(person.speed, 0.05);
  EXPECT_DOUBLE_EQ(person.stiffness, 500.0);
}

TEST(Population, TheSameRandomStateGivesTheSameOperator) {
  const Population people = population();
  Random a(3), b(3), c(4);
  const OperatorParameters first = people.draw(a);
  EXPECT_EQ(first.gain, people.draw(b).gain);
  EXPECT_NE(first.gain, people.draw(c).gain);
  const OperatorParameters second = people.draw(a);
  EXPECT_NE(second.gain, first.gain);
  EXPECT_EQ(second.gain, people.draw(b).gain);
}

TEST(Population, PeopleAreLognormalAboutTheMedian) {
  Population people = population();
  ParameterRange& mass = *people.find("mass_kg");
  mass.median = 0.12;
  mass.spread = 0.3;
  mass.low = 1e-6;
  mass.high = 1e6;
  constexpr int kPeople = 20000;
  double sum = 0.0, squares = 0.0;
  for (const double m : drawn(people, mass.field, kPeople)) {
    const double z = std::log(m / 0.12) / 0.3;
    sum += z;
    squares += z * z;
  }
  // Standard errors 0.007 and 0.01.
  EXPECT_NEAR(sum / kPeople, 0.0, 0.03);
  EXPECT_NEAR(squares / kPeople, 1.0, 0.04);
}

TEST(Population, NobodyIsOutsideTheBounds) {
  Population people = population();
  ParameterRange& mass = *people.find("mass_kg");
  mass.spread = 1.0;
  const std::vector<double> values = drawn(people, mass.field, 1000);
  EXPECT_EQ(*std::min_element(values.begin(), values.end()), mass.low);
  EXPECT_EQ(*std::max_element(values.begin(), values.end()), mass.high);
}

TEST(Population, WithoutSpreadEverybodyIsTheMedian) {
  Population people = population();
  for (ParameterRange& p : people.parameters) p.spread = 0.0;
  for (const double gain : drawn(people, &OperatorParameters::gain, 10)) EXPECT_EQ(gain, 0.5);
}

TEST(Population, ChangingOneParameterLeavesTheOthersDrawsAlone) {
  const Population people = population();
  for (std::size_t changed = 0; changed < people.parameters.size(); ++changed) {
    Population other = people;
    other.parameters[changed].median *= 1.1;
    other.parameters[changed].spread = 0.0;
    other.parameters[changed].low *= 0.9;
    other.parameters[changed].high *= 1.2;
    Random a(5), b(5);
    (void)people.draw(a);  // operators after the first one, too
    (void)other.draw(b);
    const OperatorParameters one = people.draw(a), two = other.draw(b);
    for (std::size_t i = 0; i < people.parameters.size(); ++i) {
      const auto field = people.parameters[i].field;
      if (i == changed) {
        EXPECT_EQ(two.*field, other.parameters[i].median);
      } else {
        EXPECT_EQ(one.*field, two.*field) << people.parameters[i].name;
      }
    }
  }
}

TEST(Population, ParametersOfOnePersonAreDrawnApart) {
  // All z of a person differ: no two parameters share a stream.
  const Population people = population();
  Random random(9);
  const OperatorParameters person = people.draw(random);
  std::set<double> shares;
  for (const ParameterRange& p : people.parameters) {
    const double share = person.*p.field / p.median;
    if (person.*p.field > p.low && person.*p.field < p.high) {
      EXPECT_TRUE(shares.insert(share).second) << p.name;
    }
  }
  EXPECT_GT(shares.size(), 20U);
}

}  // namespace
}  // namespace handrail
