#include "devices/evdev/evdev_stream.h"

#include <gtest/gtest.h>

#include <cstring>
#include <vector>

namespace handrail {
namespace {

using Bytes = std::vector<std::uint8_t>;

void put(Bytes& out, unsigned type, unsigned code, int value) {
  input_event event{};
  event.type = static_cast<std::uint16_t>(type);
  event.code = static_cast<std::uint16_t>(code);
  event.value = value;
  const std::size_t at = out.size();
  out.resize(at + sizeof event);
  std::memcpy(out.data() + at, &event, sizeof event);
}

void put_report(Bytes& out) { put(out, EV_SYN, SYN_REPORT, 0); }

TEST(EvdevStream, AReportCountsWhenItIsWhole) {
  EvdevStream stream;
  Bytes bytes;
  put(bytes, EV_KEY, KEY_A, 1);
  put(bytes, EV_ABS, ABS_X, -7);
  ASSERT_TRUE(stream.take(bytes));
  EXPECT_FALSE(stream.state().keys[KEY_A]);
  EXPECT_EQ(stream.state().axes[ABS_X], 0);
  bytes.clear();
  put_report(bytes);
  ASSERT_TRUE(stream.take(bytes));
  EXPECT_TRUE(stream.state().keys[KEY_A]);
  EXPECT_EQ(stream.state().axes[ABS_X], -7);
}

TEST(EvdevStream, ItIsTakenHoweverItIsCut) {
  Bytes all;
  put(all, EV_KEY, KEY_A, 1);
  put_report(all);
  put(all, EV_KEY, KEY_A, 2);  // the kernel repeats what is held
  put(all, EV_KEY, KEY_B, 1);
  put_report(all);
  for (std::size_t piece = 1; piece <= all.size(); ++piece) {
    EvdevStream stream;
    for (std::size_t at = 0; at < all.size(); at += piece) {
      ASSERT_TRUE(stream.take({all.data() + at, std::min(piece, all.size() - at)})) << piece;
    }
    EXPECT_TRUE(stream.state().keys[KEY_A]) << piece;
    EXPECT_TRUE(stream.state().keys[KEY_B]) << piece;
    EXPECT_EQ(stream.state().keys.count(), 2u) << piece;
  }
}

TEST(EvdevStream, APressThatIsOverIsToldOnce) {
  EvdevStream stream;
  Bytes bytes;
  put(bytes, EV_KEY, KEY_A, 1);
  put_report(bytes);
  put(bytes, EV_KEY, KEY_A, 0);
  put_report(bytes);
  ASSERT_TRUE(stream.take(bytes));
  EXPECT_FALSE(stream.state().keys[KEY_A]);
  EXPECT_TRUE(stream.take_presses()[KEY_A]);
  EXPECT_TRUE(stream.take_presses().none());
}

TEST(EvdevStream, EventsThatAreMissingEndItUntilItBeginsAnew) {
  EvdevStream stream;
  Bytes bytes;
  put(bytes, EV_SYN, SYN_DROPPED, 0);
  EXPECT_FALSE(stream.take(bytes));
  bytes.clear();
  put(bytes, EV_KEY, KEY_A, 1);
  put_report(bytes);
  EXPECT_FALSE(stream.take(bytes)) << "nothing after it is trusted";
  EvdevState known;
  known.keys[KEY_B] = true;
  stream.begin(known);
  EXPECT_TRUE(stream.state().keys[KEY_B]);
  ASSERT_TRUE(stream.take(bytes));
  EXPECT_TRUE(stream.state().keys[KEY_A]);
  EXPECT_TRUE(stream.state().keys[KEY_B]);
}

TEST(EvdevStream, CodesThatTheKernelDoesNotHaveArePassedOver) {
  EvdevStream stream;
  Bytes bytes;
  put(bytes, EV_KEY, 0xffff, 1);
  put(bytes, EV_KEY, KEY_CNT, 1);
  put(bytes, EV_ABS, ABS_CNT, 1);
  put(bytes, EV_ABS, 0xffff, 1);
  put(bytes, 0x1234, 1, 1);
  put_report(bytes);
  ASSERT_TRUE(stream.take(bytes));
  EXPECT_TRUE(stream.state().keys.none());
  EXPECT_TRUE(stream.take_presses().none());
}

}  // namespace
}  // namespace handrail
