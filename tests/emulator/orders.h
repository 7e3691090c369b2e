// Orders to a running emulator, a line each.
#pragma once

#include <string>
#include <string_view>

#include "tests/emulator/emulator.h"

namespace handrail::emulator {

// What can be ordered, for --help.
extern const char* const kOrders;

// Carries orders out. `plan` is the network that is in force.
class Orders {
 public:
  Orders(Emulator& emulator, NetworkPlan plan) : emulator_(emulator), plan_(std::move(plan)) {}

  // One line without its end: "ok", "ok ANSWER", or "error: place: what was expected".
  std::string carry_out(const std::string& line);
  bool ended() const { return ended_; }

 private:
  Result<std::string> obey(const std::string& verb, std::string_view rest);
  Status set_network(const std::string& name);
  Status change(std::string_view text);
  Status rebind();
  Status run(std::string_view rest);
  Status signal(std::string_view rest);
  Status inject(std::string_view rest);
  Status flood(std::string_view rest);
  Status replay(std::string_view rest, bool reflected);

  Emulator& emulator_;
  NetworkPlan plan_;
  bool ended_ = false;
};

}  // namespace handrail::emulator
