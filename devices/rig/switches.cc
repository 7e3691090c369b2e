#include "devices/rig/switches.h"

#include <array>
#include <charconv>
#include <limits>

#include <spdlog/fmt/fmt.h>

namespace handrail {
namespace {

constexpr int kFirstOwn = 9200;
enum SwitchesError : int {
  kRightTaken = kFirstOwn,
  kNoRight,
  kNotAutomatic,
  kServosOff,
  kNoSuchProgram,
  kAlarmStands,
  kEmergencyStop,
  kNoSuchOrder,
  kNoSuchValue,
  kProgramRuns,
  kFirstAlarm = kFirstOwn + 20,  // and AlarmKind more
};
// Of a controller that waits in vain for real-time packets: "L6130 Network communication error".
constexpr int kNetworkAlarm = 6130;

// Who holds the right and is on another channel.
constexpr PeerId kElsewhere = std::numeric_limits<PeerId>::max();

const char* switches_words(int number) {
  switch (number) {
    case kRightTaken: return "operation right is held elsewhere";
    case kNoRight: return "no operation right";
    case kNotAutomatic: return "not in automatic mode";
    case kServosOff: return "servos are off";
    case kNoSuchProgram: return "no such program";
    case kAlarmStands: return "an alarm stands";
    case kEmergencyStop: return "emergency stop";
    case kNoSuchOrder: return "no such command";
    case kNoSuchValue: return "value out of range";
    case kProgramRuns: return "a program runs";
    case kNetworkAlarm: return "Network communication error";
    default: return nullptr;
  }
}

int alarm_number(const Controller& controller) {
  const AlarmKind kind = controller.alarm().kind;
  if (kind == AlarmKind::kNone) return 0;
  return kind == AlarmKind::kTimeOut ? kNetworkAlarm : kFirstAlarm + static_cast<int>(kind);
}

std::string refusal(int number) { return fmt::format("QeR{}", number); }

// The value after the order's name; none: it has none, or it is no number.
std::optional<int> number_in(std::string_view text) {
  int value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || end != text.data() + text.size()) return std::nullopt;
  return value;
}

}  // namespace

Switches::Switches(const SwitchesOptions& options)
    : options_(options), running_(options.on && !options.emergency_stop) {
  if (running_) servo_at_ = std::numeric_limits<Nanos>::min();
  if (options.rights_taken) right_ = kElsewhere;
}

void Switches::left(PeerId peer) noexcept {
  if (right_ == peer) right_.reset();
}

void Switches::update(Nanos now, Controller& controller) noexcept {
  alarm_ = alarm_number(controller);
  controller.serve(running_ && servo_on(now));
}

// "E1000": run, stop, alarm. Without a program the stop byte of an RV-2A said 06.
std::string Switches::status(Nanos now) const {
  const bool runs = running_ && alarm_ == 0;
  const int run = (right_ ? 0x80 : 0) | (runs ? 0x40 : 0) | (servo_on(now) ? 0x20 : 0) |
                  (options_.teach ? 0x08 : 0);
  const int stop = (runs ? 0x00 : 0x06) | (options_.emergency_stop ? 0x01 : 0);
  return fmt::format("{:02X}{:02X}{}", run, stop, alarm_);
}

std::string Switches::answer(std::string_view order, PeerId peer, Nanos now,
                             Controller& controller) {
  order = order.substr(0, order.find_first_of("\r\n"));
  update(now, controller);
  constexpr std::string_view kPlace = "1;1;";  // robot and slot
  std::string out = order.starts_with(kPlace)
                        ? carried_out(order.substr(kPlace.size()), peer, now, controller)
                        : refusal(kNoSuchOrder);
  update(now, controller);
  if (alarm_ != 0) out[2] = out[2] == 'K' ? 'k' : 'r';
  return out;
}

std::string Switches::carried_out(std::string_view order, PeerId peer, Nanos now,
                                  Controller& controller) {
  constexpr std::string_view kWords = "ERRORMES";
  if (order == "STATE") {
    return fmt::format("QoK{0};{1};{2};0;{3};1;1;;;;;;;;{0};CYC;START;1;1", options_.program,
                       running_ ? 20 : 10, options_.override_percent, status(now));
  }
  if (order == "DSTATE") return "QoK" + status(now) + ";1;1";
  if (order == "OVRD") return fmt::format("QoK{}", options_.override_percent);
  if (order.starts_with(kWords)) {
    const auto number = number_in(order.substr(kWords.size()));
    if (!number) return refusal(kNoSuchValue);
    if (const char* words = switches_words(*number)) return std::string("QoK") + words;
    const int kind = *number - kFirstAlarm;
    if (kind <= 0 || kind > static_cast<int>(AlarmKind::kTimeOut)) return "QoK";
    return std::string("QoK") + describe(static_cast<AlarmKind>(kind));
  }
  if (order == "CNTLON") {
    if (right_ && right_ != peer) return refusal(kRightTaken);
    right_ = peer;
    return "QoK";
  }
  if (order == "STOP") {
    running_ = false;
    return "QoK";
  }
  if (order == "SRVOFF") {
    running_ = false;
    servo_at_.reset();
    return "QoK";
  }
  if (order == "RSTALRM") {
    running_ = running_ && alarm_ == 0;
    controller.reset_alarm();
    return "QoK";
  }
  if (order.starts_with("OPEN=") || order == "CLOSE") return "QoK";
  return with_right(order, peer, now);
}

std::string Switches::with_right(std::string_view order, PeerId peer, Nanos now) {
  constexpr std::string_view kSpeed = "OVRD=", kRun = "RUN";
  const bool start = order.starts_with(kRun);
  if (order != "CNTLOFF" && order != "SRVON" && order != "SLOTINIT" && !start &&
      !order.starts_with(kSpeed)) {
    return refusal(kNoSuchOrder);
  }
  if (right_ != peer) return refusal(kNoRight);
  if (order == "CNTLOFF") {
    right_.reset();
    return "QoK";
  }
  if (order.starts_with(kSpeed)) {
    const auto percent = number_in(order.substr(kSpeed.size()));
    if (!percent || *percent < 1 || *percent > 100) return refusal(kNoSuchValue);
    options_.override_percent = *percent;
    return fmt::format("QoK{}", *percent);
  }
  if (options_.emergency_stop) return refusal(kEmergencyStop);
  if (alarm_ != 0) return refusal(kAlarmStands);
  if (options_.teach) return refusal(kNotAutomatic);
  if (order == "SRVON") {
    if (!servo_at_) servo_at_ = now + kServoRise;
    return "QoK";
  }
  if (running_) return refusal(kProgramRuns);
  if (order == "SLOTINIT") return "QoK";
  const std::string_view name = order.substr(kRun.size());
  if (name.substr(0, name.find(';')) != options_.program) return refusal(kNoSuchProgram);
  if (!servo_on(now)) return refusal(kServosOff);
  running_ = true;
  return "QoK";
}

}  // namespace handrail
