// What is tried at a real kernel's devices.
#pragma once

#include <string>

namespace handrail::kernel {

// One line a fact, on standard output. False: it is not as expected.
bool said(bool good, const std::string& what);

// The waveforms of comedi_test through the stream of six voltages, for so long: each reading beside
// the closed form, none lost.
bool try_wave(double seconds);
// The same through the force sensor with its thread, for two seconds.
bool try_sensor();
// Two torques to the analog outputs, read back at the inputs that comedi_test connects with them.
bool try_torques();
// A gamepad and a foot switch of uinput, plugged in and unplugged so many times.
bool try_input(int times);

// A force-feedback joystick of uinput: what its motors are told, with a device that is slow, after
// a program that was killed, and plugged in and unplugged so many times.
bool try_force_stick(int times);

}  // namespace handrail::kernel
