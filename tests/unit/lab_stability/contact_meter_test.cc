#include "server/lab/stability/contact_meter.h"

#include <gtest/gtest.h>

namespace handrail {
namespace {

TEST(ContactMeter, AContactBeginsAnewWhenNoForceWasAskedFor) {
  ContactMeter meter(false, 0.0);
  meter.add(true, 1.0, 2.0, 0.5, 0.0);
  meter.add(true, 1.0, -1.0, 0.0, 0.0);
  meter.add(false, 1.0, 0.0, 9.0, 0.0);
  meter.add(true, 1.0, 1.25, 0.0, 0.0);
  EXPECT_EQ(meter.contacts(), 2);
  EXPECT_EQ(meter.worst(), 1.5);
  EXPECT_EQ(meter.over(), 1.5);
}

TEST(ContactMeter, AWholeRunIsOneAccount) {
  ContactMeter meter(true, 0.0);
  meter.add(true, 1.0, 2.0, 0.5, 0.0);
  meter.add(false, 1.0, 0.0, 9.0, 0.0);
  meter.add(true, 1.0, 1.0, 0.0, 0.0);
  EXPECT_EQ(meter.worst(), 2.5);
}

TEST(ContactMeter, ATickThatIsLateAllowsForWhatItMayMakeInItsContact) {
  ContactMeter meter(false, 0.0);
  meter.add(false, 1.0, 0.0, 0.0, 0.75);  // it goes in meanwhile
  meter.add(true, 1.0, 1.0, 0.0, 0.0);
  meter.add(true, 1.0, 1.0, 0.0, 0.5);
  EXPECT_EQ(meter.worst(), 2.0);
  EXPECT_EQ(meter.over(), 0.75);
  meter.add(false, 1.0, 0.0, 0.0, 0.0);
  meter.add(true, 1.0, 1.0, 0.0, 0.0);
  EXPECT_EQ(meter.over(), 1.0) << "not for the next";
}

TEST(Swing, IsFromSideToSideAlongTheAxisWhereThatIsMore) {
  Swing swing;
  EXPECT_EQ(swing.peak_to_peak(), 0.0);
  swing.add({1.0, 5.0});
  swing.add({3.0, 5.5});
  EXPECT_EQ(swing.peak_to_peak(), 2.0);
  EXPECT_EQ(swing.mean(), Vec2(2.0, 5.25));
}

TEST(ContactMeter, WhatACountHidesMayBeGiven) {
  ContactMeter meter(false, 0.5);
  meter.add(true, 2.0, 3.0, 0.0, 0.0);
  EXPECT_DOUBLE_EQ(meter.over(), 3.0 - 2.0 * 0.5);
  meter.add(false, 0.0, 0.0, 0.0, 0.0);
  meter.add(true, 1.0, 3.0, 0.0, 0.0);
  EXPECT_DOUBLE_EQ(meter.over(), 3.0 - 1.0 * 0.5) << "of this contact's force";
}

}  // namespace
}  // namespace handrail
