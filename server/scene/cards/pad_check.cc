#include "server/scene/cards/pad_check.h"

#include <string>

#include "server/base/plain_text.h"

namespace handrail {
namespace {

using PadProblem = std::optional<FieldProblem>;

// One of another kind would be read by nobody.
template <typename Config>
PadProblem check_pad(const Config& pad, bool given, bool used, const std::string& block,
                     const char* kind) {
  if (given && !used) return FieldProblem{block, "only used with kind: " + std::string(kind)};
  if (!pad.has_device() || pad.device().starts_with("/")) return std::nullopt;
  return FieldProblem{block + ".device", "'" + shown(pad.device()) +
                                             "', expected the path of an input device, from / on"};
}

// Motors at one of two axes are those of a wheel.
PadProblem check_full_force(const pb::ForceStickConfig& c) {
  if (c.full_force_n_size() < 2 || c.axes() == pb::ForceStickConfig::WHEEL) return std::nullopt;
  if ((c.full_force_n(0) == 0.0) == (c.full_force_n(1) == 0.0)) return std::nullopt;
  return FieldProblem{"device.force_stick.full_force_n",
                      "0 for one of two axes, expected both, none, or axes: WHEEL"};
}

}  // namespace

std::optional<FieldProblem> check_pads(const pb::DeviceConfig& c) {
  if (PadProblem p = check_pad(c.gamepad(), c.has_gamepad(), c.kind() == pb::DeviceConfig::GAMEPAD,
                               "device.gamepad", "GAMEPAD")) {
    return p;
  }
  if (PadProblem p =
          check_pad(c.force_stick(), c.has_force_stick(), c.kind() == pb::DeviceConfig::FORCE_STICK,
                    "device.force_stick", "FORCE_STICK")) {
    return p;
  }
  return check_full_force(c.force_stick());
}

}  // namespace handrail
