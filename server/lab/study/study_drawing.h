// What the figures of all studies share.
#pragma once

#include <string>
#include <vector>

#include "server/base/status.h"
#include "server/lab/figure/panel.h"
#include "server/lab/study/study_run.h"

namespace handrail {

// Makes a folder for figures where there is none; the error names it.
Status make_folder(const std::string& folder);

// The line below a figure's title. `fitted`: to what, such as "the published NV medians".
std::string origin_of(const StudyHeader& header, const std::string& fitted);

// Box plots of one measure, side by side: `values` of each mode [SI], `known` medians in the
// measure's unit, 0 for none, and what they are called at the number and in the legend.
figure::Panel measure_panel(const char* title, const char* unit, double per_si,
                            const std::vector<std::string>& modes, std::vector<ByPerson> values,
                            const double* known, const char* known_word,
                            const std::string& known_name);

// The first successful trial of a mode that has a trace; null if none.
template <typename Study>
const typename Study::Outcome* first_traced(const Study& study, typename Study::Mode mode) {
  for (const auto& trial : study.trials) {
    if (trial.mode == mode && trial.result.end == Study::End::kDone &&
        !trial.result.trace.empty()) {
      return &trial.result;
    }
  }
  return nullptr;
}

}  // namespace handrail
