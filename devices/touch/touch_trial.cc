#include "devices/touch/touch_trial.h"

#include <algorithm>
#include <array>
#include <cstdio>
#include <utility>

namespace handrail {
namespace {

constexpr Nanos kHomingPatience = 60 * kSecond;
// Measured at a Touch on USB: 977 to 1013 Hz in each second (public logs of its servo thread).
constexpr double kSlowServo = 900.0, kFastServo = 1100.0;  // [Hz]
constexpr double kServoSeen = 0.5;                         // shorter says little of a rate [s]
constexpr double kWarm = 0.9;
// Nobody holds anything still to the last bit for so long.
constexpr std::uint64_t kFrozen = 10'000;  // [ticks]

template <typename... Values>
std::string touch_text(const char* format, Values... values) {
  std::array<char, 240> text{};
  std::snprintf(text.data(), text.size(), format, values...);
  return text.data();
}

}  // namespace

TouchTrial::TouchTrial(std::unique_ptr<TouchDevice> device, const std::optional<TestWishes>& wishes,
                       std::string block)
    : own_(std::move(device)), device_(own_.get()), wishes_(wishes), block_(std::move(block)) {
  identity_ = device_->model() + ", serial number " + device_->serial() + ", driver " +
              device_->driver_version();
}

bool TouchTrial::turn(Nanos now) {
  if (!std::exchange(started_, true)) {
    began_ = now;
    first_ = tick();
  }
  bool goes_on = false;
  if (test_ != nullptr) {
    goes_on = test_->turn(now);
  } else {
    (void)device_->read(now);
    goes_on = !homed(now);
  }
  hottest_ = std::max(hottest_, tick().temperature);
  most_frozen_ = std::max(most_frozen_, tick().frozen);
  if (tick().error.code != kHdSuccess) worst_ = tick().error;
  return goes_on;
}

// True: it is homed, and that was all, or it will not be.
bool TouchTrial::homed(Nanos now) {
  if (tick().homing == TouchHoming::kDone) {
    if (!wishes_) return true;
    test_ = std::make_unique<HandTest>(std::move(own_), *wishes_, block_);
    return false;
  }
  gave_up_ = now - began_ >= kHomingPatience;
  return gave_up_;
}

std::string TouchTrial::asks() const {
  if (test_ != nullptr) return test_->asks();
  switch (tick().homing) {
    case TouchHoming::kDone: return {};
    case TouchHoming::kByItself: return "move it slowly to all sides, until it has found its place";
    case TouchHoming::kInkwell: return "put the stylus into the inkwell, all the way";
    case TouchHoming::kByHand: return "bring it to the position from which its manual homes it";
  }
  return {};
}

TestItem TouchTrial::homing() const {
  if (tick().homing == TouchHoming::kDone) return {"homing", Verdict::kOk, "it is homed", ""};
  return {"homing", gave_up_ ? Verdict::kBad : Verdict::kNotSeen, "it is not homed",
          "home it, with the vendor's diagnostic if need be: without that its place stands still"};
}

std::optional<TestItem> TouchTrial::servo() const {
  if (tick().losses != 0) {
    return TestItem{"servo", Verdict::kBad,
                    touch_text("it was lost and opened again %llu times",
                               static_cast<unsigned long long>(tick().losses)),
                    "look at cable and power, and plug it into a port of its own"};
  }
  const double seconds = to_seconds(tick().at - first_.at);
  if (!(seconds > kServoSeen)) return std::nullopt;
  const double rate = static_cast<double>(tick().ticks - first_.ticks) / seconds;
  const bool good = rate >= kSlowServo && rate <= kFastServo;
  return TestItem{
      "servo", good ? Verdict::kOk : Verdict::kBad,
      touch_text("the library's thread turns %.0f times a second, 900 to 1100 expected", rate),
      good ? "" : "grant real time (handrail doctor), and plug it into a port of its own"};
}

TestItem TouchTrial::heat() const {
  const bool warm = hottest_ >= kWarm;
  return {"heat", warm ? Verdict::kBad : Verdict::kOk,
          touch_text("its warmest motor is at %.2f of 1, where it has to rest", hottest_),
          warm ? "let it cool down" : ""};
}

TestItem TouchTrial::errors() const {
  if (worst_.code == kHdSuccess) {
    return {"errors", Verdict::kOk, "the library reports no error", ""};
  }
  return {
      "errors", Verdict::kBad,
      touch_text("the library reports 0x%x (internal %d); force let go of %llu times", worst_.code,
                 worst_.internal, static_cast<unsigned long long>(tick().force_offs)),
      hd_hint(worst_.code)};
}

// Where nothing came of moving it, and its place did not change by a bit.
bool TouchTrial::frozen(const std::vector<TestItem>& seen) const {
  return most_frozen_ >= kFrozen && std::any_of(seen.begin(), seen.end(), [](const TestItem& item) {
           return item.check.starts_with("move.") && item.verdict == Verdict::kNotSeen;
         });
}

std::vector<TestItem> TouchTrial::items() const {
  std::vector<TestItem> out = {{"device", Verdict::kOk, identity_, ""}, homing(), heat(), errors()};
  if (const auto rate = servo()) out.push_back(*rate);
  if (test_ == nullptr) return out;
  const std::vector<TestItem> more = test_->items();
  if (frozen(more)) {
    out.push_back({"frozen", Verdict::kBad, "its place did not change by a bit for 10 s",
                   "home it with the vendor's diagnostic: so reads one that lost its calibration"});
  }
  out.insert(out.end(), more.begin(), more.end());
  return out;
}

}  // namespace handrail
