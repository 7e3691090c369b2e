// Blocking client of a master, on this computer or another.
//
// Wire: each message is a u32 length, little-endian, and that many bytes of protobuf, at most 64
// KiB; one Reply for each Request, in order.
#pragma once

#include <memory>
#include <string>

#include "client/api/master_place.h"
#include "proto/operator.pb.h"
#include "server/base/status.h"
#include "server/base/time.h"

namespace handrail {

// What the command line returns to the shell.
enum ExitCode : int {
  kExitDone = 0,
  kExitRefused = 1,
  kExitUsage = 2,
  kExitNoMaster = 3,
  kExitInterrupted = 130,
};

// How the error ends where nobody serves the socket.
inline constexpr char kStartMaster[] = "start handrail-master";

class MasterStream;

// One connection; not thread-safe. After a failed call the connection is closed, and the next call
// opens a new one.
class OperatorClient {
 public:
  // `as`: who speaks, in requests that do not say; empty: the user the master runs as, or over the
  // network who the key says.
  // `cancelled`: asked every 50 ms while a call waits; where it says so, the call fails at once.
  explicit OperatorClient(MasterPlace place, std::string as = {}, bool (*cancelled)() = nullptr);
  ~OperatorClient();
  OperatorClient(const OperatorClient&) = delete;
  OperatorClient& operator=(const OperatorClient&) = delete;

  // Sends the order and waits for its reply, at most `patience` in all. An error means that there
  // is no master or none that answers, and names its place and the cause; a refusal is a Reply with
  // done false.
  Result<pb::Reply> call(const pb::Request& order, Nanos patience);

  void close() noexcept;

 private:
  Result<pb::Reply> exchange(const pb::Request& order, Nanos deadline);
  Status failure(const std::string& what) const;

  MasterPlace place_;
  std::string as_;
  bool (*cancelled_)();
  bool with_next_key_ = true;
  std::unique_ptr<MasterStream> stream_;  // null: none
};

// Done, refused or no master.
ExitCode exit_code(const Result<pb::Reply>& reply);

}  // namespace handrail
