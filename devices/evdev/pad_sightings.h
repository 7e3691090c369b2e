// Gamepads, joysticks and wheels as `handrail devices list` sees them.
#pragma once

#include <string>
#include <vector>

#include "devices/driver.h"
#include "devices/evdev/pad.h"

namespace handrail {

// The one of `path`, or where that is empty every one that fits.
std::vector<Sighting> pad_sightings(EvdevKernel& kernel, const std::string& path,
                                    const std::string& input_folder, const PadWish& wish);

}  // namespace handrail
