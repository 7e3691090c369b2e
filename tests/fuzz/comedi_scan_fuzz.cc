// What a card streams, cut anywhere, and what its numbers mean.
#include <algorithm>
#include <cmath>

#include "devices/comedi/comedi_scan.h"
#include "devices/comedi/encoder_count.h"
#include "devices/comedi/ft_scale.h"
#include "tests/fuzz/fuzz_target.h"

namespace handrail {

// The first two bytes say how long the pieces are, how many channels and how wide.
HANDRAIL_FUZZ(comedi_scan) {
  fuzz::Input in(bytes);
  const std::size_t piece = 1 + in.take<std::uint8_t>();
  const auto kind = in.take<std::uint8_t>();
  const std::size_t channels = 1 + kind % kMostComediChannels;
  const std::size_t each = (kind & 0x80) != 0 ? 4 : 2;
  const fuzz::Bytes said = in.take_bytes(in.left());
  ComediScanBytes whole(channels, each), cut(channels, each);
  const std::size_t scans = whole.take(said);
  std::size_t still = 0;
  EncoderCount count;
  count.begin(0, 0xffffff);
  std::int64_t last = 0;
  for (std::size_t at = 0; at < said.size(); at += piece) {
    still += cut.take(said.subspan(at, std::min(piece, said.size() - at)));
    const std::int64_t now = count.next(cut.newest()[0] & 0xffffff);
    fuzz::require(std::abs(now - last) <= 0x800000, "a counter goes the shorter way");
    fuzz::require((now & 0xffffff) == (cut.newest()[0] & 0xffffff), "and ends where it stands");
    last = now;
  }
  fuzz::require(scans == still && scans == said.size() / (channels * each),
                "each whole scan is one, wherever it is cut");
  fuzz::require(std::ranges::equal(whole.newest(), cut.newest()), "and the newest is the same");
  if (channels < 6) return;
  FtCounts raw{};
  std::copy_n(whole.newest().begin(), raw.size(), raw.begin());
  const FtReading reading = jr3_reading(raw, FtSix::Constant(100.0));
  for (unsigned int i = 0; i < 6; ++i) {
    const bool beyond = std::abs(reading.value[i]) >= 100.0;
    fuzz::require(std::isfinite(reading.value[i]), "a reading is a number");
    fuzz::require(!beyond || (reading.saturated >> i & 1u) != 0, "what is beyond is said to be");
  }
}

}  // namespace handrail
