// A card, over a stand-in for libcomedi.
#include "devices/comedi/comedi_card.h"

#include <gmock/gmock.h>

#include <cerrno>

#include "tests/unit/comedi/comedi_bench.h"

namespace handrail {
namespace {

using test::ComediState;
using ::testing::HasSubstr;

class ComediCardTest : public test::ComediBench {
 protected:
  void SetUp() override {
    ComediBench::SetUp();
    const auto loaded = load_comedi(place.library);
    ASSERT_TRUE(loaded) << loaded.message();
    api = *loaded;
  }
  std::string open_error(int error) {
    card([&](ComediState& s) { s.open_error = error; });
    return ComediCard::open(api, place).message();
  }
  ComediApi api;
};

TEST_F(ComediCardTest, WhyItCannotBeOpenedIsSaidWithWhatToDo) {
  EXPECT_THAT(open_error(ENOENT), HasSubstr("comedi: /dev/comedi0: cannot be opened: No such file "
                                            "or directory; is the card there, and its driver "
                                            "loaded?"));
  EXPECT_THAT(open_error(EACCES), HasSubstr("Permission denied; sudo usermod -aG iocard $USER"));
  EXPECT_THAT(open_error(ENODEV), HasSubstr("; no card is attached to it: sudo dmesg"));
  EXPECT_THAT(open_error(EBUSY), HasSubstr("; another program uses it"));
  EXPECT_THAT(open_error(ENOTTY), HasSubstr("; expected a device of comedi, such as /dev/comedi0"));
  EXPECT_THAT(open_error(EMFILE), HasSubstr("cannot be opened: Too many open files"));
}

TEST_F(ComediCardTest, AnotherBoardThanTheConfiguredIsNamed) {
  place.board = "jr3_pci_2";
  EXPECT_THAT(ComediCard::open(api, place).message(),
              HasSubstr("comedi: /dev/comedi0: is 'jr3_pci_1', driven by jr3_pci, expected "
                        "'jr3_pci_2'; another card may have come before it"));
  place.board = "jr3_pci_1";
  EXPECT_TRUE(ComediCard::open(api, place));
}

TEST_F(ComediCardTest, SubdevicesAreFoundByWhatTheyAre) {
  card([](ComediState& s) { s.subdevices = multi(); });
  const auto opened = ComediCard::open(api, place);
  ASSERT_TRUE(opened);
  constexpr int kCounters[] = {kComediCounter};
  constexpr int kTimers[] = {12};
  EXPECT_EQ(*opened->subdevice("encoder", std::nullopt, kCounters), 3u);
  EXPECT_EQ(*opened->subdevice("encoder", 3, kCounters), 3u);
  EXPECT_THAT(opened->subdevice("encoder", 1, kCounters).message(),
              HasSubstr("encoder: subdevice 1 of jr3_pci_1, driven by jr3_pci has analog outputs, "
                        "expected counters; comedi_board_info"));
  EXPECT_THAT(opened->subdevice("encoder", 4, kCounters).message(),
              HasSubstr("subdevice 4 of jr3_pci_1, driven by jr3_pci is not there, the last is 3"));
  EXPECT_THAT(opened->subdevice("x", std::nullopt, kTimers).message(),
              HasSubstr("x: jr3_pci_1, driven by jr3_pci has no"));
}

TEST_F(ComediCardTest, ChannelsAndRangesThatAreNotThereAreNamed) {
  card([](ComediState& s) { s.subdevices = multi(); });
  const auto opened = ComediCard::open(api, place);
  ASSERT_TRUE(opened);
  EXPECT_EQ(opened->range({0, 7, 0, 0})->max, 10.0);
  EXPECT_THAT(opened->range({0, 8, 0, 0}).message(),
              HasSubstr("subdevice 0 has no channel 8, the last is 7"));
  EXPECT_THAT(opened->range({0, 0, 1, 0}).message(),
              HasSubstr("subdevice 0, channel 0 has no range 1 that means anything"));
}

TEST_F(ComediCardTest, ReadsAndWritesAllInOneCallOrSaysWhyNot) {
  card([](ComediState& s) {
    s.subdevices = multi();
    s.subdevices[0].values = {1, 2, 3, 4, 5, 6, 7, 8};
  });
  auto opened = ComediCard::open(api, place);
  ASSERT_TRUE(opened);
  ASSERT_EQ(api.lock(opened->handle(), 1), 0);
  const ComediChannel in[] = {{0, 2, 0, 0}, {0, 0, 0, 2}};
  std::array<unsigned int, 2> got{};
  EXPECT_EQ(opened->read(in, got), 0);
  EXPECT_EQ(got, (std::array<unsigned int, 2>{3, 1}));
  EXPECT_EQ(card([](ComediState& s) { return s.reads; }), 1);
  const ComediChannel out[] = {{1, 0, 0, 0}, {1, 1, 0, 0}};
  EXPECT_EQ(opened->write(out, std::array<unsigned int, 2>{7, 9}), 0);
  EXPECT_EQ(card([](ComediState& s) { return s.subdevices[1].values[1]; }), 9u);
  card([](ComediState& s) { s.read_error = ENODEV; });
  EXPECT_EQ(opened->read(in, got), ENODEV);
  const ComediChannel none[] = {{9, 0, 0, 0}};
  EXPECT_EQ(opened->write(none, std::array<unsigned int, 1>{0}), EINVAL);
}

}  // namespace
}  // namespace handrail
