// Rig and slave on far, master on near, an encrypted link through the emulator between them, and an
// operator who drives.
#pragma once

#include <array>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "client/api/operator_client.h"
#include "server/base/random.h"
#include "tests/faults/lateness.h"
#include "tests/faults/link_judge.h"
#include "tests/faults/order_line.h"
#include "tests/storm/drive.h"
#include "tests/storm/sequence.h"
#include "tests/support/child.h"
#include "tests/support/temp_folder.h"

namespace handrail::faults {

using storm::Who;

struct BedOptions {
  std::uint64_t seed = 1;
  std::string network;        // as a file of the emulator's; empty: clear
  int tap_bytes = kTapBytes;  // of each packet
  bool real_time = true;      // the daemons ask for it
  int mtu = 1500;             // of both sides [bytes]
  // What stands before the program, as "env NAME=VALUE"; in these two FOLDER is the bed's own, the
  // only one beside the system's that both the programs and the row see.
  std::string master, slave;
  std::string master_config, slave_config;  // beside the usual; FOLDER as above
  // What is to be there before the programs start, in the bed's own folder.
  std::function<Status(const std::string& folder)> prepare;
  bool (*interrupted)() = nullptr;
};

// What the judges found of a bed that has ended.
struct BedVerdict {
  std::vector<std::string> violations;  // each with its time since the start
  storm::Figures limits;
  LinkVerdict link;
  WireTruth truth;
  std::string report;                               // of the emulator, as JSON
  std::optional<std::uint64_t> accepted, rejected;  // as the slave's last words have it
  std::uint64_t fresh = 0;  // states that arrived as the newest since the slave's newest start
};

// Every fault of a network's ways taken back.
inline constexpr const char* kClear =
    "both { delay_ms: 0 jitter_ms: 0 loss: 0 burst_enter: 0 burst_leave: 1 duplicate: 0 reorder: 0 "
    "reorder_by_ms: 0 replay: 0 corrupt: 0 corrupt_copies: 0 rate_kbit_s: 0 queue_ms: 1000 }";

class Bed {
 public:
  explicit Bed(const BedOptions& options);
  ~Bed();
  Bed(const Bed&) = delete;
  Bed& operator=(const Bed&) = delete;

  // Everything runs, and master and slave hear each other. The error says what does not and why.
  Status start();
  // Starts a program, or starts it again.
  Status start(Who who);
  // Until the operator's master says that it hears the slave.
  bool connected(Nanos patience);

  // An order to the emulator. The error ends the row.
  Result<std::string> emulator(const std::string& line);
  void change(const std::string& network) { (void)need(emulator("change " + network)); }
  void signal(Who who, const std::string& name);
  // A program of the row's own on a side; what it prints.
  Status run(const std::string& side, const std::string& name, const std::string& line);
  std::string printed(const std::string& side, const std::string& name) const;
  std::string printed(Who who) const;  // of its newest start

  std::optional<pb::Status> status();
  // What the operator orders, in text format; `said`: the answer's reason.
  bool order(const std::string& text, std::string* said = nullptr);
  // Resets and engages, until the arm is led; false: not within `patience`.
  bool engage(Nanos patience = 15 * kSecond);
  // What the last order to engage was answered; empty: it was done.
  const std::string& engage_said() const { return engage_said_; }
  // A program on near engages, by `line` of a shell, and holds it as long as it runs.
  bool engage_by(const std::string& name, const std::string& line);
  bool led();
  // The arm must stand from then on, until engage().
  void must_stop(Nanos at) { story_.must_stop.push_back(at); }

  // Drives at speed for so long, as long as the arm is led; `look` sees each status.
  void drive(Nanos span, const std::function<void(const pb::Status&)>& look = {});
  // Waits.
  void wait(Nanos span) const;
  // The hand goes from one end of the region to the other, as fast as it can.
  void dash();

  // Asks everybody to end, and judges. Once.
  BedVerdict finish();

  // An order or a program that failed for no fault of the network's.
  void problem(const std::string& what) { problems_.push_back(what); }
  bool over() const { return options_.interrupted != nullptr && options_.interrupted(); }
  Random& random() { return random_; }
  Nanos started() const { return start_; }
  const std::string& folder() const { return folder_.path(); }
  std::string tap() const { return folder_.path() + "/rig.tap"; }
  std::string keys(Who who) const;
  std::string config(Who who);
  // Runs the slave with another key folder from its next start on.
  void use_keys(Who who, const std::string& path) { keys_[static_cast<std::size_t>(who)] = path; }

 private:
  bool need(const Result<std::string>& done);
  Status make_keys();
  std::string name_of(Who who) const;
  std::string placed(std::string text) const;
  std::string side_of(Who who) const { return who == Who::kMaster ? "near" : "far"; }

  BedOptions options_;
  TempFolder folder_;
  Random random_;
  storm::DriveRegion region_;
  std::unique_ptr<Child> netfault_;
  OrderLine line_;
  OperatorClient client_;
  LatenessProbe probe_;
  Story story_;
  std::array<int, 3> starts_{};
  std::array<std::string, 3> keys_;
  std::vector<std::string> problems_;
  std::string engage_said_;
  bool dash_to_far_ = true;
  Nanos start_ = 0, slave_start_ = 0;
};

}  // namespace handrail::faults
