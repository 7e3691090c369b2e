// Which trial a person makes next.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace handrail {

struct ExperimentRules {
  int practice = 2;  // successes in each mode before any trial of it counts (dissertation 3.4.1)
  int trials = 2;    // successes after that
};

// One trial that was begun.
struct TrialMade {
  int mode = 0;
  bool practice = false;
  bool interrupted = false;  // counts for nothing
  bool done = false;         // successful
};

struct TrialNext {
  int mode = 0;
  bool practice = false;
  int number = 1;   // among all that this person has ended, from 1
  int attempt = 1;  // among the counted ones of this mode, from 1; 0 of practice
};

// Of what is drawn for a subject: always the same for one, and for each `what` another.
std::uint64_t subject_seed(const std::string& subject, const char* what);

// The modes in an order that is random between subjects and always the same for one.
std::vector<int> order_of_modes(const std::string& subject, int modes);

// The next trial of who makes the modes in `order` and has made `made`: in each mode practice until
// it has succeeded as often as the rules ask, then trials until as many have, or three times as
// many were made, as in the simulated studies. None: all is done. Pure.
std::optional<TrialNext> next_trial(const ExperimentRules& rules, const std::vector<int>& order,
                                    const std::vector<TrialMade>& made);

}  // namespace handrail
