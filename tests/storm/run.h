// One sequence: the programs are started, the hand drives at speed, the storm passes, the operator
// finds the way out, and the arm must follow again.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "client/api/operator_client.h"
#include "tests/storm/cell.h"
#include "tests/storm/drive.h"
#include "tests/storm/judge.h"

namespace handrail::storm {

struct Outcome {
  bool complete = false;  // false: it was interrupted
  Figures figures;
  std::vector<Violation> violations;
  std::vector<Violation> story;  // what was done and said, in order
  Nanos start = 0;               // the times above count from here, for people
  double seconds = 0.0;
};

class Run {
 public:
  // `interrupted` is asked every few milliseconds; `look`, if given, sees the programs as often.
  Run(const Sequence& sequence, bool (*interrupted)(),
      std::function<void(const Cell& cell)> look = {});

  Outcome go();
  // The taps and outputs of a run that is over, for who looks into it.
  const Cell& cell() const { return cell_; }

 private:
  void storm();
  bool start(Who who);
  void apply(const Act& act);
  void restart(const Act& act);
  void stop();
  bool recover();
  bool follow();
  bool bring_hand_home();
  bool lead_to(const Pose& goal);
  std::optional<Pose> measured_tip() const;

  // Drives, watches and looks at the status until then.
  void live(Nanos until);
  void tick();
  void observe(const pb::Status& status);
  void steer(const pb::Status& status);
  std::optional<pb::Status> status();
  // What the operator orders, in text format: done, and what was said.
  bool order(const std::string& text, std::string& said);
  void follow_way_out(const std::string& way);

  void forbid(const std::string& why);
  void allow();
  void violated(const std::string& what);
  void tell(const std::string& what);
  bool over() const;

  Sequence sequence_;
  bool (*interrupted_)();
  std::function<void(const Cell& cell)> look_;
  Cell cell_;
  OperatorClient client_;
  Random random_;
  DriveRegion region_;
  Outcome outcome_;
  std::vector<Forbidden> forbidden_;
  std::optional<Forbidden> forbidden_now_;
  std::string told_;          // of the last order
  std::vector<Who> stopped_;  // programs that know of a stop which was not reset
  bool led_ = false;          // seen engaged on both sides
  bool driving_ = false;      // the hand moves
  std::optional<Who> away_;   // ended, and not yet started anew
  bool ended_ = false;        // a program ended by itself: no more to be seen
};

}  // namespace handrail::storm
