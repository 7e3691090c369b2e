// Has the master write down an experiment's trials.
#pragma once

#include <functional>
#include <string>

#include "client/api/operator_client.h"

namespace handrail {

// What a recording is called by for that person's trials: a label of at most 40 letters, digits,
// '-' and '_'.
std::string recording_label(const std::string& experiment, const std::string& subject);
// Whether a recording's file, on whatever computer, is one of the master's with that label.
bool is_recording_with(const std::string& label, const std::string& file);

// Asks the master within a second, also after Ctrl-C. What it cannot have recorded is said, once,
// and the experiment goes on.
class ExperimentRecording {
 public:
  using Say = std::function<void(const std::string&)>;
  ExperimentRecording(const MasterPlace& master, const std::string& as, std::string label, Say say)
      : client_(master, as), label_(std::move(label)), say_(std::move(say)) {}

  // Before a trial: from here on everything is recorded, on both sides, where the master's
  // configuration lets. What a killed runner of the same person has left goes on.
  void keep();
  // What happens now.
  void mark(const std::string& text);
  // Nothing more. A recording that is somebody else's goes on.
  void end();

 private:
  Result<pb::Reply> ask(const pb::Request& request);
  std::string order(const pb::Request& request);
  void say_once(const std::string& text);

  OperatorClient client_;
  std::string label_;
  Say say_;
  std::string said_;
  bool own_ = false;  // the master records under the label
};

}  // namespace handrail
