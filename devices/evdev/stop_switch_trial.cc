#include "devices/evdev/stop_switch_trial.h"

#include <unistd.h>

#include <utility>

#include "devices/evdev/evdev_reader.h"

namespace handrail {
namespace {

// Our choice.
constexpr Nanos kSwitchAlone = 500 * kMillisecond;
constexpr Nanos kSwitchPatience = 15 * kSecond;

constexpr char kNothingCame[] = "nothing came in 15 s";

std::optional<int> first_down(const std::bitset<KEY_CNT>& keys) {
  for (int i = 0; i < KEY_CNT; ++i) {
    if (keys[static_cast<std::size_t>(i)]) return i;
  }
  return std::nullopt;
}

}  // namespace

StopSwitchTrial::StopSwitchTrial(const EvdevOpened& opened, const StopSwitchOptions& options)
    : opened_(opened), options_(options) {
  stream_.begin(opened_.state);
}

StopSwitchTrial::~StopSwitchTrial() {
  if (opened_.fd >= 0) ::close(opened_.fd);
}

void StopSwitchTrial::go_on(Stage to, Nanos now) {
  stage_ = to;
  began_ = now;
}

bool StopSwitchTrial::turn(Nanos now) {
  if (!std::exchange(started_, true)) began_ = now;
  if (stage_ == Stage::kOver) return false;
  if (!take_events(opened_.fd, stream_)) {
    done_.push_back({"events", Verdict::kBad, "the device is gone, or its events are lost",
                     "plug it in, and try anew"});
    stage_ = Stage::kOver;
    return false;
  }
  look(now);
  return stage_ != Stage::kOver;
}

void StopSwitchTrial::look(Nanos now) {
  const std::bitset<KEY_CNT> presses = stream_.take_presses();
  const std::bitset<KEY_CNT> down = stream_.state().keys | presses;
  const bool late = now - began_ >= kSwitchPatience;
  switch (stage_) {
    case Stage::kAlone:
      if (const auto held = first_down(down)) {
        if (!late) return;
        done_.push_back({"alone", Verdict::kBad,
                         "key " + std::to_string(*held) + " is down though nobody presses it",
                         "a switch that opens when pressed stops the arm all the time: take one "
                         "that closes"});
        return go_on(Stage::kOver, now);
      }
      if (now - began_ < kSwitchAlone) return;
      done_.push_back({"alone", Verdict::kOk, "no key is down", ""});
      return go_on(Stage::kPress, now);
    case Stage::kPress: {
      const auto pressed = first_down(down);
      if (!pressed && !late) return;
      if (!pressed) {
        done_.push_back({"press", Verdict::kNotSeen, kNothingCame,
                         "is it this device? A slave that runs has grabbed it: end that first"});
        return go_on(Stage::kOver, now);
      }
      key_ = *pressed;
      const bool expected = !options_.key || *options_.key == *pressed;
      done_.push_back(
          {"press", expected ? Verdict::kOk : Verdict::kBad,
           "key " + std::to_string(*pressed) + " went down" +
               (expected ? "" : ", expected key " + std::to_string(*options_.key)),
           expected ? ""
                    : "put key: " + std::to_string(*pressed) + " into the slave's stop_switch"});
      return go_on(Stage::kLetGo, now);
    }
    case Stage::kLetGo:
      if (stream_.state().keys.any() && !late) return;
      done_.push_back(
          {"let_go", late ? Verdict::kNotSeen : Verdict::kOk,
           late ? "it stayed down for 15 s" : "no key is down",
           late ? "a switch that latches keeps the arm stopped until it is released" : ""});
      return go_on(Stage::kOver, now);
    case Stage::kOver: return;
  }
}

std::string StopSwitchTrial::asks() const {
  switch (stage_) {
    case Stage::kAlone: return "leave the switch alone";
    case Stage::kPress: return "press the switch";
    case Stage::kLetGo: return "let go of it";
    case Stage::kOver: return {};
  }
  return {};
}

std::vector<TestItem> StopSwitchTrial::items() const { return done_; }

std::string StopSwitchTrial::block() const {
  if (!key_) return {};
  return "stop_switch { device: \"" + options_.path + "\" key: " + std::to_string(*key_) + " }";
}

}  // namespace handrail
