// What happened at one side's end of the wire, packet by packet, in a file that pcap readers open.
#pragma once

#include <cstdint>
#include <cstdio>
#include <functional>
#include <limits>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "server/base/status.h"
#include "server/lab/network/link_way.h"

namespace handrail::emulator {

// A pcap file (magic 0xa1b23c4d: nanoseconds, of the monotonic clock) of link type 147, which is
// for users. Each packet is preceded by kTapHeader bytes: 'S' sent by this side or 'D' delivered to
// it; origin as in Origin; six bytes 0; number in its direction, 8 bytes, least first, 0 where it
// went nowhere or is somebody else's. A packet that is sent is the side's own, before its edge.
inline constexpr std::size_t kTapHeader = 16;

struct TapRecord {
  Nanos at = 0;
  bool sent = false;  // else delivered
  Origin origin = Origin::kGenuine;
  std::uint64_t number = 0;
  std::vector<std::uint8_t> packet;  // its beginning, where the tap keeps no more
};

// Not real-time safe: the disk may hold the writer up.
class Tap {
 public:
  // `most`: bytes of each packet that are kept; the pcap has how long it was.
  static Result<Tap> open(const std::string& path,
                          std::size_t most = std::numeric_limits<std::size_t>::max());

  void sent(std::span<const std::uint8_t> packet, std::uint64_t number, Nanos at);
  void delivered(std::span<const std::uint8_t> packet, std::uint64_t number, Origin origin,
                 Nanos at);
  // Readers see everything so far.
  void flush() { std::fflush(file_.get()); }
  // Everything is in the file; an error where the disk did not take it.
  Status close();

 private:
  struct Closes {
    void operator()(std::FILE* file) const { std::fclose(file); }
  };
  Tap(std::string path, std::size_t most) : path_(std::move(path)), most_(most) {}
  void put(char what, std::span<const std::uint8_t> packet, std::uint64_t number, Origin origin,
           Nanos at);

  std::string path_;
  std::size_t most_;
  std::unique_ptr<std::FILE, Closes> file_;
};

// Each record of a tap's file in turn. One that ends in the middle of a record, as after a kill or
// while it is written, gives those before it.
Status scan_tap(const std::string& path, const std::function<void(TapRecord& record)>& see);
// All of them.
Result<std::vector<TapRecord>> read_tap(const std::string& path);

}  // namespace handrail::emulator
