// The population simulated operators are drawn from: for each parameter a median, a spread, bounds
// and where they come from.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "devices/hand/operator_parameters.h"
#include "server/base/random.h"

namespace handrail {

// How one parameter varies between people: lognormal about the median, kept within the bounds.
struct ParameterRange {
  double OperatorParameters::*field = nullptr;
  const char* name = "";         // as in the file, with its unit, such as "speed_mm_s"
  double unit = 1.0;             // SI value of 1 in the file's unit
  double median = 0.0;           // [SI]
  double spread = 0.0;           // standard deviation of the logarithm
  double low = 0.0, high = 0.0;  // bounds on a person, and on the median while it is fitted [SI]
  bool fitted = false;           // free for `fit`
  bool inherited = false;        // as the population's base has it, and never free
  std::string source;            // where median, spread and bounds come from
};

// One parameter as the file knows it, and what the operator's model can work with.
struct ParameterInfo {
  double OperatorParameters::*field;
  const char* name;  // ends in the unit
  double unit;       // SI value of 1
  double least;      // allowed in a file, in its unit
  double most;
  bool of_screws = false;  // only people at a screw have it: a file names all of these, or none
};

// Every field of OperatorParameters, in its order.
const std::vector<ParameterInfo>& operator_parameter_table();

struct Population {
  std::string name;
  std::string description;
  std::string comment;                     // lines the file begins with, each with its '#'
  std::string file;                        // where it was read from
  std::string base;                        // the population that it differs from; empty: none
  std::vector<ParameterRange> parameters;  // those of the table the file has, in its order

  // False when the parameters of people at a screw are missing.
  bool knows_screws() const { return parameters.size() == operator_parameter_table().size(); }

  // The parameter of that name, or null.
  ParameterRange* find(std::string_view parameter_name);
  // One operator: same `random` state, same operator. A parameter's draw does not depend on another
  // one's median, spread or bounds, so that varying one leaves the others alone.
  OperatorParameters draw(Random& random) const;
  // The operator of all medians.
  OperatorParameters median() const;
};

}  // namespace handrail
