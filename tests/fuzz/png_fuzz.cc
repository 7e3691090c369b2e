// PNG files of painted walls: as they are, and with their chunks' checksums made right.
#include <zlib.h>

#include <string>

#include "tests/fuzz/fuzz_target.h"
#include "tests/support/png_sample.h"
#include "tests/support/png_whole.h"

namespace handrail {
namespace {

constexpr std::size_t kSignature = 8;

std::uint32_t checksum(const std::string& png, std::size_t from, std::size_t size) {
  const auto* data = reinterpret_cast<const Bytef*>(png.data() + from);
  return static_cast<std::uint32_t>(::crc32(0, data, static_cast<uInt>(size)));
}

// Larger images, up to 8000 x 8000, take as much longer and try nothing else. Nearly all of a
// fuzzer's time goes by the pixel, so that one of its inputs in sixty-four may have so many, the
// others eleven rows of eleven: five by five are looked at around a pixel, and up to seventeen by
// seventeen where three colours meet.
std::uint64_t most_pixels(const std::string& png) {
#ifdef HANDRAIL_FUZZER
  // By a checksum: what may be large is not passed on to what is made of it.
  if (checksum(png, 0, png.size()) % 64 != 0) return 1 << 7;
#else
  (void)png;
#endif
  return 1 << 14;
}

std::uint32_t number_at(const std::string& png, std::size_t at) {
  std::uint32_t out = 0;
  for (std::size_t i = at; i < at + 4; ++i) out = out << 8 | static_cast<std::uint8_t>(png[i]);
  return out;
}

// A size that is allowed, and would take long.
bool is_large(const std::string& png) {
  if (png.size() < kSignature + 16) return false;
  const std::uint64_t width = number_at(png, kSignature + 8), height = number_at(png, 20);
  return width <= static_cast<std::uint64_t>(kMostImageSide) &&
         height <= static_cast<std::uint64_t>(kMostImageSide) && width * height > most_pixels(png);
}

std::string with_right_checksums(std::string png) {
  for (std::size_t at = kSignature; at + 12 <= png.size();) {
    const std::size_t length = number_at(png, at);
    if (length > png.size() - at - 12) break;
    png.replace(at + 8 + length, 4, test::big_endian(checksum(png, at + 4, length + 4)));
    at += length + 12;
  }
  return png;
}

}  // namespace

HANDRAIL_FUZZ(png) {
  const std::string file(fuzz::text_of(bytes));
  if (is_large(file)) return;
  bool read = false;
  std::string fault = test::fault_with_png(file, read);
  fuzz::require(fault.empty(), fault);
  if (read) return;
  fault = test::fault_with_png(with_right_checksums(file), read);
  fuzz::require(fault.empty(), fault);
}

}  // namespace handrail
