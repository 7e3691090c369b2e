// handrail doctor, handrail devices, and the controller's switches of handrail robot
#pragma once

#include "client/cli/command.h"

namespace handrail {

// Looks at keys, programs, link, real time and clocks, and says what is wrong and what to type.
// Reads only. kExitDone: no problem; kExitRefused: some.
ExitCode run_doctor(const Options& options, const Console& console);

// See list_devices and test_device.
ExitCode run_devices_list(const Options& options, const Console& console);
ExitCode run_devices_test(const Options& options, const Console& console);
ExitCode run_devices_calibrate(const Options& options, const Console& console);

// See run_robot_order.
ExitCode run_robot_status(const Options& options, const Console& console);
ExitCode run_robot_on(const Options& options, const Console& console);
ExitCode run_robot_off(const Options& options, const Console& console);
ExitCode run_robot_reset(const Options& options, const Console& console);

}  // namespace handrail
