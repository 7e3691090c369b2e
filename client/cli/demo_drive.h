// The demo's way to drive: orders to the master, moves of the simulated hand, and how it goes on
// after the session ended by itself.
#pragma once

#include <functional>
#include <string>

#include "client/api/operator_client.h"
#include "client/api/status_pose.h"
#include "client/cli/interrupt.h"
#include "client/doctor/machine_cost.h"
#include "server/base/spatial.h"

namespace handrail {

// Hand to robot, as in the default scene.
inline constexpr double kDemoScale = 2.0;

using Say = std::function<void(const std::string&)>;

// The first failure is kept, and after it nothing is ordered any more. A session that ended by
// itself, as when the machine paused, is no failure: recover() gets it back, ten times in each
// move. One that somebody stopped is.
class DemoDriver {
 public:
  DemoDriver(const MasterPlace& master, const std::string& as) : client_(master, as, interrupted) {}

  // One order. A refusal while the session is not engaged counts as lost(), any other fails.
  bool order(const pb::Request& request);
  // The newest status; an empty one once failed.
  pb::Status status();
  // A move of the hand in its device's axes [mm], [deg]. `see` has a status every 7 ms until hand
  // and arm are at rest.
  bool move(const Vec3& by_mm, const Vec3& turn_deg,
            const std::function<void(const pb::Status&)>& see = {});
  // Brings the hand home, with the arm at rest, then engages. A fault is reset before.
  bool engage();
  // Leads the arm to X_S by the hand. Fails, and says how far it is, beyond 150 mm or 90 deg, and
  // where it comes no nearer than 15 mm and 10 deg.
  bool drive_to(const Pose& X_S);
  // After lost(): says why, resets, engages, drops the tools and drives to X_S.
  bool recover(const Pose& X_S, const Say& say);

  // What is lost from here on counts for another move.
  void begin_move() { losses_of_move_ = 0; }

  void fail(const std::string& problem, ExitCode code = kExitRefused);
  bool ok() const { return code_ == kExitDone && !lost_; }
  bool lost() const { return code_ == kExitDone && lost_; }
  ExitCode code() const { return code_; }
  const std::string& problem() const { return problem_; }
  int losses() const { return losses_; }  // of the session, so far
  const MachineCost& machine() const { return machine_; }

 private:
  Result<pb::Reply> call(const pb::Request& request, Nanos patience = 5 * kSecond);
  bool lead(const Pose& X_S);  // one move of the hand toward it
  void lose(const pb::Status& status);
  bool wait();  // until the next sample; false once interrupted

  OperatorClient client_;
  MachineCost machine_;
  ExitCode code_ = kExitDone;
  std::string problem_;
  bool lost_ = false;
  int losses_ = 0, losses_of_move_ = 0;
  std::string why_lost_;
};

}  // namespace handrail
