// What the log, status and `why` say of a device whose readings are not valid.
#include "server/master/handle/device_watch.h"

#include <gtest/gtest.h>

#include "server/master/status_report.h"

namespace handrail {
namespace {

const DeviceTrouble kPulled = fixed_text<DeviceTrouble>("it is unplugged");
const DeviceTrouble kUnhomed = fixed_text<DeviceTrouble>("it is not homed");

TEST(DeviceWatch, SaysEachTroubleOnceAndItsEndButAtMostOneLineASecond) {
  DeviceWatch watch;
  EXPECT_FALSE(watch.line(kSecond, DeviceTrouble()));
  EXPECT_EQ(watch.line(2 * kSecond, kPulled), "haptic device: it is unplugged");
  EXPECT_FALSE(watch.line(9 * kSecond, kPulled));
  EXPECT_EQ(watch.line(10 * kSecond, kUnhomed), "haptic device: it is not homed");
  EXPECT_FALSE(watch.line(10 * kSecond + 999 * kMillisecond, DeviceTrouble()));
  EXPECT_EQ(watch.line(11 * kSecond, DeviceTrouble()),
            "haptic device: its readings are valid again");
}

class TroubleReportTest : public ::testing::Test {
 protected:
  TroubleReportTest() {
    report.trouble = kPulled;
    report.out.reasons.add(Reason::kDeviceInvalid);
    report.out.obstacle = report.out.reason = Reason::kDeviceInvalid;
    link.peer_epoch = 1;
    link.received_at = now - kMillisecond;
  }
  pb::Status status() const { return status_report({}, report, slave, link, now); }

  const std::string told = std::string(describe(Reason::kDeviceInvalid)) + ": it is unplugged";
  HapticReport report;
  SlaveState slave;
  LinkSnapshot link;
  Nanos now = 50 * kSecond;
};

TEST_F(TroubleReportTest, WhatTheDeviceSaysIsInStatusReasonAndWhy) {
  const pb::Status s = status();
  EXPECT_EQ(s.device_trouble(), "it is unplugged");
  EXPECT_EQ(s.reason(), told);
  ASSERT_EQ(s.interventions_size(), 1);
  EXPECT_EQ(s.interventions(0), told);
  EXPECT_EQ(s.ledger().sentence(), "the arm holds: " + told);
}

TEST_F(TroubleReportTest, ADeviceThatSaysNothingAddsNothing) {
  report.trouble = DeviceTrouble();
  EXPECT_FALSE(status().has_device_trouble());
  EXPECT_EQ(status().reason(), describe(Reason::kDeviceInvalid));
  EXPECT_EQ(reason_text(Reason::kClutched, report), describe(Reason::kClutched));
  report.trouble = kPulled;
  EXPECT_EQ(reason_text(Reason::kClutched, report), describe(Reason::kClutched));
}

}  // namespace
}  // namespace handrail
