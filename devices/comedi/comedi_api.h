// The part of libcomedi that is used, as its binary interface. Nothing of it is needed to compile
// this.
//
// Source: comedi.h and comedilib.h of libcomedi 0.11, which a test compares this with where they
// are installed.
#pragma once

#include <cstdint>
#include <string>

#include "server/base/status.h"

namespace handrail {

struct ComediHandle;  // comedi_t

struct ComediRange {  // comedi_range
  double min = 0.0, max = 0.0;
  unsigned int unit = 0;
};

struct ComediInsn {  // comedi_insn
  unsigned int insn = 0, n = 0;
  unsigned int* data = nullptr;
  unsigned int subdev = 0, chanspec = 0;
  unsigned int unused[3] = {};
};

struct ComediInsnList {  // comedi_insnlist
  unsigned int n_insns = 0;
  ComediInsn* insns = nullptr;
};

struct ComediCommand {  // comedi_cmd
  unsigned int subdev = 0, flags = 0;
  unsigned int start_src = 0, start_arg = 0;
  unsigned int scan_begin_src = 0, scan_begin_arg = 0;
  unsigned int convert_src = 0, convert_arg = 0;
  unsigned int scan_end_src = 0, scan_end_arg = 0;
  unsigned int stop_src = 0, stop_arg = 0;
  unsigned int* chanlist = nullptr;
  unsigned int chanlist_len = 0;
  unsigned short* data = nullptr;
  unsigned int data_len = 0;
};

inline constexpr unsigned int kComediInsnRead = 0x4000000, kComediInsnWrite = 0x8000001;
// Kinds of subdevices.
inline constexpr int kComediAnalogIn = 1, kComediAnalogOut = 2, kComediDigitalIn = 3,
                     kComediDigitalBoth = 5, kComediCounter = 6;
// Of a subdevice: streams what it reads; its samples have 32 bits.
inline constexpr int kComediStreams = 0x8000, kComediLongSamples = 0x10000000;
inline constexpr unsigned int kComediVolt = 0;  // a range's unit
inline constexpr unsigned int kComediWakeEachScan = 0x20;
// When something of a command happens.
inline constexpr unsigned int kComediNever = 1, kComediNow = 2, kComediTimer = 0x10,
                              kComediCount = 0x20;
// Counters of National Instruments: four counts a line, their direction by the two tracks; no gate.
inline constexpr unsigned int kComediNiX4 = 0x30000, kComediNiUpDown = 0x2000000,
                              kComediNiNoGate = 0x8000;

// How a channel is asked for: its range's number and what its voltage is measured against (0 to 3).
constexpr unsigned int comedi_channel(unsigned int channel, unsigned int range,
                                      unsigned int reference) {
  return (reference & 3u) << 24 | (range & 0xffu) << 16 | channel;
}

// The functions; none is null in one that was loaded. Where they fail, errno says why.
struct ComediApi {
  ComediHandle* (*open)(const char* file) = nullptr;
  int (*close)(ComediHandle*) = nullptr;
  int (*log_level)(int) = nullptr;
  int (*file)(ComediHandle*) = nullptr;
  const char* (*driver_name)(ComediHandle*) = nullptr;
  const char* (*board_name)(ComediHandle*) = nullptr;
  int (*subdevices)(ComediHandle*) = nullptr;
  int (*type)(ComediHandle*, unsigned int subdevice) = nullptr;
  int (*flags)(ComediHandle*, unsigned int subdevice) = nullptr;
  int (*channels)(ComediHandle*, unsigned int subdevice) = nullptr;
  unsigned int (*max_data)(ComediHandle*, unsigned int subdevice, unsigned int channel) = nullptr;
  int (*ranges)(ComediHandle*, unsigned int subdevice, unsigned int channel) = nullptr;
  ComediRange* (*range)(ComediHandle*, unsigned int subdevice, unsigned int channel,
                        unsigned int range) = nullptr;
  int (*insn_list)(ComediHandle*, ComediInsnList*) = nullptr;
  int (*command_test)(ComediHandle*, ComediCommand*) = nullptr;
  int (*command)(ComediHandle*, ComediCommand*) = nullptr;
  int (*cancel)(ComediHandle*, unsigned int subdevice) = nullptr;
  int (*lock)(ComediHandle*, unsigned int subdevice) = nullptr;
  int (*reset)(ComediHandle*, unsigned int subdevice) = nullptr;
  int (*gate)(ComediHandle*, unsigned int subdevice, unsigned int channel, unsigned int gate,
              unsigned int source) = nullptr;
  int (*counter_mode)(ComediHandle*, unsigned int subdevice, unsigned int channel,
                      unsigned int mode) = nullptr;
  int (*arm)(ComediHandle*, unsigned int subdevice, unsigned int source) = nullptr;
};

// A name that the loader knows, of Debian's package libcomedi0.
inline constexpr char kComediLibrary[] = "libcomedi.so.0";
inline constexpr char kComediDevice[] = "/dev/comedi0";

// Loads `library`, a path or a name that the loader knows. The error names the library and the
// cause, or the function that it has not, and what to do. Prints nothing.
Result<ComediApi> load_comedi(const std::string& library);

}  // namespace handrail
