// handrail-kernel-trial: our drivers at a real kernel's devices. Run by tests/kernel/run in a
// virtual machine.
#include <cstdio>
#include <cstdlib>
#include <string>

#include "tests/kernel/trial.h"

namespace handrail::kernel {

bool said(bool good, const std::string& what) {
  std::printf("%s: %s\n", good ? "ok" : "FAILED", what.c_str());
  std::fflush(stdout);
  return good;
}

}  // namespace handrail::kernel

int main(int argc, char** argv) {
  using namespace handrail::kernel;
  const double seconds = argc > 1 ? std::atof(argv[1]) : 5.0;
  bool good = try_wave(seconds);
  good &= try_sensor();
  good &= try_torques();
  good &= try_input(100);
  good &= try_force_stick(100);
  return good ? 0 : 1;
}
