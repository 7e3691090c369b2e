// A stand-in for libcomedi and the card behind it, loaded as that is: the functions with their
// binary interface, and this structure by which a test says what the card does and sees what it was
// told.
#pragma once

#include <cstdint>
#include <map>
#include <mutex>
#include <string>
#include <vector>

namespace handrail::test {

struct StandInSubdevice {
  int type = 0;  // as in comedi.h
  int flags = 0;
  unsigned int max_data = 0xffff;
  int unit = 0;
  double min = -10.0, max = 10.0;              // of each channel's only range
  std::vector<unsigned int> values;            // of the channels
  std::map<unsigned int, double> channel_max;  // where one has another; min is its negative
};

struct ComediState {
  std::string device = "/dev/comedi0", driver = "jr3_pci", board = "jr3_pci_1";
  int open_error = 0;  // errno; then nothing opens
  int read_error = 0;  // then nothing is read
  int write_error = 0;
  bool other_has_torques = false;  // comedi_lock fails
  int setup_error = 0;             // of counters
  std::vector<StandInSubdevice> subdevices;
  int most_rate = 100'000;  // of a stream [scans/s]
  int command_error = 0;

  // What became of it.
  int open_devices = 0, opened = 0;
  int locks = 0;
  int reads = 0, writes = 0, cancels = 0;
  unsigned int counter_mode = 0;
  int armed = 0;
  unsigned int scan_period = 0;             // of the last stream [ns]
  std::vector<unsigned int> scan_channels;  // as packed
  int stream_fd = -1;                       // the test writes what the card converts
  std::vector<std::string> misuses;         // calls that libcomedi or the kernel forbid
};

struct ComediStandIn : ComediState {
  std::mutex mutex;
  void reset() {
    const std::lock_guard lock(mutex);
    static_cast<ComediState&>(*this) = ComediState();
  }
};

// As the test finds it: `comedi_stand_in` in the library.
using ComediStandInOf = ComediStandIn* (*)();

}  // namespace handrail::test
