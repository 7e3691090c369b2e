#include "devices/touch/hd_api.h"

#include <array>
#include <cstdio>

#include "devices/input/loaded_library.h"
#include "server/base/plain_text.h"

namespace handrail {
namespace {

constexpr char kInstall[] =
    "install TouchDriver and OpenHaptics of 3D Systems, of versions that fit each other, or name "
    "the library in device.touch.library";

}  // namespace

Result<HdApi> load_hd(const std::string& library) {
  auto loaded = LoadedLibrary::load(library);
  if (!loaded) return Status::error("Touch: " + loaded.message() + "; " + kInstall);
  HdApi api;
  const auto take = [&](const char* name, auto& out) { loaded->take(name, out); };
  take("hdInitDevice", api.init_device);
  take("hdDisableDevice", api.disable_device);
  take("hdMakeCurrentDevice", api.make_current);
  take("hdBeginFrame", api.begin_frame);
  take("hdEndFrame", api.end_frame);
  take("hdGetError", api.get_error);
  take("hdGetErrorString", api.error_string);
  take("hdEnable", api.enable);
  take("hdDisable", api.disable);
  take("hdGetIntegerv", api.get_integer);
  take("hdGetDoublev", api.get_double);
  take("hdGetString", api.get_string);
  take("hdSetDoublev", api.set_double);
  take("hdCheckCalibration", api.check_calibration);
  take("hdUpdateCalibration", api.update_calibration);
  take("hdStartScheduler", api.start_scheduler);
  take("hdStopScheduler", api.stop_scheduler);
  take("hdSetSchedulerRate", api.set_rate);
  take("hdScheduleAsynchronous", api.schedule);
  take("hdUnschedule", api.unschedule);
  if (loaded->missing() == nullptr) return api;
  loaded->unload();
  return Status::error("Touch: " + shown(library, 200) + ": has no " + loaded->missing() +
                       ", expected libHD of OpenHaptics 3; " + kInstall);
}

// What owners of the device have reported, and what helped them.
const char* hd_hint(std::uint32_t code) noexcept {
  switch (code) {
    case kHdWarmMotors: return "let it cool down; the force comes back by itself";
    case kHdExceededForce:
    case kHdExceededImpulse:
    case kHdForceError: return "the force comes back by itself; less stiffness in the scene helps";
    case kHdExceededVelocity: return "hold it, and move it slower; the force comes back by itself";
    case kHdDeviceFault:
      return "unplug its power, wait 10 s, plug it in; see the vendor's diagnostic";
    case kHdAlreadyInitiated: return "another program has it: end that program";
    case kHdCommError: return "look at cable and power; does the vendor's diagnostic see it?";
    case kHdCommConfigError:
      return "set it up with the vendor's Touch_Setup, and give device.touch.name the name it has "
             "there; TouchDriver and OpenHaptics must be of versions that fit each other";
    case kHdTimerError:
      return "the computer is too busy, or the scheduler is not permitted: "
             "handrail doctor";
    case kHdInvalidLicense:
      return "install the licence with the vendor's tool, or take OpenHaptics' developer edition";
    case kHdInvalidOperation: return "it does not fit this device: see device.touch";
    default: return "";
  }
}

std::string hd_error_text(const HdApi& api, const HdError& error) {
  const char* const words = api.error_string(error.code);
  std::array<char, 48> numbers{};
  std::snprintf(numbers.data(), numbers.size(), " (0x%x, internal %d)", error.code, error.internal);
  return shown(words == nullptr ? "error" : words) + numbers.data();
}

}  // namespace handrail
