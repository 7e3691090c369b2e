// What `handrail devices` asks of a driver: what is there, whether it works, what to configure.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "server/base/status.h"
#include "server/base/time.h"

namespace handrail {

enum class Readiness : std::uint8_t {
  kReady,       // as far as can be seen without a test
  kUnfinished,  // something is there, and something is missing
  kAbsent,      // nothing is there
};

// One place at which a driver looked.
struct Sighting {
  std::string place;  // "/var/run/spnav.sock"; empty: it needs none
  Readiness readiness = Readiness::kAbsent;
  std::string fact;  // what was found, beside what was expected
  std::string next;  // what to do: mostly a line to type; empty: nothing
};

// A sighting of an error's text, "PLACE: fact; next": what stands before the last mention of the
// place is left out, as the sighting has it already.
inline Sighting sighting_of(const std::string& place, Readiness readiness,
                            const std::string& error) {
  const std::size_t at = place.empty() ? std::string::npos : error.rfind(place + ": ");
  std::string fact = at == std::string::npos ? error : error.substr(at + place.size() + 2);
  const std::size_t cut = fact.find("; ");
  const std::string next = cut == std::string::npos ? "" : fact.substr(cut + 2);
  return {place, readiness, fact.substr(0, cut), next};
}

enum class Verdict : std::uint8_t {
  kOk,
  kBad,      // seen, and wrong
  kNotSeen,  // nobody did what was asked, or nothing came of it
};

// One thing that a test looked at.
struct TestItem {
  std::string check;  // "move.right": the same in every run
  Verdict verdict = Verdict::kNotSeen;
  std::string fact;
  std::string next;  // empty: nothing
};

struct TestWishes {
  bool alone = false;  // nobody is there to push anything: only what can be seen at rest
  double force = 0.0;  // to be felt, of a device that makes any; 0: none [N]
};

// A device that is looked at for some seconds, a turn at a time. Ending one early lets go of the
// device.
class SelfTest {
 public:
  virtual ~SelfTest() = default;
  // Between two turns; 0: a turn waits by itself.
  virtual Nanos period() const { return kMillisecond; }
  // Looks once at `now`, which never goes backward. False: it has ended.
  virtual bool turn(Nanos now) = 0;
  // What the person is to do now; empty: nothing.
  virtual std::string asks() const = 0;
  // What is known so far.
  virtual std::vector<TestItem> items() const = 0;
  // The block for the daemon's file, as far as it is known.
  virtual std::string block() const = 0;
};

using StartedTest = Result<std::unique_ptr<SelfTest>>;

// A kind of device. Called from one thread; may block shortly and allocate. Nothing of it moves an
// arm.
class Driver {
 public:
  virtual ~Driver() = default;
  // For people: "SpaceMouse of 3Dconnexion".
  virtual std::string what() const = 0;
  // The daemon whose file its block belongs into: "handrail-master" or "handrail-slave".
  virtual std::string daemon() const = 0;
  // One row for each place looked at, and at least one.
  virtual std::vector<Sighting> probe() = 0;
  // Opens the device to be tested. The error says why it cannot be, and what to do.
  virtual StartedTest test(const TestWishes& wishes) = 0;
  // Opens it to find out what its block has to say. The error also tells of a driver that has
  // nothing to find out.
  virtual StartedTest calibrate() = 0;
};

}  // namespace handrail
