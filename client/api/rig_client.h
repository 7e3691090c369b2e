// Blocking client of the simulated rig's status socket (proto/rig.proto).
#pragma once

#include <memory>
#include <string>

#include "proto/rig.pb.h"
#include "server/base/status.h"
#include "server/base/time.h"

namespace handrail {

class MasterStream;

// One connection; not thread-safe. After a failed call the connection is closed, and the next call
// opens a new one.
class RigClient {
 public:
  // `cancelled`: asked every 50 ms while a call waits; where it says so, the call fails at once.
  explicit RigClient(std::string socket, bool (*cancelled)() = nullptr);
  ~RigClient();
  RigClient(const RigClient&) = delete;
  RigClient& operator=(const RigClient&) = delete;

  // The status, with the moments after `since`, or with the newest alone if that is none. The error
  // names the socket and the cause.
  Result<pb::RigStatus> look(const std::uint64_t* since, Nanos patience);
  // The workpiece of that scene. The error is the rig's refusal, or says that there is no rig.
  Status play(const std::string& scene, bool anew, Nanos patience);

 private:
  Result<pb::RigReply> call(const pb::RigOrder& order, Nanos patience);

  std::string path_;
  bool (*cancelled_)();
  std::unique_ptr<MasterStream> stream_;  // null: none
};

}  // namespace handrail
