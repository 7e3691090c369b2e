#include "server/scene/png_io.h"

#include <png.h>

#include "server/scene/text_io.h"

namespace handrail {
namespace {

// libpng's own state of one decoding, freed whatever happens.
struct Decoder {
  png_image image{};
  Decoder() { image.version = PNG_IMAGE_VERSION; }
  ~Decoder() { png_image_free(&image); }
  Decoder(const Decoder&) = delete;
  Decoder& operator=(const Decoder&) = delete;
  Status error() const { return Status::error(std::string("bad PNG: ") + image.message); }
};

constexpr std::string_view kSignature("\x89PNG\r\n\x1a\n", 8);
constexpr std::size_t kHeaderEnd = 33;  // signature and the IHDR chunk

std::uint32_t big_endian(std::string_view bytes, std::size_t at) {
  std::uint32_t value = 0;
  for (std::size_t i = 0; i < 4; ++i) {
    value = value << 8 | static_cast<std::uint8_t>(bytes[at + i]);
  }
  return value;
}

// Size as the header states it, before libpng sees the file: its own words on size are vague.
Status check_size(std::string_view bytes) {
  if (bytes.size() < kSignature.size() || !bytes.starts_with(kSignature)) {
    return Status::error("not a PNG file");
  }
  if (bytes.size() < kHeaderEnd) return Status::error("bad PNG: ends within its header");
  const std::uint32_t width = big_endian(bytes, 16), height = big_endian(bytes, 20);
  const std::string size = std::to_string(width) + " x " + std::to_string(height) + " pixels";
  if (width == 0 || height == 0) return Status::error("bad PNG: " + size);
  if (width <= kMostImageSide && height <= kMostImageSide) return Status::ok();
  const std::string most = std::to_string(kMostImageSide);
  return Status::error(size + ", expected at most " + most + " x " + most);
}

}  // namespace

Result<RgbaImage> decode_png(std::string_view bytes) {
  if (Status status = check_size(bytes); !status) return status;
  Decoder decoder;
  png_image& image = decoder.image;
  if (png_image_begin_read_from_memory(&image, bytes.data(), bytes.size()) == 0) {
    return decoder.error();
  }
  // Else 16 bits a channel would count as linear light.
  image.flags |= PNG_IMAGE_FLAG_16BIT_sRGB;
  image.format = PNG_FORMAT_RGBA;
  RgbaImage out;
  out.width = static_cast<int>(image.width);
  out.height = static_cast<int>(image.height);
  out.rgba.resize(std::size_t{4} * image.width * image.height);
  if (png_image_finish_read(&image, nullptr, out.rgba.data(), 0, nullptr) == 0) {
    return decoder.error();
  }
  return out;
}

Result<RgbaImage> read_png(const std::string& path) {
  const Result<std::string> bytes = read_file(path, kMostPngBytes);
  if (!bytes) return bytes.status();
  Result<RgbaImage> image = decode_png(*bytes);
  if (!image) return Status::error(path + ": " + image.message());
  return image;
}

}  // namespace handrail
