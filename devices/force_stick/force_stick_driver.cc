#include "devices/force_stick/force_stick_driver.h"

#include <unistd.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <utility>

#include "devices/evdev/pad_sightings.h"
#include "server/base/clock.h"
#include "server/base/plain_text.h"
#include "server/base/units.h"

namespace handrail {
namespace {

constexpr int kTimedUploads = 300;     // two seconds at the usual rate
constexpr double kStickTiming = 10.0;  // ms that may be configured for an upload (proto/config)
constexpr char kWriteHint[] =
    "this user must be in the group input: sudo usermod -aG input $USER, then log in anew";

template <typename... Values>
std::string force_text(const char* format, Values... values) {
  std::array<char, 240> text{};
  std::snprintf(text.data(), text.size(), format, values...);
  return text.data();
}

int axes_of(const ForceStickOptions& o) { return o.axes == ForceStickAxes::kWheel ? 1 : 2; }

bool pushes(const ForceStickOptions& o) {
  return o.full[0] != 0.0 && (axes_of(o) == 1 || o.full[1] != 0.0);
}

// A field where it is not as usual.
std::string field(const char* name, double value, double usual) {
  if (std::abs(value - usual) < 1e-9) return "";
  return std::string(name) + ": " + number_text(value) + " ";
}

std::string force_stick_block(const ForceStickOptions& o) {
  const ForceStickOptions usual;
  std::string inner = o.path.empty() ? "" : "device: \"" + o.path + "\" ";
  if (o.axes == ForceStickAxes::kWheel) inner += "axes: WHEEL ";
  inner += field("reach_mm", o.reach / kMm, usual.reach / kMm);
  if (pushes(o)) {
    inner += "full_force_n: [" + number_text(o.full[0]) + ", " + number_text(o.full[1]) + "] ";
  }
  inner += field("upload_hz", 1.0 / o.upload_period, 1.0 / usual.upload_period);
  inner += field("upload_ms", 1e3 * o.most_upload, 1e3 * usual.most_upload);
  inner += field("delay_ms", 1e3 * o.delay, 1e3 * usual.delay);
  inner += field("axis_counts", o.axis_counts, usual.axis_counts);
  inner += field("mass_kg", o.mass, 0.0);
  inner += field("damping_n_s_m", o.damping, 0.0);
  inner += field("friction_n", o.friction, 0.0);
  return "device { kind: FORCE_STICK" + (inner.empty() ? "" : " force_stick { " + inner + "}") +
         " }";
}

TestItem force_item(const ForceStickOptions& o) {
  if (pushes(o)) {
    return {"force", Verdict::kOk,
            force_text("%g N is what it is said to make at full level", std::abs(o.full[0])), ""};
  }
  return {"force", Verdict::kNotSeen, "no force is configured, so it makes none",
          "device.force_stick.full_force_n: what it pushes with at full level, by a spring scale"};
}

TestItem uploads_item(const StickPushed& pushed) {
  const std::string fact = force_text(
      "%llu, %llu of them late and %llu refused; the longest %.2f ms",
      static_cast<unsigned long long>(pushed.uploads), static_cast<unsigned long long>(pushed.late),
      static_cast<unsigned long long>(pushed.refused), 1e3 * to_seconds(pushed.longest));
  if (pushed.late > 0 || pushed.refused > 0) {
    return {"uploads", Verdict::kBad, fact, "handrail devices calibrate force-stick"};
  }
  if (!pushed.there) return {"uploads", Verdict::kBad, "it may not be written to", kWriteHint};
  if (pushed.uploads == 0) return {"uploads", Verdict::kNotSeen, "none was made", "--force 1"};
  return {"uploads", Verdict::kOk, fact, ""};
}

}  // namespace

std::vector<Sighting> ForceStickDriver::probe() {
  return pad_sightings(kernel_, options_.path, options_.input_folder,
                       force_stick_wish(options_.axes));
}

StartedTest ForceStickDriver::test(const TestWishes& wishes) {
  auto device = std::make_unique<ForceStick>(options_, kernel_);
  if (const Status opened = device->open(); !opened) return opened;
  return StartedTest(std::make_unique<ForceStickTest>(std::move(device), wishes, options_));
}

StartedTest ForceStickDriver::calibrate() {
  const auto device =
      open_pad(kernel_, options_.path, options_.input_folder, force_stick_wish(options_.axes));
  if (!device) return device.status();
  return StartedTest(std::make_unique<ForceStickTiming>(*device, options_, kernel_));
}

ForceStickTest::ForceStickTest(std::unique_ptr<ForceStick> device, const TestWishes& wishes,
                               const ForceStickOptions& options)
    : device_(device.get()),
      test_(std::move(device), wishes, force_stick_block(options)),
      options_(options) {}

bool ForceStickTest::turn(Nanos now) {
  const bool goes_on = test_.turn(now);
  pushed_ = device_->pushed();
  return goes_on;
}

std::vector<TestItem> ForceStickTest::items() const {
  std::vector<TestItem> out = {force_item(options_)};
  if (pushes(options_)) out.push_back(uploads_item(pushed_));
  const std::vector<TestItem> more = test_.items();
  out.insert(out.end(), more.begin(), more.end());
  return out;
}

ForceStickTiming::ForceStickTiming(const EvdevOpened& device, const ForceStickOptions& options,
                                   EvdevKernel& kernel)
    : options_(options), device_(device), motors_(kernel) {
  may_write_ = motors_.open(device_.path.data());
  options_.axis_counts = static_cast<int>(2.0 * device_.ranges[ABS_X].half());
  for (ff_effect& effect : effects_) effect.id = -1;
}

ForceStickTiming::~ForceStickTiming() {
  for (ff_effect& effect : effects_) motors_.erase(effect);
  if (device_.fd >= 0) ::close(device_.fd);
}

// A driver may leave out what has not changed: a count in 32767 is not felt.
bool ForceStickTiming::turn(Nanos) {
  if (!may_write_ || refused_ || took_.size() >= kTimedUploads) return false;
  const Nanos began = monotonic_now();
  for (int i = 0; i < axes_of(options_); ++i) {
    ff_effect& effect = effects_[static_cast<std::size_t>(i)];
    const StickLevel level = stick_level(i, 0.0, 1.0);
    effect.type = FF_CONSTANT;
    effect.direction = level.direction;
    effect.replay.length = StickPusher::kStickForceLasts;
    effect.u.constant.level = static_cast<std::int16_t>(took_.size() % 2);
    refused_ = refused_ || !motors_.upload(effect);
  }
  if (!refused_) took_.push_back(monotonic_now() - began);
  return !refused_;
}

Nanos ForceStickTiming::longest() const {
  std::vector<Nanos> sorted = took_;
  std::sort(sorted.begin(), sorted.end());
  return sorted[(sorted.size() - 1) * 99 / 100];
}

std::vector<TestItem> ForceStickTiming::items() const {
  const std::string device(text_of(device_.path));
  if (!may_write_) {
    return {{"uploads", Verdict::kBad, device + " may not be written to", kWriteHint}};
  }
  if (refused_) {
    return {{"uploads", Verdict::kBad, device + " did not take a constant force",
             "is another program using its effects? end it, and plug the device in anew"}};
  }
  if (took_.size() < kTimedUploads) {
    return {{"uploads", Verdict::kNotSeen, "not all were made", "let it run to its end"}};
  }
  const double ms = 1e3 * to_seconds(longest());
  return {{"uploads", ms <= kStickTiming ? Verdict::kOk : Verdict::kBad,
           force_text("99 of 100 took no longer than %.2f ms, %g ms at most expected", ms,
                      kStickTiming),
           ms <= kStickTiming ? "" : "it is too slow to be pushed with"},
          force_item(options_)};
}

// In steps of half a millisecond, with one to spare.
std::string ForceStickTiming::block() const {
  ForceStickOptions found = options_;
  if (took_.size() >= kTimedUploads) {
    const double half_ms = std::ceil(2e3 * to_seconds(longest())) + 1.0;
    found.most_upload = std::min(0.5 * half_ms, kStickTiming) * 1e-3;
  }
  return force_stick_block(found);
}

}  // namespace handrail
