#include "devices/comedi/comedi_card.h"

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <utility>

#include "server/base/plain_text.h"

namespace handrail {
namespace {

const char* comedi_kind(int type) {
  switch (type) {
    case kComediAnalogIn: return "analog inputs";
    case kComediAnalogOut: return "analog outputs";
    case kComediDigitalIn: return "digital inputs";
    case kComediDigitalBoth: return "digital inputs and outputs";
    case kComediCounter: return "counters";
    default: return "something else";
  }
}

Status device_error(const std::string& device, const std::string& fact) {
  return Status::error("comedi: " + device + ": " + fact);
}

}  // namespace

std::string comedi_hint(int error) {
  switch (error) {
    case ENOENT:
      return "is the card there, and its driver loaded? sudo modprobe jr3_pci for one of JR3; ls "
             "/dev/comedi*";
    case EACCES:
    case EPERM:
      // The group that Debian's libcomedi0 gives the devices to.
      return "sudo usermod -aG iocard $USER, then log in anew";
    case ENODEV:
    case ENXIO: return "no card is attached to it: sudo dmesg | grep comedi";
    case EBUSY: return "another program uses it: end that program";
    case ENOTTY:
    case EINVAL: return "expected a device of comedi, such as /dev/comedi0";
    default: return {};
  }
}

ComediCard::ComediCard(const ComediApi& api, ComediHandle* handle, std::string device)
    : api_(&api), handle_(handle), device_(std::move(device)) {
  const char* const driver = api_->driver_name(handle_);
  const char* const board = api_->board_name(handle_);
  driver_ = driver == nullptr ? "" : shown(driver);
  board_ = board == nullptr ? "" : shown(board);
}

ComediCard::ComediCard(ComediCard&& other) noexcept
    : api_(other.api_),
      handle_(std::exchange(other.handle_, nullptr)),
      device_(std::move(other.device_)),
      driver_(std::move(other.driver_)),
      board_(std::move(other.board_)) {}

ComediCard& ComediCard::operator=(ComediCard&& other) noexcept {
  std::swap(api_, other.api_);
  std::swap(handle_, other.handle_);
  std::swap(device_, other.device_);
  std::swap(driver_, other.driver_);
  std::swap(board_, other.board_);
  return *this;
}

ComediCard::~ComediCard() {
  if (handle_ != nullptr) api_->close(handle_);
}

Result<ComediCard> ComediCard::open(const ComediApi& api, const ComediPlace& place) {
  const std::string device = shown(place.device, 200);
  ComediHandle* const handle = api.open(place.device.c_str());
  if (handle == nullptr) {
    const int error = errno;
    const std::string hint = comedi_hint(error);
    return device_error(device, std::string("cannot be opened: ") + std::strerror(error) +
                                    (hint.empty() ? "" : "; " + hint));
  }
  ComediCard card(api, handle, device);
  if (place.board.empty() || place.board == card.board_) return card;
  return card.error("is '" + card.board_ + "', driven by " + card.driver_ + ", expected '" +
                    shown(place.board) +
                    "'; another card may have come before it: ls /dev/comedi*");
}

Status ComediCard::error(const std::string& fact) const { return device_error(device_, fact); }

Result<unsigned int> ComediCard::subdevice(const char* what, std::optional<unsigned int> wanted,
                                           std::span<const int> kinds) const {
  const auto fits = [&](unsigned int i) {
    return std::find(kinds.begin(), kinds.end(), api_->type(handle_, i)) != kinds.end();
  };
  const int count = std::max(0, api_->subdevices(handle_));
  const std::string card = board_ + ", driven by " + driver_;
  if (wanted) {
    if (*wanted < static_cast<unsigned int>(count) && fits(*wanted)) return *wanted;
    const std::string is = *wanted < static_cast<unsigned int>(count)
                               ? "has " + std::string(comedi_kind(api_->type(handle_, *wanted)))
                               : "is not there, the last is " + std::to_string(count - 1);
    return error(std::string(what) + ": subdevice " + std::to_string(*wanted) + " of " + card +
                 " " + is + ", expected " + comedi_kind(kinds[0]) +
                 "; comedi_board_info shows them");
  }
  for (unsigned int i = 0; i < static_cast<unsigned int>(count); ++i) {
    if (fits(i)) return i;
  }
  return error(std::string(what) + ": " + card + " has no " + comedi_kind(kinds[0]) +
               "; comedi_board_info shows what it has");
}

Result<ComediRange> ComediCard::range(const ComediChannel& c) const {
  const std::string where = "subdevice " + std::to_string(c.subdevice);
  const int channels = api_->channels(handle_, c.subdevice);
  if (static_cast<int>(c.channel) >= channels) {
    return error(where + " has no channel " + std::to_string(c.channel) + ", the last is " +
                 std::to_string(channels - 1) + "; comedi_board_info shows them");
  }
  const int ranges = api_->ranges(handle_, c.subdevice, c.channel);
  const ComediRange* const found = static_cast<int>(c.range) < ranges
                                       ? api_->range(handle_, c.subdevice, c.channel, c.range)
                                       : nullptr;
  if (found != nullptr && max_data(c) > 0 && found->max > found->min) return *found;
  return error(where + ", channel " + std::to_string(c.channel) + " has no range " +
               std::to_string(c.range) + " that means anything; comedi_board_info shows them");
}

int ComediCard::transfer(unsigned int insn, std::span<const ComediChannel> channels,
                         std::span<unsigned int> values) noexcept {
  std::array<ComediInsn, kMostComediChannels> insns;
  const std::size_t count = std::min(channels.size(), insns.size());
  for (std::size_t i = 0; i < count; ++i) {
    insns[i].insn = insn;
    insns[i].n = 1;
    insns[i].data = &values[i];
    insns[i].subdev = channels[i].subdevice;
    insns[i].chanspec = channels[i].spec();
  }
  ComediInsnList list;
  list.n_insns = static_cast<unsigned int>(count);
  list.insns = insns.data();
  errno = 0;
  // It answers how many were done: an error after the first is not its own answer.
  const int done = api_->insn_list(handle_, &list);
  if (done == static_cast<int>(count)) return 0;
  return done < 0 && errno != 0 ? errno : EAGAIN;
}

int ComediCard::read(std::span<const ComediChannel> channels,
                     std::span<unsigned int> out) noexcept {
  return transfer(kComediInsnRead, channels, out);
}

int ComediCard::write(std::span<const ComediChannel> channels,
                      std::span<const unsigned int> values) noexcept {
  std::array<unsigned int, kMostComediChannels> copy{};
  std::copy(values.begin(), values.end(), copy.begin());
  return transfer(kComediInsnWrite, channels, std::span(copy).first(values.size()));
}

}  // namespace handrail
