#include "server/painting/png_io.h"

#include <gtest/gtest.h>

#include "tests/support/png_sample.h"
#include "tests/support/temp_folder.h"

namespace handrail {
namespace {

using test::Pixel;
using test::PngSample;

Pixel pixel_at(const RgbaImage& image, int x, int y) {
  const std::size_t i = 4 * (static_cast<std::size_t>(y) * static_cast<std::size_t>(image.width) +
                             static_cast<std::size_t>(x));
  return {image.rgba[i], image.rgba[i + 1], image.rgba[i + 2], image.rgba[i + 3]};
}

// A 21 x 13 sample whose channels take all values that `depth` can hold.
PngSample sample(int type, int depth) {
  PngSample s;
  s.width = 21;
  s.height = 13;
  s.type = type;
  s.depth = depth;
  const int levels = 1 << std::min(depth, 8);
  s.pixel = [=](int x, int y) -> Pixel {
    const auto value = [&](int k) {
      return static_cast<std::uint8_t>(k % levels * (type == 3 ? 1 : 255 / (levels - 1)));
    };
    return {value(x + 3 * y), value(7 * x + y), value(x * y), value(11 * x + 5 * y + 1)};
  };
  return s;
}

void expect_reads(const PngSample& s, const std::vector<Pixel>& colours = {}) {
  const Result<RgbaImage> image = decode_png(test::png_of(s));
  ASSERT_TRUE(image.is_ok()) << image.message();
  ASSERT_EQ(image->width, s.width);
  ASSERT_EQ(image->height, s.height);
  for (int y = 0; y < s.height; ++y) {
    for (int x = 0; x < s.width; ++x) {
      Pixel want = s.pixel(x, y);
      if (s.type == 3) want = colours[want[0]];
      if (s.type == 0 || s.type == 4) want = {want[0], want[0], want[0], want[3]};
      if (s.type == 0 || s.type == 2) want[3] = 255;
      ASSERT_EQ(pixel_at(*image, x, y), want)
          << "type " << s.type << " depth " << s.depth << " at " << x << ", " << y;
    }
  }
}

TEST(PngIo, ReadsEveryColourTypeDepthAndInterlace) {
  for (const bool interlaced : {false, true}) {
    for (const auto& [type, depth] : std::vector<std::pair<int, int>>{{0, 1},
                                                                      {0, 2},
                                                                      {0, 4},
                                                                      {0, 8},
                                                                      {0, 16},
                                                                      {2, 8},
                                                                      {2, 16},
                                                                      {4, 8},
                                                                      {4, 16},
                                                                      {6, 8},
                                                                      {6, 16}}) {
      PngSample s = sample(type, depth);
      s.interlaced = interlaced;
      expect_reads(s);
    }
  }
}

TEST(PngIo, ReadsIndexedColoursWithAndWithoutAlpha) {
  for (const int depth : {1, 2, 4, 8}) {
    for (const bool alpha : {false, true}) {
      PngSample s = sample(3, depth);
      s.interlaced = depth == 4;
      std::string palette, alphas;
      std::vector<Pixel> colours;
      for (int i = 0; i < 1 << depth; ++i) {
        const Pixel c = {static_cast<std::uint8_t>(i), static_cast<std::uint8_t>(255 - i),
                         static_cast<std::uint8_t>(37 * i),
                         static_cast<std::uint8_t>(alpha ? 255 - 3 * i : 255)};
        colours.push_back(c);
        palette.append({static_cast<char>(c[0]), static_cast<char>(c[1]), static_cast<char>(c[2])});
        alphas += static_cast<char>(c[3]);
      }
      s.chunks.push_back({"PLTE", palette});
      if (alpha) s.chunks.push_back({"tRNS", alphas});
      expect_reads(s, colours);
    }
  }
}

TEST(PngIo, RefusesAPixelThatIsNoColourOfThePalette) {
  PngSample s = sample(3, 8);
  s.pixel = [](int x, int y) {
    return Pixel{static_cast<std::uint8_t>(x == 2 && y == 1 ? 3 : 1), 0, 0, 0};
  };
  s.chunks.push_back({"PLTE", std::string(9, 'a')});
  const Result<RgbaImage> image = decode_png(test::png_of(s));
  ASSERT_FALSE(image.is_ok());
  EXPECT_EQ(image.message(), "bad PNG: pixel (2, 1) has colour 3 of a palette of 3");
}

TEST(PngIo, TakesTheColourThatTheFileCallsTransparentAsThat) {
  PngSample s;
  s.width = 2;
  s.type = 2;
  s.pixel = [](int x, int) { return Pixel{10, 20, static_cast<std::uint8_t>(30 + x), 255}; };
  s.chunks.push_back({"tRNS", std::string("\0\x0A\0\x14\0\x1E", 6)});
  const Result<RgbaImage> image = decode_png(test::png_of(s));
  ASSERT_TRUE(image.is_ok()) << image.message();
  EXPECT_EQ(pixel_at(*image, 0, 0)[3], 0);
  EXPECT_EQ(pixel_at(*image, 1, 0), (Pixel{10, 20, 31, 255}));
}

std::uint8_t grey_of(const std::string& chunk, const std::string& contents, int depth) {
  PngSample s;
  s.type = 0;
  s.depth = depth;
  s.pixel = [](int, int) { return Pixel{55, 0, 0, 255}; };
  s.chunks.push_back({chunk, contents});
  const Result<RgbaImage> image = decode_png(test::png_of(s));
  return image ? image->rgba[0] : 0;
}

// An ICC profile of one tag, the red curve.
std::string profile(const std::string& curve) {
  const std::string tags = std::string(128, '\0') + test::big_endian(1) + "rTRC" +
                           test::big_endian(144) + test::big_endian(20);
  return std::string("name\0\0", 6) + test::packed(tags + curve);
}

TEST(PngIo, KeepsValuesThatTheFileCallsSrgbAndConvertsOthers) {
  const std::string curve = std::string("curv\0\0\0\0", 8);
  for (const int depth : {8, 16}) {
    EXPECT_EQ(grey_of("sRGB", std::string(1, '\0'), depth), 55);
    EXPECT_EQ(grey_of("gAMA", test::big_endian(45455), depth), 55);
    EXPECT_EQ(grey_of("iCCP", profile(curve + test::big_endian(1) + "\x02\x33"), depth), 55);
    // 55/255 of light is 128/255 coded (IEC 61966-2-1).
    EXPECT_EQ(grey_of("gAMA", test::big_endian(100000), depth), 128);
    EXPECT_EQ(grey_of("iCCP", profile(curve + test::big_endian(0)), depth), 128);
    EXPECT_EQ(grey_of("iCCP",
                      profile(std::string("para\0\0\0\0\0\0\0\0", 12) + test::big_endian(0x10000)),
                      depth),
              128);
  }
}

TEST(PngIo, KeepsAlphaAsItIsWhereColoursAreConverted) {
  for (const int depth : {8, 16}) {
    PngSample s;
    s.depth = depth;
    s.pixel = [](int, int) { return Pixel{55, 55, 55, 77}; };
    s.chunks.push_back({"gAMA", test::big_endian(100000)});
    const Result<RgbaImage> image = decode_png(test::png_of(s));
    ASSERT_TRUE(image.is_ok()) << image.message();
    EXPECT_EQ(pixel_at(*image, 0, 0), (Pixel{128, 128, 128, 77}));
  }
}

TEST(PngIo, SaysWhatIsWrongWithAFile) {
  const auto error = [](const std::string& bytes) { return decode_png(bytes).message(); };
  PngSample s = sample(6, 8);
  const std::string good = test::png_of(s);
  EXPECT_EQ(error(""), "not a PNG file");
  EXPECT_EQ(error("P6 2 2 255"), "not a PNG file");
  EXPECT_EQ(error(good.substr(0, 20)), "bad PNG: ends within its header");
  EXPECT_TRUE(error(good.substr(0, good.size() / 2)).starts_with("bad PNG: "));
  EXPECT_TRUE(error(good.substr(0, good.size() - 30)).starts_with("bad PNG: "));
  std::string corrupt = good;
  corrupt[good.size() / 2] ^= 0x10;
  EXPECT_TRUE(error(corrupt).starts_with("bad PNG: ")) << error(corrupt);
  std::string hardly = good;
  const std::string size = test::big_endian(8000) + test::big_endian(8000);
  hardly.replace(8, 25, test::chunk_of("IHDR", size + good.substr(24, 5)));
  EXPECT_EQ(error(hardly), "bad PNG: ends early");
  s.width = 0;
  EXPECT_EQ(error(test::png_of(s)), "bad PNG: 0 x 13 pixels");
}

TEST(PngIo, RefusesAnEnormousImageBeforeReadingIt) {
  PngSample s;
  std::string bytes = test::png_of(s);
  const auto with_size = [&](std::uint32_t width, std::uint32_t height) {
    bytes.replace(16, 8, test::big_endian(width) + test::big_endian(height));
    bytes.replace(8, 25, test::chunk_of("IHDR", bytes.substr(16, 13)));
    return decode_png(bytes).message();
  };
  EXPECT_EQ(with_size(8001, 10), "8001 x 10 pixels, expected at most 8000 x 8000");
  EXPECT_EQ(with_size(0x7FFFFFFF, 0x7FFFFFFF),
            "2147483647 x 2147483647 pixels, expected at most 8000 x 8000");
  EXPECT_EQ(with_size(0xFFFFFFFF, 1), "4294967295 x 1 pixels, expected at most 8000 x 8000");
}

TEST(PngIo, NamesTheFile) {
  const TempFolder folder;
  const std::string path = folder.write("a.png", "no");
  EXPECT_EQ(read_png(path).message(), path + ": not a PNG file");
  EXPECT_EQ(read_png("/nowhere/a.png").message(),
            "/nowhere/a.png: cannot open: No such file or directory");
}

}  // namespace
}  // namespace handrail
