#include "tests/links/outcome.h"

#include <spdlog/fmt/fmt.h>

#include <cstdio>

namespace handrail::links {

std::string outcome_text(const NearOutcome& o) {
  return fmt::format("launched {} started {} engaged {} ended {} ends {} behind {:.4f}\n",
                     o.launched, o.started, o.engaged_at, o.ended, o.ends, o.behind);
}

Result<NearOutcome> read_outcome(const std::string& text) {
  long long launched = 0, started = 0, engaged = 0, ended = 0;
  NearOutcome out;
  if (std::sscanf(text.c_str(),
                  "launched %lld started %lld engaged %lld ended %lld ends %d behind %lf",
                  &launched, &started, &engaged, &ended, &out.ends, &out.behind) != 6) {
    return Status::error("the near side wrote no outcome");
  }
  out.launched = launched;
  out.started = started;
  out.engaged_at = engaged;
  out.ended = ended;
  return out;
}

}  // namespace handrail::links
