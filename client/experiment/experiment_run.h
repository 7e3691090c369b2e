// One person's experiment at the running programs, from the first practice to the table.
#pragma once

#include <istream>
#include <ostream>
#include <string>

#include "client/api/operator_client.h"
#include "client/experiment/trial_order.h"

namespace handrail {

struct ExperimentWords {
  std::string experiment;              // of experiment_names()
  std::string subject;                 // the person, or what a simulated one is called
  std::string folder = "experiments";  // where files are written
  bool resume = false;
  bool simulated = false;  // nobody is there: a simulated operator leads the page's cursor
  bool json = false;       // of what is told at the end
  std::string rig;         // the simulated rig's status socket; empty: none is named
  int trials = 0;          // successes wanted in each mode; 0: as usual, or as was begun with
};

struct ExperimentPlace {
  MasterPlace master;
  std::string as;
  std::ostream& out;
  std::ostream& err;
  bool (*cancelled)();
  std::istream* in = nullptr;  // what a person types; null: nobody is there
};

// Says on `out` and on the page what is to be done, and writes every trial down before the next.
ExitCode run_experiment(const ExperimentWords& words, const ExperimentPlace& place);

// What all people of a folder, or all simulated ones, have done so far: table or JSON, and with
// `figures` the study's drawings in that folder.
ExitCode report_experiment(const ExperimentWords& words, const std::string& figures,
                           const ExperimentPlace& place);

}  // namespace handrail
