#include "tests/support/comedi/comedi_stand_in.h"

#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>

namespace {

using handrail::test::ComediStandIn;
using handrail::test::StandInSubdevice;
using Lock = std::lock_guard<std::mutex>;

ComediStandIn& self() {
  static ComediStandIn state;
  return state;
}

struct Range {
  double min, max;
  unsigned int unit;
};

// comedi_t: libcomedi asks for the ranges as it opens the device, and tells those from then on.
struct Handle {
  int fd = -1, other = -1;  // a stream's two ends
  std::vector<std::vector<Range>> ranges;
  bool locked = false, streams = false;
};

struct Insn {
  unsigned int insn, n;
  unsigned int* data;
  unsigned int subdev, chanspec, unused[3];
};
struct InsnList {
  unsigned int n_insns;
  Insn* insns;
};
struct Command {
  unsigned int subdev, flags, start_src, start_arg, scan_begin_src, scan_begin_arg, convert_src,
      convert_arg, scan_end_src, scan_end_arg, stop_src, stop_arg;
  unsigned int* chanlist;
  unsigned int chanlist_len;
  short* data;
  unsigned int data_len;
};

int fails(int error) {
  errno = error;
  return -1;
}
void misuse(const std::string& what) { self().misuses.push_back(what); }

// With the mutex held; null: there is none.
StandInSubdevice* subdevice_at(unsigned int i) {
  return i < self().subdevices.size() ? &self().subdevices[i] : nullptr;
}

int transfer(Handle& h, Insn& insn) {
  ComediStandIn& s = self();
  StandInSubdevice* const sub = subdevice_at(insn.subdev);
  const unsigned int channel = insn.chanspec & 0xffff;
  if (sub == nullptr || channel >= sub->values.size() || insn.n != 1) return EINVAL;
  if (insn.insn == 0x4000000) {
    if (s.read_error != 0) return s.read_error;
    *insn.data = sub->values[channel];
    return 0;
  }
  if (insn.insn != 0x8000001) return EINVAL;
  if (s.write_error != 0) return s.write_error;
  if (*insn.data > sub->max_data) return EINVAL;
  if (!h.locked) misuse("written without the lock");
  sub->values[channel] = *insn.data;
  return 0;
}

}  // namespace

extern "C" {

ComediStandIn* comedi_stand_in() { return &self(); }

Handle* comedi_open(const char* file) {
  ComediStandIn& s = self();
  const Lock lock(s.mutex);
  ++s.opened;
  if (s.open_error != 0 || s.device != file) {
    errno = s.open_error != 0 ? s.open_error : ENOENT;
    return nullptr;
  }
  auto* const h = new Handle;
  for (const StandInSubdevice& sub : s.subdevices) {
    std::vector<Range> ranges;
    for (unsigned int i = 0; i < sub.values.size(); ++i) {
      const auto own = sub.channel_max.find(i);
      const double max = own == sub.channel_max.end() ? sub.max : own->second;
      ranges.push_back({own == sub.channel_max.end() ? sub.min : -max, max,
                        static_cast<unsigned int>(sub.unit)});
    }
    h->ranges.push_back(ranges);
  }
  ++s.open_devices;
  return h;
}

int comedi_close(Handle* h) {
  ComediStandIn& s = self();
  const Lock lock(s.mutex);
  --s.open_devices;
  if (h->locked) --s.locks;
  if (h->fd >= 0) ::close(h->fd);
  if (h->other >= 0) ::close(h->other);
  if (h->streams) s.stream_fd = -1;
  delete h;
  return 0;
}

int comedi_loglevel(int) { return 1; }
int comedi_fileno(Handle* h) { return h->fd; }
const char* comedi_get_driver_name(Handle*) {
  const Lock lock(self().mutex);
  return self().driver.c_str();
}
const char* comedi_get_board_name(Handle*) {
  const Lock lock(self().mutex);
  return self().board.c_str();
}
int comedi_get_n_subdevices(Handle* h) { return static_cast<int>(h->ranges.size()); }

int comedi_get_subdevice_type(Handle*, unsigned int i) {
  const Lock lock(self().mutex);
  const StandInSubdevice* const sub = subdevice_at(i);
  return sub == nullptr ? fails(EINVAL) : sub->type;
}
int comedi_get_subdevice_flags(Handle*, unsigned int i) {
  const Lock lock(self().mutex);
  const StandInSubdevice* const sub = subdevice_at(i);
  return sub == nullptr ? fails(EINVAL) : sub->flags;
}
int comedi_get_n_channels(Handle*, unsigned int i) {
  const Lock lock(self().mutex);
  const StandInSubdevice* const sub = subdevice_at(i);
  return sub == nullptr ? fails(EINVAL) : static_cast<int>(sub->values.size());
}
unsigned int comedi_get_maxdata(Handle*, unsigned int i, unsigned int channel) {
  const Lock lock(self().mutex);
  const StandInSubdevice* const sub = subdevice_at(i);
  return sub == nullptr || channel >= sub->values.size() ? 0 : sub->max_data;
}
int comedi_get_n_ranges(Handle* h, unsigned int i, unsigned int channel) {
  return i < h->ranges.size() && channel < h->ranges[i].size() ? 1 : fails(EINVAL);
}
Range* comedi_get_range(Handle* h, unsigned int i, unsigned int channel, unsigned int range) {
  const bool there = i < h->ranges.size() && channel < h->ranges[i].size() && range == 0;
  return there ? &h->ranges[i][channel] : nullptr;
}

int comedi_do_insnlist(Handle* h, InsnList* list) {
  ComediStandIn& s = self();
  const Lock lock(s.mutex);
  bool writes = false;
  for (unsigned int i = 0; i < list->n_insns; ++i) {
    const int error = transfer(*h, list->insns[i]);
    writes = list->insns[i].insn == 0x8000001;
    if (error != 0) return fails(error);
  }
  ++(writes ? s.writes : s.reads);
  return static_cast<int>(list->n_insns);
}

// Mends a step at a time, as the kernel's driver comedi_test does: 3 for values that are out of
// reach.
int comedi_command_test(Handle*, Command* c) {
  ComediStandIn& s = self();
  const Lock lock(s.mutex);
  const auto least = static_cast<unsigned int>(1'000'000'000 / s.most_rate);
  if (c->scan_begin_arg < least) {
    c->scan_begin_arg = least;
    return 3;
  }
  if (c->convert_src == 0x10 && c->convert_arg * c->chanlist_len > c->scan_begin_arg) {
    c->convert_arg = c->scan_begin_arg / c->chanlist_len;
    return 4;
  }
  return 0;
}

int comedi_command(Handle* h, Command* c) {
  ComediStandIn& s = self();
  const Lock lock(s.mutex);
  if (s.command_error != 0) return fails(s.command_error);
  if (c->start_src != 2 || c->scan_begin_src != 0x10 || c->scan_end_src != 0x20 ||
      c->scan_end_arg != c->chanlist_len || c->stop_src != 1) {
    misuse("a command that is none");
  }
  int ends[2] = {-1, -1};
  if (::socketpair(AF_UNIX, SOCK_STREAM, 0, ends) != 0) return -1;
  h->fd = ends[0];
  h->other = s.stream_fd = ends[1];
  h->streams = true;
  s.scan_period = c->scan_begin_arg;
  s.scan_channels.assign(c->chanlist, c->chanlist + c->chanlist_len);
  return 0;
}

int comedi_cancel(Handle*, unsigned int) {
  const Lock lock(self().mutex);
  ++self().cancels;
  return 0;
}

int comedi_lock(Handle* h, unsigned int) {
  ComediStandIn& s = self();
  const Lock lock(s.mutex);
  if (s.other_has_torques || (s.locks > 0 && !h->locked)) return fails(EBUSY);
  if (!h->locked) ++s.locks;
  h->locked = true;
  return 0;
}

int comedi_reset(Handle*, unsigned int) {
  const Lock lock(self().mutex);
  return self().setup_error != 0 ? fails(self().setup_error) : 0;
}
int comedi_set_gate_source(Handle*, unsigned int, unsigned int, unsigned int, unsigned int source) {
  const Lock lock(self().mutex);
  if (source != 0x8000) misuse("a gate for an encoder");
  return 0;
}
int comedi_set_counter_mode(Handle*, unsigned int, unsigned int, unsigned int mode) {
  const Lock lock(self().mutex);
  self().counter_mode = mode;
  return 0;
}
int comedi_arm(Handle*, unsigned int, unsigned int) {
  const Lock lock(self().mutex);
  ++self().armed;
  return 0;
}

}  // extern "C"
