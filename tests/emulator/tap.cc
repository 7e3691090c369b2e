#include "tests/emulator/tap.h"

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <fstream>
#include <system_error>

namespace handrail::emulator {
namespace {

constexpr std::uint32_t kMagic = 0xa1b23c4d, kUserLink = 147;
constexpr std::size_t kBuffer = 1 << 20;               // [bytes]
constexpr std::uint32_t kLongestRecord = 1 << 16;      // [bytes]
constexpr std::size_t kFileHeader = 24, kRecord = 16;  // [bytes]

void put_number(std::uint64_t value, std::size_t bytes, std::uint8_t*& to) {
  for (std::size_t i = 0; i < bytes; ++i) *to++ = static_cast<std::uint8_t>(value >> (8 * i));
}

std::uint64_t number_at(const std::uint8_t* from, std::size_t bytes) {
  std::uint64_t out = 0;
  for (std::size_t i = bytes; i > 0; --i) out = out << 8 | from[i - 1];
  return out;
}

Status cannot_use(const std::string& path, const char* what) {
  return Status::error(path + ": cannot " + what + ": " + std::generic_category().message(errno));
}

}  // namespace

Result<Tap> Tap::open(const std::string& path, std::size_t most) {
  Tap out(path, most);
  out.file_.reset(std::fopen(path.c_str(), "wbe"));
  if (!out.file_) return cannot_use(path, "write");
  std::setvbuf(out.file_.get(), nullptr, _IOFBF, kBuffer);
  std::array<std::uint8_t, kFileHeader> header{};
  std::uint8_t* at = header.data();
  put_number(kMagic, 4, at);
  put_number(2, 2, at);  // version 2.4 of the format
  put_number(4, 2, at);
  put_number(0, 8, at);
  put_number(kLongestRecord, 4, at);
  put_number(kUserLink, 4, at);
  std::fwrite(header.data(), 1, header.size(), out.file_.get());
  return out;
}

void Tap::sent(std::span<const std::uint8_t> packet, std::uint64_t number, Nanos at) {
  put('S', packet, number, Origin::kGenuine, at);
}

void Tap::delivered(std::span<const std::uint8_t> packet, std::uint64_t number, Origin origin,
                    Nanos at) {
  put('D', packet, number, origin, at);
}

void Tap::put(char what, std::span<const std::uint8_t> packet, std::uint64_t number, Origin origin,
              Nanos at) {
  std::array<std::uint8_t, kRecord + kTapHeader> header{};
  std::uint8_t* to = header.data();
  const std::size_t whole = kTapHeader + packet.size();
  packet = packet.first(std::min(packet.size(), most_));
  const std::size_t size = kTapHeader + packet.size();
  put_number(static_cast<std::uint64_t>(at / kSecond), 4, to);
  put_number(static_cast<std::uint64_t>(at % kSecond), 4, to);
  put_number(size, 4, to);
  put_number(whole, 4, to);
  *to++ = static_cast<std::uint8_t>(what);
  *to++ = static_cast<std::uint8_t>(origin);
  put_number(0, 6, to);
  put_number(number, 8, to);
  std::fwrite(header.data(), 1, header.size(), file_.get());
  if (!packet.empty()) std::fwrite(packet.data(), 1, packet.size(), file_.get());
}

Status Tap::close() {
  std::FILE* const file = file_.release();
  const bool bad = std::ferror(file) != 0;
  if (std::fclose(file) != 0 || bad) return cannot_use(path_, "write");
  return Status::ok();
}

Status scan_tap(const std::string& path, const std::function<void(TapRecord& record)>& see) {
  std::ifstream file(path, std::ios::binary);
  std::array<std::uint8_t, kFileHeader> start{};
  if (!file) return cannot_use(path, "read");
  const auto read = [&](std::uint8_t* to, std::size_t size) {
    file.read(reinterpret_cast<char*>(to), static_cast<std::streamsize>(size));
    return static_cast<bool>(file);
  };
  if (!read(start.data(), start.size()) || number_at(start.data(), 4) != kMagic ||
      number_at(start.data() + 20, 4) != kUserLink) {
    return Status::error(path + ": not a tap of the link emulator");
  }
  std::uint64_t seen = 0;
  TapRecord record;
  std::array<std::uint8_t, kRecord + kTapHeader> header{};
  while (read(header.data(), header.size())) {
    const std::uint64_t size = number_at(header.data() + 8, 4);
    if (size < kTapHeader || size > kLongestRecord) {
      return Status::error(path + ": record " + std::to_string(seen + 1) + " has " +
                           std::to_string(size) + " bytes");
    }
    record.at = static_cast<Nanos>(number_at(header.data(), 4)) * kSecond +
                static_cast<Nanos>(number_at(header.data() + 4, 4));
    record.sent = header[kRecord] == 'S';
    record.origin = static_cast<Origin>(header[kRecord + 1]);
    record.number = number_at(header.data() + kRecord + 8, 8);
    record.packet.resize(size - kTapHeader);
    if (!read(record.packet.data(), record.packet.size())) break;
    ++seen;
    see(record);
  }
  return Status::ok();
}

Result<std::vector<TapRecord>> read_tap(const std::string& path) {
  std::vector<TapRecord> out;
  const Status read =
      scan_tap(path, [&out](TapRecord& record) { out.push_back(std::move(record)); });
  if (!read) return read;
  return out;
}

}  // namespace handrail::emulator
