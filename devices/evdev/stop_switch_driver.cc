#include "devices/evdev/stop_switch_driver.h"

#include <unistd.h>

#include <algorithm>
#include <filesystem>
#include <memory>

#include "devices/evdev/stop_switch_trial.h"
#include "server/base/plain_text.h"

namespace handrail {
namespace {

namespace fs = std::filesystem;

// How udev ends the names of what has keys of a keyboard (systemd, 60-persistent-input.rules); foot
// switches are such.
constexpr char kKeyboardEnding[] = "-event-kbd";

std::vector<std::string> names_in(const fs::path& folder) {
  std::vector<std::string> out;
  std::error_code error;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder, error)) {
    out.push_back(entry.path().string());
  }
  std::sort(out.begin(), out.end());
  return out;
}

}  // namespace

// By the names that stay the same, where there are any.
std::vector<std::string> StopSwitchDriver::candidates() const {
  if (!options_.path.empty()) return {options_.path};
  std::vector<std::string> out = names_in(fs::path(input_folder_) / "by-id");
  std::erase_if(out, [](const std::string& name) { return !name.ends_with(kKeyboardEnding); });
  if (!out.empty()) return out;
  out = names_in(input_folder_);
  std::erase_if(out, [](const std::string& name) {
    return !fs::path(name).filename().string().starts_with("event");
  });
  return out;
}

Sighting StopSwitchDriver::look_at(const std::string& path) const {
  const auto opened = open_evdev(kernel_, path, EvdevUse::kShare);
  if (!opened) {
    const bool there = fs::exists(fs::symlink_status(path));
    return sighting_of(path, there ? Readiness::kUnfinished : Readiness::kAbsent, opened.message());
  }
  ::close(opened->fd);
  const std::string name(text_of(opened->name));
  if (options_.key && !opened->has_key[static_cast<std::size_t>(*options_.key)]) {
    return {path, Readiness::kUnfinished,
            name + " has no key " + std::to_string(*options_.key) + ", which is configured",
            "handrail devices calibrate stop-switch"};
  }
  const std::size_t keys = opened->has_key.count();
  if (keys == 0) return {path, Readiness::kAbsent, name + " has no key", ""};
  return {path, Readiness::kReady,
          name + " has " + std::to_string(keys) + (keys == 1 ? " key" : " keys"), ""};
}

std::vector<Sighting> StopSwitchDriver::probe() {
  std::vector<Sighting> out;
  for (const std::string& path : candidates()) {
    Sighting seen = look_at(path);
    if (seen.readiness != Readiness::kAbsent || !options_.path.empty()) out.push_back(seen);
  }
  if (out.empty()) {
    out.push_back({input_folder_, Readiness::kAbsent, "no device with keys among those there",
                   "plug a foot switch in"});
  }
  return out;
}

// The configured one, or the only one.
Result<std::string> StopSwitchDriver::one_path() const {
  const std::vector<std::string> all = candidates();
  if (all.size() == 1) return all.front();
  if (all.empty()) {
    return Status::error("stop switch: no input device in " + input_folder_ +
                         "; plug it in: handrail devices list");
  }
  return Status::error("stop switch: " + std::to_string(all.size()) +
                       " devices may be meant; say which: --device " + joined(all, " or "));
}

StartedTest StopSwitchDriver::test(const TestWishes& wishes) {
  const auto path = one_path();
  if (!path) return path.status();
  if (wishes.alone) {
    return Status::error("stop switch: somebody has to press it; leave out --alone");
  }
  const auto opened = open_evdev(kernel_, *path, EvdevUse::kShare);
  if (!opened) return opened.status();
  StopSwitchOptions options = options_;
  options.path = *path;
  return StartedTest(std::make_unique<StopSwitchTrial>(*opened, options));
}

StartedTest StopSwitchDriver::calibrate() {
  StopSwitchDriver any_key({options_.path, std::nullopt}, input_folder_, kernel_);
  return any_key.test({});
}

}  // namespace handrail
