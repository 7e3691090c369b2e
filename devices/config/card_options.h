// Devices at a card, as a configuration has them.
#pragma once

#include "devices/comedi/ft_source.h"
#include "devices/comedi/joystick_card.h"
#include "proto/config.pb.h"

namespace handrail {

ComediJoystickOptions joystick_options(const pb::JoystickConfig& config);
FtMount mount_of(const pb::FtMountConfig& config);

}  // namespace handrail
