// A JR3 and six voltages, over a stand-in for libcomedi.
#include "devices/comedi/comedi_ft_sensor.h"

#include <gmock/gmock.h>
#include <sys/socket.h>
#include <unistd.h>

#include <cerrno>
#include <filesystem>
#include <numbers>

#include "devices/comedi/comedi_scan.h"
#include "tests/support/no_allocation.h"
#include "tests/support/temp_folder.h"
#include "tests/unit/comedi/comedi_bench.h"

namespace handrail {
namespace {

using test::ComediState;
using ::testing::HasSubstr;

class ComediFtSensorTest : public test::ComediBench {
 protected:
  void SetUp() override {
    ComediBench::SetUp();
    options.place = place;
    options.filter = 0;  // settles at once
    card([](ComediState& s) { s.subdevices = {jr3()}; });
  }
  void TearDown() override {
    sensor.reset();
    ComediBench::TearDown();
  }
  void start() {
    sensor = std::make_unique<ComediFtSensor>(options, [this](bool bad, const std::string& line) {
      const std::lock_guard lock(mutex);
      said.push_back((bad ? "bad: " : "") + line);
    });
    const Status started = sensor->start();
    ASSERT_TRUE(started) << started.message();
  }
  std::string start_error() {
    ComediFtSensor fails(options);
    return fails.start().message();
  }
  bool take_until(const std::function<bool(const FtSample&)>& wanted) {
    return becomes([&] { return sensor->poll(monotonic_now(), sample) && wanted(sample); });
  }
  bool reads() {
    return take_until([](const FtSample& s) { return s.status == 0; });
  }
  bool says(const std::string& line) {
    return becomes([&] {
      const std::lock_guard lock(mutex);
      for (const std::string& one : said) {
        if (one.find(line) != std::string::npos) return true;
      }
      return false;
    });
  }
  void push(unsigned int channel, unsigned int raw) {
    card([&](ComediState& s) { s.subdevices[0].values[channel] = raw; });
  }

  ComediFtOptions options;
  std::unique_ptr<ComediFtSensor> sensor;
  FtSample sample;
  std::mutex mutex;
  std::vector<std::string> said;
};

TEST_F(ComediFtSensorTest, MeasuresInNewtonsAndNewtonMetres) {
  options.filter = 1;
  ASSERT_NO_FATAL_FAILURE(start());
  push(8, 16384 + 8192);   // half of 200 N
  push(12, 16384 - 4096);  // a quarter of 12 N m, the other way
  push(0, 16384 + 99);     // another filter's
  ASSERT_TRUE(reads());
  ASSERT_TRUE(reads());
  EXPECT_TRUE(sample.wrench.force.isApprox(Vec3(100.0, 0.0, 0.0), 1e-9));
  EXPECT_TRUE(sample.wrench.torque.isApprox(Vec3(0.0, -3.0, 0.0), 1e-9));
  EXPECT_EQ(sensor->full_scale(), (std::pair<double, double>(200.0, 10.0)));
  EXPECT_EQ(sensor->capabilities().name, "JR3");
  EXPECT_TRUE(says("jr3_pci_1, full scale 200, 200, 400 N and 12, 12, 10 N m: readings come"));
}

TEST_F(ComediFtSensorTest, ASettlingCardIsWaitedForAndItsScaleAskedForAnew) {
  // As jr3_pci has it before it found the sensor: full scales of 1 kN, and EAGAIN.
  card([](ComediState& s) {
    s.subdevices = {jr3(1.0)};
    s.read_error = EAGAIN;
  });
  ASSERT_NO_FATAL_FAILURE(start());
  ASSERT_TRUE(take_until([](const FtSample& s) { return s.status == kFtSettling; }));
  EXPECT_EQ(sensor->full_scale().first, 0.0);
  card([](ComediState& s) {
    s.subdevices = {jr3(0.1)};
    s.subdevices[0].values[0] = 16384 + 8192;
    s.read_error = 0;
  });
  ASSERT_TRUE(reads());
  EXPECT_NEAR(sample.wrench.force.x(), 50.0, 1e-9);  // and not 500
}

TEST_F(ComediFtSensorTest, FullScaleWhileALowPassSettlesIsNoForceBeyondTheRange) {
  options.filter = 6;  // 3.9 Hz: 0.4 s
  push(48 + 2, 32767);
  ASSERT_NO_FATAL_FAILURE(start());
  ASSERT_TRUE(take_until([](const FtSample& s) { return s.status == (4u | kFtSettling); }));
  EXPECT_FALSE(sample.overrange);
  EXPECT_TRUE(take_until([](const FtSample& s) { return s.status == 4u; }));
  EXPECT_TRUE(sample.overrange);
}

TEST_F(ComediFtSensorTest, ALowPassSettlesBeforeReadingsCount) {
  options.filter = 3;  // 31.25 Hz: 51 ms
  ASSERT_NO_FATAL_FAILURE(start());
  const Nanos began = monotonic_now();
  ASSERT_TRUE(reads());
  EXPECT_GE(monotonic_now() - began, 51 * kMillisecond);
}

TEST_F(ComediFtSensorTest, AChangedSensorIsAFaultAndItsNewScaleIsTaken) {
  ASSERT_NO_FATAL_FAILURE(start());
  ASSERT_TRUE(reads());
  card([](ComediState& s) { s.read_error = EAGAIN; });
  ASSERT_TRUE(take_until([](const FtSample& s) { return s.status == kFtSettling; }));
  EXPECT_TRUE(sample.wrench.force.isZero(0.0));
  card([](ComediState& s) {
    s.subdevices = {jr3(0.4)};
    s.subdevices[0].values[0] = 16384 + 4096;
    s.read_error = 0;
  });
  ASSERT_TRUE(reads());
  EXPECT_NEAR(sample.wrench.force.x(), 100.0, 1e-9);
}

TEST_F(ComediFtSensorTest, UnpluggedAHundredTimesItSaysSoAndGoesOn) {
  options.reopen_pause = kMillisecond;
  ASSERT_NO_FATAL_FAILURE(start());
  ASSERT_TRUE(reads());
  std::uint32_t newest = sample.sequence;
  for (int i = 0; i < 100; ++i) {
    card([](ComediState& s) {
      s.read_error = ENODEV;
      s.open_error = ENOENT;
    });
    ASSERT_TRUE(take_until([](const FtSample& s) { return s.status == kFtLost; })) << i;
    card([](ComediState& s) { s.read_error = s.open_error = 0; });
    ASSERT_TRUE(reads()) << i;
    ASSERT_GT(sample.sequence, newest) << i;
    newest = sample.sequence;
  }
  EXPECT_TRUE(says("bad: force sensor: card or sensor is gone"));
  EXPECT_EQ(card([](ComediState& s) { return s.open_devices; }), 1);
}

TEST_F(ComediFtSensorTest, ACardThatIsWaitedForMayComeLater) {
  options.waits = true;
  options.reopen_pause = kMillisecond;
  card([](ComediState& s) { s.open_error = ENOENT; });
  ASSERT_NO_FATAL_FAILURE(start());
  EXPECT_TRUE(take_until([](const FtSample& s) { return s.status == kFtLost; }));
  EXPECT_TRUE(says("bad: force sensor: comedi: /dev/comedi0: cannot be opened: No such file"));
  card([](ComediState& s) { s.open_error = 0; });
  EXPECT_TRUE(reads());
  sensor->stop();
  for (const std::string& line : said) EXPECT_EQ(line.find("is gone"), std::string::npos) << line;
  options.waits = false;
  card([](ComediState& s) { s.open_error = ENOENT; });
  EXPECT_THAT(start_error(), HasSubstr("cannot be opened: No such file"));
}

TEST_F(ComediFtSensorTest, ALibraryThatIsWaitedForMayComeLater) {
  const TempFolder folder;
  options.place.library = folder.path() + "/libcomedi.so.0";
  options.waits = false;
  EXPECT_THAT(start_error(), HasSubstr("libcomedi.so.0: cannot be loaded"));
  options.waits = true;
  options.reopen_pause = kMillisecond;
  ASSERT_NO_FATAL_FAILURE(start());
  EXPECT_TRUE(take_until([](const FtSample& s) { return s.status == kFtLost; }));
  EXPECT_TRUE(says("bad: force sensor: comedi: "));
  EXPECT_TRUE(says("sudo apt-get install libcomedi0"));
  std::filesystem::create_symlink(HANDRAIL_COMEDI_STAND_IN, options.place.library);
  EXPECT_TRUE(reads());
  sensor->stop();
  ASSERT_TRUE(sensor->start()) << "and with the library that is there";
  EXPECT_TRUE(reads());
}

TEST_F(ComediFtSensorTest, AnAxisAtItsEndIsAStatusOfItsOwn) {
  ASSERT_NO_FATAL_FAILURE(start());
  ASSERT_TRUE(reads());
  push(2, 32767);
  EXPECT_TRUE(take_until([](const FtSample& s) { return s.status == 4u && s.overrange; }));
  push(2, 32000);
  EXPECT_TRUE(reads());
}

TEST_F(ComediFtSensorTest, TheMountTurnsAndMovesWhatItFeels) {
  options.mount.X_TF = {Vec3(0.0, 0.0, -0.03),
                        rotation_exp(Vec3(0.0, 0.0, std::numbers::pi / 2.0))};
  push(0, 16384 + 8192);
  ASSERT_NO_FATAL_FAILURE(start());
  ASSERT_TRUE(reads());
  EXPECT_TRUE(sample.wrench.force.isApprox(Vec3(0.0, 100.0, 0.0), 1e-9));
  EXPECT_TRUE(sample.wrench.torque.isApprox(Vec3(3.0, 0.0, 0.0), 1e-9));
}

TEST_F(ComediFtSensorTest, ThePresentReadingBecomesZeroAndOnlyOneThatCounts) {
  ASSERT_NO_FATAL_FAILURE(start());
  push(0, 16384 + 8192);
  ASSERT_TRUE(
      take_until([](const FtSample& s) { return s.status == 0 && s.wrench.force.x() > 99.0; }));
  card([](ComediState& s) { s.read_error = EAGAIN; });
  ASSERT_TRUE(take_until([](const FtSample& s) { return s.status == kFtSettling; }));
  sensor->bias();  // of the last that counted
  card([](ComediState& s) { s.read_error = 0; });
  ASSERT_TRUE(reads());
  EXPECT_TRUE(sample.wrench.force.isZero(1e-9));
}

TEST_F(ComediFtSensorTest, NothingBeforeTheStartAndAfterTheEnd) {
  sensor = std::make_unique<ComediFtSensor>(options);
  EXPECT_FALSE(sensor->poll(monotonic_now(), sample));
  sensor->bias();
  sensor->stop();
  ASSERT_TRUE(sensor->start());
  ASSERT_TRUE(reads());
  sensor->stop();
  sensor->stop();
  EXPECT_FALSE(sensor->poll(monotonic_now(), sample));
  ASSERT_TRUE(sensor->start());
  EXPECT_TRUE(reads());
}

TEST_F(ComediFtSensorTest, PollingDoesNotAllocateNorWaitForTheCard) {
  ASSERT_NO_FATAL_FAILURE(start());
  ASSERT_TRUE(reads());
  const test::NoAllocation guard("force sensor");
  for (int i = 0; i < 1000; ++i) sensor->poll(monotonic_now(), sample);
  sensor->bias();
}

TEST_F(ComediFtSensorTest, WhatIsNoJr3IsNamed) {
  card([](ComediState& s) {
    s.driver = "ni_pcimio";
    s.board = "pci-6221";
  });
  EXPECT_THAT(start_error(),
              HasSubstr("force sensor: comedi: /dev/comedi0: is 'pci-6221', driven by ni_pcimio, "
                        "expected one of jr3_pci; name the card of JR3"));
  card([](ComediState& s) {
    s.driver = "jr3_pci";
    s.subdevices = {jr3(0.0)};
  });
  EXPECT_THAT(start_error(), HasSubstr("that means anything"));
  card([](ComediState& s) { s.subdevices = {jr3(1000.0)}; });
  EXPECT_THAT(start_error(), HasSubstr("its full scale of axis 0 is 1000000"));
  options.place.library = "/nowhere/libcomedi.so.0";
  EXPECT_THAT(start_error(), HasSubstr("force sensor: comedi: /nowhere/libcomedi.so.0"));
}

// Six voltages of a card that is asked, or that streams.
class AnalogSensorTest : public ComediFtSensorTest {
 protected:
  void SetUp() override {
    ComediFtSensorTest::SetUp();
    options.kind = ComediFtKind::kAnalog;
    options.matrix = 10.0 * FtMatrix::Identity();
    card([](ComediState& s) {
      s.driver = "ni_pcimio";
      s.subdevices = multi();
    });
  }
  void make_stream() {
    card([](ComediState& s) { s.subdevices[0].flags = kComediStreams; });
  }
  // What the card converts, channel 0 first.
  void convert(const std::vector<std::uint16_t>& numbers, std::size_t leave_out = 0) {
    const int fd = card([](ComediState& s) { return s.stream_fd; });
    const std::size_t bytes = 2 * numbers.size() - leave_out;
    ASSERT_EQ(::send(fd, numbers.data(), bytes, MSG_NOSIGNAL), static_cast<ssize_t>(bytes));
  }
};

TEST_F(AnalogSensorTest, ACardThatDoesNotStreamIsAsked) {
  options.channels = {5, 4, 3, 2, 1, 0};
  options.bias[0] = 0.5;
  card([](ComediState& s) { s.subdevices[0].values[5] = 49151; });  // 4.99992 V
  ASSERT_NO_FATAL_FAILURE(start());
  ASSERT_TRUE(reads());
  EXPECT_NEAR(sample.wrench.force.x(), 45.0, 2e-3);
  card([](ComediState& s) { s.subdevices[0].values[2] = 65535; });
  EXPECT_TRUE(take_until([](const FtSample& s) { return s.status == 0x3f; }));
}

TEST_F(AnalogSensorTest, AStreamIsStartedAtTheRateAndReadScanByScan) {
  make_stream();
  options.rate = 2000.0;
  ASSERT_NO_FATAL_FAILURE(start());
  EXPECT_EQ(card([](ComediState& s) { return s.scan_period; }), 500'000u);
  EXPECT_EQ(card([](ComediState& s) { return s.scan_channels; }),
            (std::vector<unsigned int>{2u << 24, 2u << 24 | 1, 2u << 24 | 2, 2u << 24 | 3,
                                       2u << 24 | 4, 2u << 24 | 5}));
  // Two scans at once, and a part of a third: the second is the newest, and two have gone.
  convert({0, 0, 0, 0, 0, 0, 49151, 32768, 32768, 32768, 32768, 1, 9, 9}, 1);
  ASSERT_TRUE(reads());
  EXPECT_EQ(sample.sequence, 2u);
  EXPECT_NEAR(sample.wrench.force.x(), 50.0, 2e-3);
  EXPECT_NEAR(sample.wrench.torque.z(), -100.0, 4e-3);
}

TEST_F(AnalogSensorTest, AStreamThatEndsIsBegunAnew) {
  make_stream();
  ASSERT_NO_FATAL_FAILURE(start());
  convert({1, 1, 1, 1, 1, 1});
  ASSERT_TRUE(reads());
  const int fd = card([](ComediState& s) { return s.stream_fd; });
  ::shutdown(fd, SHUT_WR);
  ASSERT_TRUE(take_until([](const FtSample& s) { return s.status == kFtLost; }));
  ASSERT_TRUE(becomes([&] { return card([](ComediState& s) { return s.opened; }) == 2; }));
  ASSERT_TRUE(becomes([&] { return card([](ComediState& s) { return s.stream_fd; }) >= 0; }));
  convert({2, 2, 2, 2, 2, 2});
  EXPECT_TRUE(reads());
}

TEST_F(AnalogSensorTest, ARateThatTheCardHasNotIsNamedWithTheOneItHas) {
  make_stream();
  card([](ComediState& s) { s.most_rate = 500; });
  EXPECT_THAT(start_error(), HasSubstr("does not stream 6 channels at 1000 Hz, but at 500 Hz; "
                                       "another force_sensor.comedi.rate_hz"));
  card([](ComediState& s) {
    s.most_rate = 100'000;
    s.command_error = EBUSY;
  });
  EXPECT_THAT(start_error(), HasSubstr("its stream does not start: Device or resource busy; "
                                       "another program uses it"));
}

TEST_F(AnalogSensorTest, AChannelThatIsNotInVoltsIsNamed) {
  card([](ComediState& s) { s.subdevices[0].unit = 2; });
  EXPECT_THAT(start_error(), HasSubstr("channel 0 is not in volts"));
  options.channels[3] = 77;
  card([](ComediState& s) { s.subdevices[0].unit = 0; });
  EXPECT_THAT(start_error(), HasSubstr("subdevice 0 has no channel 77"));
}

TEST(ComediScanBytes, InWhateverPiecesTheScansAreTheSame) {
  std::vector<std::uint8_t> bytes(997);
  for (std::size_t i = 0; i < bytes.size(); ++i) bytes[i] = static_cast<std::uint8_t>(i * 37);
  for (const std::size_t each : {std::size_t{2}, std::size_t{4}}) {
    ComediScanBytes whole(6, each);
    const std::size_t scans = whole.take(bytes);
    EXPECT_EQ(scans, bytes.size() / (6 * each));
    const std::size_t at = (scans - 1) * 6 * each;
    const unsigned int first = bytes[at] + 256u * bytes[at + 1] +
                               (each == 4 ? 65536u * bytes[at + 2] + 16777216u * bytes[at + 3] : 0);
    EXPECT_EQ(whole.newest()[0], first);
    for (std::size_t piece = 1; piece < 60; ++piece) {
      ComediScanBytes parts(6, each);
      std::size_t got = 0;
      for (std::size_t i = 0; i < bytes.size(); i += piece) {
        got += parts.take(std::span(bytes).subspan(i).first(std::min(piece, bytes.size() - i)));
      }
      ASSERT_EQ(got, scans) << piece;
      ASSERT_TRUE(std::equal(parts.newest().begin(), parts.newest().end(), whole.newest().begin()));
    }
  }
}

}  // namespace
}  // namespace handrail
