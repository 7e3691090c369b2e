// Whether somebody is asked for something that the arm cannot do.
#pragma once

#include <string>

#include "server/base/time.h"

namespace handrail {

// Longer than any part of a trial takes that a simulated person makes: our choice.
inline constexpr Nanos kStandstill = 60 * kSecond;

class Standstill {
 public:
  // `prompt`: what the person is asked; `held`: what holds the arm, "none" for nothing. Gives what
  // has held it all of the time for which the prompt has been the same, once after kStandstill;
  // else nothing.
  std::string see(const std::string& prompt, const std::string& held, Nanos now) {
    if (prompt != prompt_ || held != held_ || held == "none") {
      prompt_ = prompt;
      held_ = held;
      since_ = now;
      told_ = false;
    }
    if (told_ || now - since_ < kStandstill) return {};
    told_ = true;
    return held_;
  }

 private:
  std::string prompt_, held_;
  Nanos since_ = 0;
  bool told_ = false;
};

}  // namespace handrail
