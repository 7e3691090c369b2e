// The code that one person tells another to pair their computers.
#pragma once

#include <string>
#include <string_view>

#include "server/base/status.h"

namespace handrail {

// Seven digits, spoken like a telephone number. A code is good for one guess at each end of one
// pairing. Somebody who sits between the two ends and guesses at both, each of the five times that
// people may try before they ask why, has 10 guesses of 10^7: one chance in 10^6.
class PairingCode {
 public:
  static constexpr int kDigits = 7;
  static constexpr unsigned kCodes = 10'000'000;

  // A new one, each as likely, from the system's random source.
  static Result<PairingCode> make();
  // With blanks and '-' anywhere. The error says what was expected, and does not repeat the text.
  static Result<PairingCode> parse(std::string_view text);

  // "4829137".
  const std::string& digits() const noexcept { return digits_; }
  // "482-9137".
  std::string text() const { return digits_.substr(0, 3) + "-" + digits_.substr(3); }

 private:
  explicit PairingCode(std::string digits) : digits_(std::move(digits)) {}
  std::string digits_;
};

}  // namespace handrail
