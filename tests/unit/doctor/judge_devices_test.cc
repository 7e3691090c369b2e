// Devices: those that the given files name, and what master and slave say of theirs.
#include "client/doctor/report.h"
#include "tests/unit/doctor/doctor_samples.h"

namespace handrail {
namespace {

using test::expect_found;
using test::found;
using test::healthy;
using test::says;
using test::status;

TEST(DoctorDevices, WhatIsNotReadyIsAProblemWithItsPlaceAndNextStep) {
  DoctorFacts facts = healthy();
  facts.devices = {
      {"melfa", {{"192.168.0.20:10000", Readiness::kAbsent, "no answer", "switch on"}}},
      {"net-ft", {{"192.168.0.30:49152", Readiness::kReady, "it streams", ""}}},
      {"stop-switch", {{"", Readiness::kUnfinished, "no permission", "usermod"}}}};
  expect_found(facts, "device.melfa", Level::kProblem, "192.168.0.20:10000: no answer",
               "switch on");
  expect_found(facts, "device.net-ft", Level::kOk, "192.168.0.30:49152: it streams", "");
  expect_found(facts, "device.stop-switch", Level::kProblem, "no permission", "usermod");
}

TEST(DoctorDevices, AFileThatCannotBeReadIsAProblem) {
  DoctorFacts facts = healthy();
  EXPECT_FALSE(says(facts, "device.configuration"));
  facts.devices_problem = "slave.conf: no such file";
  expect_found(facts, "device.configuration", Level::kProblem, "slave.conf: no such file",
               "correct that file");
}

TEST(DoctorDevices, TheMastersDeviceIsNamedAndWhetherItIsSimulated) {
  DoctorFacts facts = healthy();
  expect_found(facts, "device.hand", Level::kOk, "the master's device is Phantom Omni, simulated",
               "");
  status(facts).set_device("SpaceMouse");
  status(facts).set_device_simulated(false);
  EXPECT_EQ(found(facts, "device.hand").fact, "the master's device is SpaceMouse");
  status(facts).set_device_trouble("it is unplugged");
  expect_found(facts, "device.hand", Level::kProblem,
               "the master's device is SpaceMouse: it is unplugged",
               "'handrail status' shows when it is heard again");
  facts.master.status.reset();
  EXPECT_FALSE(says(facts, "device.hand"));
}

TEST(DoctorDevices, ASensorOnTheHandleIsNamedAndWhyItHasNoReading) {
  DoctorFacts facts = healthy();
  EXPECT_FALSE(says(facts, "device.handle"));
  pb::HandleStatus& handle = *status(facts).mutable_handle();
  handle.set_state("silent");
  expect_found(facts, "device.handle", Level::kNote, "the force sensor on the handle: silent",
               "handrail devices test handle-ft");
  handle.set_state("sound");
  handle.set_simulated(true);
  handle.mutable_force()->set_magnitude_n(0.0);
  expect_found(facts, "device.handle", Level::kOk,
               "the force sensor on the handle, simulated: sound", "");
}

TEST(DoctorDevices, ASensorWithoutSoundReadingsIsANoteWhereThereIsASlave) {
  DoctorFacts facts = healthy();
  EXPECT_EQ(found(facts, "device.sensor").level, Level::kOk);
  status(facts).set_has_contact_force(false);
  expect_found(facts, "device.sensor", Level::kNote, "no sound reading", "handrail devices test");
  status(facts).set_packet_age_ms(5000.0);
  EXPECT_FALSE(says(facts, "device.sensor"));
  status(facts).set_packet_age_ms(0.4);
  status(facts).mutable_walls();
  EXPECT_FALSE(says(facts, "device.sensor"));
}

}  // namespace
}  // namespace handrail
