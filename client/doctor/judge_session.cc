#include "client/doctor/judge.h"
#include "client/doctor/wording.h"

namespace handrail {

void judge_session(const DoctorFacts& facts, Findings& out) {
  if (!facts.master.status) return;
  const pb::Status& s = status_of(facts);
  for (const std::string& difference : s.hash_mismatch()) {
    out.push_back({"scene.same", Level::kProblem, "not the same on both sides: " + difference,
                   "the same file of scene " + s.scene() +
                       " on both computers (handrail scene list says where each is read from), and "
                       "handrail scene load " +
                       s.scene()});
  }
  if (slave_is_heard(s) && s.hash_mismatch().empty()) {
    out.push_back(
        {"scene.same", Level::kOk, "scene " + s.scene() + " is the same on both sides", ""});
  }
  const bool heard = slave_is_heard(s) && s.peer().problem().empty();
  const bool latched = s.state() == "fault" || (heard && s.slave_state() == "fault");
  // Without a slave the link's finding says it all.
  if (!heard && !latched && !s.has_walls()) return;
  const std::string fact = "session " + s.state() +
                           (heard ? ", the slave's " + s.slave_state() : std::string()) + ": " +
                           s.ledger().sentence();
  const std::string& way_out = s.ledger().way_out();
  const bool idle = way_out.empty() || way_out == "engage";
  const Level level = latched ? Level::kProblem : idle ? Level::kOk : Level::kNote;
  const std::string next = latched && !heard
                               ? "first what is said of the link; then handrail reset, "
                                 "and handrail engage"
                           : way_out == "engage" ? "handrail engage"
                                                 : way_out;
  out.push_back({"session.state", level, fact, next});
}

}  // namespace handrail
