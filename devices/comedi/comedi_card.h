// A card that comedi drives, opened.
#pragma once

#include <array>
#include <optional>
#include <span>
#include <string>

#include "devices/comedi/comedi_api.h"
#include "server/base/status.h"

namespace handrail {

struct ComediPlace {
  std::string device = kComediDevice;
  std::string library = kComediLibrary;
  std::string board;  // as its driver calls it; empty: any
};

// One channel of a card.
struct ComediChannel {
  unsigned int subdevice = 0;
  unsigned int channel = 0;
  unsigned int range = 0;      // number of the card's range
  unsigned int reference = 0;  // 0 ground, 1 common, 2 differential

  unsigned int spec() const { return comedi_channel(channel, range, reference); }
};

inline constexpr std::size_t kMostComediChannels = 8;  // in one call

// Opening and asking block and may allocate; reading and writing are one call of the kernel. Used
// from one thread at a time.
class ComediCard {
 public:
  // Errors are "comedi: DEVICE: what is wrong; what to do".
  static Result<ComediCard> open(const ComediApi& api, const ComediPlace& place);
  ComediCard(ComediCard&& other) noexcept;
  ComediCard& operator=(ComediCard&& other) noexcept;
  ~ComediCard();

  const std::string& driver() const { return driver_; }
  const std::string& board() const { return board_; }
  const ComediApi& api() const { return *api_; }
  ComediHandle* handle() const { return handle_; }

  // The subdevice `wanted`, or, without, the first of a kind of `kinds`. The error names both.
  Result<unsigned int> subdevice(const char* what, std::optional<unsigned int> wanted,
                                 std::span<const int> kinds) const;
  // That there is such a channel, and such a range, which is what it gives.
  Result<ComediRange> range(const ComediChannel& channel) const;
  unsigned int max_data(const ComediChannel& c) const {
    return api_->max_data(handle_, c.subdevice, c.channel);
  }
  bool streams(unsigned int subdevice) const {
    return (api_->flags(handle_, subdevice) & kComediStreams) != 0;
  }

  // All of them, at most kMostComediChannels, in their order. 0, or errno. Real-time safe as far as
  // the card's driver is.
  int read(std::span<const ComediChannel> channels, std::span<unsigned int> out) noexcept;
  int write(std::span<const ComediChannel> channels, std::span<const unsigned int> values) noexcept;

  // "comedi: DEVICE: FACT".
  Status error(const std::string& fact) const;

 private:
  ComediCard(const ComediApi& api, ComediHandle* handle, std::string device);
  int transfer(unsigned int insn, std::span<const ComediChannel> channels,
               std::span<unsigned int> values) noexcept;

  const ComediApi* api_;
  ComediHandle* handle_;
  std::string device_, driver_, board_;
};

// What a person can do about an error of a device's; empty: nothing is known.
std::string comedi_hint(int error);

}  // namespace handrail
