// What differs between experiments, as the runner makes them.
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "client/experiment/trial_order.h"
#include "proto/experiment.pb.h"
#include "proto/operator.pb.h"
#include "server/base/plane.h"
#include "server/base/spatial.h"
#include "server/base/status.h"
#include "server/model/scene.h"

namespace handrail {

// What the runner does for a task.
struct TaskHelp {
  std::function<Status(pb::Request)> order;  // in the name of who drives
  std::function<void(const std::string&)> say;
};

struct TaskPrompt {
  std::string text;          // what the person is to do, in a line
  std::optional<Vec2> ball;  // where they are led to, frame of the walls [m]
};

// One experiment: between begin() and ended() it is one trial. `now` is the master's status, about
// every 7 ms.
class ExperimentTask {
 public:
  virtual ~ExperimentTask() = default;

  // Of each mode, as the files have it.
  virtual std::vector<std::string> modes() const = 0;
  // The scene that the master is to have for a trial of a mode.
  virtual std::string scene_of(int mode) const = 0;
  virtual ExperimentRules rules() const = 0;
  // What is asked of the device; the error says what to do.
  virtual Status suits(const pb::Status& now) const = 0;
  // Nobody is there: a simulated person makes all trials from now on, for this subject.
  virtual Status simulate(const std::string& subject) = 0;

  // The trial as it stands in the file before it has ended.
  virtual pb::ExperimentTrial begin(const TrialNext& next) = 0;
  // Null: the master did not answer.
  virtual void see(const pb::Status* now) = 0;
  virtual bool ended() const = 0;
  virtual TaskPrompt prompt() const = 0;
  // What the task orders by itself at this moment, and what a simulated person does.
  virtual void act(const pb::Status& now, const TaskHelp& help) = 0;
  // Where the simulated person's hand is, frame M.
  virtual Pose hand() const = 0;
  // What the trial has come to: its measures, and in words.
  virtual void fill(pb::ExperimentTrial& out) const = 0;
  virtual std::string outcome() const = 0;
  // Its way as CSV. The error names the file.
  virtual Status write_trace(const std::string& file) const = 0;
};

const std::vector<std::string>& experiment_names();
// The scene that it is made in.
std::string scene_of_experiment(const std::string& experiment);

// The experiment of that name. The error says what its scene lacks. `scene` outlives it. `rig`: the
// status socket of the simulated rig; empty: none is named.
Result<std::unique_ptr<ExperimentTask>> make_task(const std::string& experiment, const Scene& scene,
                                                  const std::string& rig);

}  // namespace handrail
