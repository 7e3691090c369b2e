// PNG files written by hand, for tests of the reader: any colour type, depth and interlace, and any
// chunk, right or wrong. Needs zlib.
#pragma once

#include <zlib.h>

#include <array>
#include <cstdint>
#include <functional>
#include <string>
#include <utility>
#include <vector>

namespace handrail::test {

using Pixel = std::array<std::uint8_t, 4>;  // red, green, blue, alpha

struct PngSample {
  int width = 1, height = 1;
  int depth = 8;            // bits a channel
  int type = 6;             // 0 grey, 2 RGB, 3 indexed, 4 grey and alpha, 6 RGBA
  bool interlaced = false;  // Adam7
  // 8 bits a channel; grey is its first; of an indexed file the first is the index.
  std::function<Pixel(int x, int y)> pixel = [](int, int) { return Pixel{0, 0, 0, 255}; };
  std::vector<std::pair<std::string, std::string>> chunks;  // type and contents, after the header
};

inline std::string big_endian(std::uint32_t value) {
  std::string out;
  for (int shift = 24; shift >= 0; shift -= 8) out += static_cast<char>(value >> shift & 0xFF);
  return out;
}

inline std::string chunk_of(const std::string& type, const std::string& contents) {
  const std::string body = type + contents;
  const uLong crc =
      ::crc32(0, reinterpret_cast<const Bytef*>(body.data()), static_cast<uInt>(body.size()));
  return big_endian(static_cast<std::uint32_t>(contents.size())) + body +
         big_endian(static_cast<std::uint32_t>(crc));
}

inline std::string packed(const std::string& raw) {
  uLongf size = ::compressBound(raw.size());
  std::string out(size, '\0');
  ::compress2(reinterpret_cast<Bytef*>(out.data()), &size,
              reinterpret_cast<const Bytef*>(raw.data()), raw.size(), 1);
  out.resize(size);
  return out;
}

// The rows of one pass: every `dx`-th pixel from x0, every `dy`-th row from y0, unfiltered.
inline std::string rows_of(const PngSample& s, int x0, int y0, int dx, int dy) {
  std::vector<int> channels = {0, 1, 2, 3};
  if (s.type == 0 || s.type == 3) channels = {0};
  if (s.type == 4) channels = {0, 3};
  if (s.type == 2) channels = {0, 1, 2};
  std::string out;
  for (int y = y0; y < s.height && x0 < s.width; y += dy) {
    out += '\0';
    int bits = 0;
    unsigned held = 0;
    for (int x = x0; x < s.width; x += dx) {
      const Pixel p = s.pixel(x, y);
      for (const int channel : channels) {
        const unsigned v = p[static_cast<std::size_t>(channel)];
        if (s.depth == 16) {
          out += static_cast<char>(v);
          out += static_cast<char>(v);
          continue;
        }
        held = held << s.depth | (s.type == 3 ? v : v >> (8 - s.depth));
        bits += s.depth;
        if (bits < 8) continue;
        out += static_cast<char>(held);
        bits = 0;
        held = 0;
      }
    }
    if (bits > 0) out += static_cast<char>(held << (8 - bits));
  }
  return out;
}

inline std::string png_of(const PngSample& s) {
  std::string header = big_endian(static_cast<std::uint32_t>(s.width)) +
                       big_endian(static_cast<std::uint32_t>(s.height));
  for (const int v : {s.depth, s.type, 0, 0, s.interlaced ? 1 : 0}) header += static_cast<char>(v);
  std::string out = "\x89PNG\r\n\x1a\n" + chunk_of("IHDR", header);
  for (const auto& [type, contents] : s.chunks) out += chunk_of(type, contents);
  static constexpr int kAdam7[7][4] = {{0, 0, 8, 8}, {4, 0, 8, 8}, {0, 4, 4, 8}, {2, 0, 4, 4},
                                       {0, 2, 2, 4}, {1, 0, 2, 2}, {0, 1, 1, 2}};
  std::string rows;
  if (s.interlaced) {
    for (const auto& pass : kAdam7) rows += rows_of(s, pass[0], pass[1], pass[2], pass[3]);
  } else {
    rows = rows_of(s, 0, 0, 1, 1);
  }
  return out + chunk_of("IDAT", packed(rows)) + chunk_of("IEND", "");
}

}  // namespace handrail::test
