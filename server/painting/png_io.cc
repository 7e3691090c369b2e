#include "server/painting/png_io.h"

#include <png.h>

#include <array>
#include <cmath>
#include <csetjmp>
#include <cstddef>
#include <cstdio>
#include <cstring>
#include <memory>
#include <utility>

#include "server/base/read_file.h"
#include "server/painting/colour.h"
#include "server/painting/png_profile.h"

namespace handrail {
namespace {

// Values of the file, as 16 bits, to coded sRGB as 8.
using Encoding = std::array<std::uint8_t, 65536>;

// The state of one decoding; libpng's is freed whatever happens.
struct Decoder {
  explicit Decoder(std::string_view file) : bytes(file) {}
  ~Decoder() { png_destroy_read_struct(&png, &info, nullptr); }
  Decoder(const Decoder&) = delete;
  Decoder& operator=(const Decoder&) = delete;

  std::string_view bytes;
  std::size_t at = 0;
  png_structp png = nullptr;
  png_infop info = nullptr;
  std::string why;
  RgbaImage image;
  std::vector<png_bytep> rows;
  std::unique_ptr<Encoding> encoding;  // null: 8 bits, as they are
};

Decoder& decoder_of(void* pointer) { return *static_cast<Decoder*>(pointer); }

[[noreturn]] void on_error(png_structp png, png_const_charp message) {
  decoder_of(png_get_error_ptr(png)).why = message;
  png_longjmp(png, 1);
}

void on_warning(png_structp, png_const_charp) {}

void on_read(png_structp png, png_bytep out, std::size_t size) {
  Decoder& d = decoder_of(png_get_io_ptr(png));
  if (size > d.bytes.size() - d.at) png_error(png, "ends early");
  std::memcpy(out, d.bytes.data() + d.at, size);
  d.at += size;
}

// One row of RGBA, 8 or 16 bits, to 8 bits coded.
void on_row(png_structp png, png_row_infop row, png_bytep data) {
  const Encoding& encoding = *decoder_of(png_get_user_transform_ptr(png)).encoding;
  const bool wide = row->bit_depth == 16;
  for (std::size_t i = 0; i < std::size_t{4} * row->width; ++i) {
    const unsigned value = wide ? data[2 * i] * 256u + data[2 * i + 1] : data[i] * 257u;
    data[i] = i % 4 == 3 ? static_cast<std::uint8_t>((value + 128) / 257) : encoding[value];
  }
}

constexpr std::string_view kSignature("\x89PNG\r\n\x1a\n", 8);
constexpr std::size_t kMostPacking = 1032;  // of deflate, output to input
constexpr std::size_t kHeaderEnd = 33;      // signature and the IHDR chunk

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

// The power by which values make light: 0 for sRGB's own curve.
double power_of(const Decoder& d) {
  if (has_linear_profile(d.bytes)) return 1.0;
  constexpr unsigned kCurve = PNG_INFO_sRGB | PNG_INFO_iCCP;
  double gamma = 0.0;
  if (png_get_valid(d.png, d.info, kCurve) != 0) return 0.0;
  if (png_get_gAMA(d.png, d.info, &gamma) == 0 || !(gamma > 0.01 && gamma < 100.0)) return 0.0;
  constexpr double kSame = 0.05;  // share, as in libpng
  return std::abs(2.2 * gamma - 1.0) < kSame ? 0.0 : 1.0 / gamma;
}

// `wide`: of all values of 16 bits, else of those that 8 bits give, which takes 1/257 of the time.
std::unique_ptr<Encoding> encoding_of(double power, bool wide) {
  auto out = std::make_unique<Encoding>();
  for (std::size_t i = 0; i < out->size(); i += wide ? 1 : 257) {
    const double value = static_cast<double>(i) / 65535.0;
    const double coded =
        power == 0.0 ? value : coded_of(static_cast<float>(std::pow(value, power)));
    (*out)[i] = static_cast<std::uint8_t>(std::lround(255.0 * coded));
  }
  return out;
}

// Indices of the palette, one a byte at the beginning of each row, become the row's pixels. What is
// no colour of the palette is an error: libpng would make it black, which may be a wall. A frame of
// its own: libpng jumps past it.
[[gnu::noinline]] void expand_palette(Decoder& d) {
  png_colorp colours = nullptr;
  png_bytep alphas = nullptr;
  int count = 0, alpha_count = 0;
  png_get_PLTE(d.png, d.info, &colours, &count);
  png_get_tRNS(d.png, d.info, &alphas, &alpha_count, nullptr);
  const auto coded = [&](png_byte value) {
    return d.encoding ? (*d.encoding)[value * 257u] : static_cast<std::uint8_t>(value);
  };
  for (int y = 0; y < d.image.height; ++y) {
    png_bytep row = d.rows[static_cast<std::size_t>(y)];
    for (int x = d.image.width - 1; x >= 0; --x) {
      const int index = row[x];
      if (index >= count) {
        std::array<char, 120> why{};
        std::snprintf(why.data(), why.size(), "pixel (%d, %d) has colour %d of a palette of %d", x,
                      y, index, count);
        png_error(d.png, why.data());
      }
      const std::uint8_t alpha = index < alpha_count ? alphas[index] : std::uint8_t{255};
      const png_byte pixel[4] = {coded(colours[index].red), coded(colours[index].green),
                                 coded(colours[index].blue), alpha};
      std::memcpy(row + std::ptrdiff_t{4} * x, pixel, sizeof pixel);
    }
  }
}

// Everything of libpng's that may fail, and then jumps out of here: nothing in it needs destroying.
bool run(Decoder& d) {
  if (setjmp(png_jmpbuf(d.png)) != 0) return false;
  png_set_read_fn(d.png, &d, on_read);
  png_set_user_limits(d.png, kMostImageSide, kMostImageSide);
  png_read_info(d.png, d.info);
  // Before anything is allocated: deflate cannot have packed that much into so little.
  const std::size_t packed = png_get_rowbytes(d.png, d.info) * png_get_image_height(d.png, d.info);
  if (packed / kMostPacking > d.bytes.size()) png_error(d.png, "ends early");
  const bool indexed = png_get_color_type(d.png, d.info) == PNG_COLOR_TYPE_PALETTE;
  const bool wide = png_get_bit_depth(d.png, d.info) == 16;
  const double power = power_of(d);
  if (wide || power != 0.0) d.encoding = encoding_of(power, wide);
  if (indexed) {
    png_set_packing(d.png);
  } else {
    png_set_expand(d.png);
    png_set_gray_to_rgb(d.png);
    png_set_add_alpha(d.png, wide ? 0xFFFF : 0xFF, PNG_FILLER_AFTER);
    if (d.encoding) {
      png_set_read_user_transform_fn(d.png, on_row);
      png_set_user_transform_info(d.png, &d, 8, 4);
    }
  }
  png_set_interlace_handling(d.png);
  png_read_update_info(d.png, d.info);
  d.image.width = static_cast<int>(png_get_image_width(d.png, d.info));
  d.image.height = static_cast<int>(png_get_image_height(d.png, d.info));
  const std::size_t width = png_get_image_width(d.png, d.info), row = 4 * width;
  const std::size_t read = indexed ? width : row;
  if (png_get_rowbytes(d.png, d.info) != read) png_error(d.png, "odd rows");
  d.image.rgba.resize(row * static_cast<std::size_t>(d.image.height));
  d.rows.resize(static_cast<std::size_t>(d.image.height));
  for (std::size_t y = 0; y < d.rows.size(); ++y) d.rows[y] = d.image.rgba.data() + y * row;
  png_read_image(d.png, d.rows.data());
  png_read_end(d.png, nullptr);
  if (indexed) expand_palette(d);
  return true;
}

}  // namespace

Result<RgbaImage> decode_png(std::string_view bytes) {
  if (Status status = check_size(bytes); !status) return status;
  Decoder d(bytes);
  d.png = png_create_read_struct(PNG_LIBPNG_VER_STRING, &d, on_error, on_warning);
  d.info = d.png == nullptr ? nullptr : png_create_info_struct(d.png);
  if (d.info == nullptr) return Status::error("no memory to read the PNG");
  if (!run(d)) return Status::error("bad PNG: " + d.why);
  return std::move(d.image);
}

Result<RgbaImage> read_png(const std::string& path) {
  const Result<std::string> bytes = read_file(path, kMostPngBytes);
  if (!bytes) return bytes.status();
  Result<RgbaImage> image = decode_png(*bytes);
  if (!image) return Status::error(path + ": " + image.message());
  return image;
}

}  // namespace handrail
