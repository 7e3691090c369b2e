#include "server/painting/png_profile.h"

#include <zlib.h>

#include <cstddef>
#include <cstdint>
#include <string>

namespace handrail {
namespace {

constexpr std::size_t kSignatureSize = 8;  // bytes before the first chunk
constexpr std::size_t kChunkFrame = 12;    // length, type and checksum of a chunk
constexpr std::size_t kMostProfile = 1u << 16;
constexpr std::size_t kTagTable = 128;   // of an ICC profile: count, then 12 bytes a tag
constexpr std::uint32_t kOne = 0x10000;  // 1 as s15Fixed16

// Four bytes, the most significant first; 0 past the end.
std::uint32_t number_at(std::string_view bytes, std::size_t at) {
  if (bytes.size() < 4 || at > bytes.size() - 4) return 0;
  std::uint32_t value = 0;
  for (std::size_t i = 0; i < 4; ++i) value = value << 8 | static_cast<std::uint8_t>(bytes[at + i]);
  return value;
}

// Contents of the iCCP chunk, which stands before the pixels; empty when there is none.
std::string_view profile_chunk(std::string_view png) {
  for (std::size_t at = kSignatureSize; at + kChunkFrame <= png.size();) {
    const std::size_t length = number_at(png, at);
    const std::string_view type = png.substr(at + 4, 4);
    if (type == "IDAT" || length > png.size() - at - kChunkFrame) return {};
    if (type == "iCCP") return png.substr(at + 8, length);
    at += length + kChunkFrame;
  }
  return {};
}

// The profile itself: behind a name, a zero and a byte for the method.
std::string profile_of(std::string_view chunk) {
  const std::size_t name_end = chunk.find('\0');
  if (name_end == std::string_view::npos || name_end + 2 > chunk.size()) return {};
  const std::string_view packed = chunk.substr(name_end + 2);
  std::string profile(kMostProfile, '\0');
  uLongf size = profile.size();
  const int done = ::uncompress(reinterpret_cast<Bytef*>(profile.data()), &size,
                                reinterpret_cast<const Bytef*>(packed.data()), packed.size());
  profile.resize(done == Z_OK ? size : 0);
  return profile;
}

}  // namespace

bool has_linear_profile(std::string_view png) {
  const std::string profile = profile_of(profile_chunk(png));
  const std::uint32_t tags = number_at(profile, kTagTable);
  for (std::uint32_t i = 0; i < tags && i < 100; ++i) {
    const std::size_t tag = kTagTable + 4 + std::size_t{12} * i;
    if (profile.size() < tag + 12) return false;
    if (profile.compare(tag, 4, "rTRC") != 0) continue;
    const std::size_t curve = number_at(profile, tag + 4);
    if (profile.size() < 12 || curve > profile.size() - 12) return false;
    // A curve without points is the identity; a parametric one of type 0 is a power.
    if (profile.compare(curve, 4, "curv") == 0) return number_at(profile, curve + 8) == 0;
    return profile.compare(curve, 4, "para") == 0 && number_at(profile, curve + 8) >> 16 == 0 &&
           number_at(profile, curve + 12) == kOne;
  }
  return false;
}

}  // namespace handrail
