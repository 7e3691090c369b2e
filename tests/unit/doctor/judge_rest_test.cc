// Programs, session, real time, machine and clocks; and the report.
#include "client/doctor/report.h"
#include "tests/unit/doctor/doctor_samples.h"

namespace handrail {
namespace {

using test::expect_found;
using test::found;
using test::healthy;
using test::says;
using test::status;

DoctorFacts without_master() {
  DoctorFacts facts = healthy();
  facts.master.status.reset();
  facts.master.problem = "no such socket";
  facts.master.absent = true;
  facts.route.reset();
  return facts;
}

TEST(DoctorPrograms, WithoutAnyDaemonTheRestIsChecked) {
  const DoctorFacts facts = without_master();
  expect_found(facts, "programs.master", Level::kNote, "runs here (no such socket)",
               "handrail-slave --link any");
  EXPECT_TRUE(says(facts, "keys.partner") && says(facts, "realtime.shell"));
  EXPECT_FALSE(says(facts, "link.peer") || says(facts, "session.state"));
  EXPECT_EQ(doctor_report(judge(facts)).problems(), 0u);
}

TEST(DoctorPrograms, OnTheArmsComputerTheMasterIsElsewhere) {
  DoctorFacts facts = without_master();
  facts.programs = {{"handrail-slave", 4711, true, 2, true}};
  expect_found(facts, "programs.master", Level::kNote, "a slave runs here and no master",
               "on the master's computer");
  expect_found(facts, "programs.slave", Level::kOk, "process 4711", "");
}

TEST(DoctorPrograms, AMasterOnAnotherSocketIsNamedAndOneThatDoesNotAnswerIsAProblem) {
  DoctorFacts facts = without_master();
  facts.programs = {{"handrail-master", 4711, false, 2, true},
                    {"handrail-master", 4712, false, 2, true}};
  expect_found(facts, "programs.master", Level::kNote,
               "(processes 4711, 4712), but not on this socket (no such socket)", "--socket PATH");
  facts.master.absent = false;
  facts.master.problem = "no answer in time";
  expect_found(facts, "programs.master", Level::kProblem, "no answer in time", "start it anew");
}

TEST(DoctorPrograms, DifferentVersionsAreSaidWithBothValues) {
  DoctorFacts facts = healthy();
  facts.version = "0.2.0";
  expect_found(facts, "programs.version", Level::kNote,
               "this program is of version 0.2.0 (wire version 8), the master of 0.1.0 (wire",
               "start the master anew");
  EXPECT_EQ(found(facts, "programs.slave_version").level, Level::kOk);
  status(facts).mutable_slave_program()->set_version("0.0.9");
  expect_found(
      facts, "programs.slave_version", Level::kNote,
      "the master is of version 0.1.0 (wire version 8), the slave of 0.0.9 (wire version 8)",
      "both computers");
  status(facts).mutable_program()->Clear();
  expect_found(facts, "programs.version", Level::kNote, "the master of one that is too old to say",
               "start the master anew");
}

TEST(DoctorPrograms, AnotherWireVersionOfTheSlaveIsAProblem) {
  DoctorFacts facts = healthy();
  status(facts).mutable_slave_program()->Clear();
  status(facts).mutable_slave_program()->set_wire_version(9);
  expect_found(facts, "programs.slave_version", Level::kProblem,
               "the slave speaks wire version 9, the master 8", "install the same Handrail");
  EXPECT_FALSE(says(facts, "link.peer"));
}

TEST(DoctorSession, AnotherSceneIsNamedWithBothValues) {
  DoctorFacts facts = healthy();
  EXPECT_EQ(found(facts, "scene.same").level, Level::kOk);
  status(facts).add_hash_mismatch("scene: master 'a', slave 'b'");
  expect_found(facts, "scene.same", Level::kProblem, "scene: master 'a', slave 'b'",
               "handrail scene load linear-movement");
}

TEST(DoctorSession, WhatIsLatchedIsAProblemAndAnEngageIsNone) {
  DoctorFacts facts = healthy();
  EXPECT_EQ(found(facts, "session.state").level, Level::kOk);
  status(facts).mutable_ledger()->set_way_out("wait");
  EXPECT_EQ(found(facts, "session.state").level, Level::kNote);
  status(facts).set_slave_state("fault");
  status(facts).mutable_ledger()->set_sentence("the arm holds: robot lost");
  status(facts).mutable_ledger()->set_way_out("reset, then engage");
  expect_found(facts, "session.state", Level::kProblem, "the slave's fault: the arm holds: robot",
               "reset, then engage");
}

TEST(DoctorSession, WithoutASlaveOnlyWhatIsLatchedIsSaid) {
  DoctorFacts facts = healthy();
  status(facts).mutable_peer()->set_problem("nobody answers");
  EXPECT_FALSE(says(facts, "session.state"));
  status(facts).set_slave_state("fault");
  EXPECT_FALSE(says(facts, "session.state")) << "what it said last is old";
  status(facts).set_state("fault");
  expect_found(facts, "session.state", Level::kProblem, "session fault: the arm holds",
               "first what is said of the link; then handrail reset");
}

TEST(DoctorRealtime, TheShellsPermissionIsSaidWithItsLimits) {
  DoctorFacts facts = healthy();
  expect_found(facts, "realtime.shell", Level::kOk, "(ulimit -r: 90)", "");
  EXPECT_THAT(found(facts, "realtime.shell").fact, testing::HasSubstr("(ulimit -l: unlimited)"));
  for (bool MachineFacts::*lacks : {&MachineFacts::may_fifo, &MachineFacts::may_lock}) {
    DoctorFacts without = healthy();
    without.machine.*lacks = false;
    expect_found(without, "realtime.shell", Level::kNote, "may NOT", "the line for root");
  }
}

TEST(DoctorRealtime, ADaemonWithoutItIsAProblemWithARealDevice) {
  using Setter = void (pb::ProgramStatus::*)(bool);
  for (const Setter set :
       {&pb::ProgramStatus::set_control_fifo, &pb::ProgramStatus::set_memory_locked,
        &pb::ProgramStatus::set_io_fifo}) {
    DoctorFacts facts = healthy();
    (status(facts).mutable_program()->*set)(false);
    (status(facts).mutable_slave_program()->*set)(false);
    expect_found(facts, "realtime.master", Level::kNote, "NOT", "start it anew from this shell");
    expect_found(facts, "realtime.slave", Level::kNote, "NOT", "on the slave's computer");
    facts.machine.may_fifo = false;
    EXPECT_EQ(found(facts, "realtime.master").next, "the line for root");
    status(facts).set_device_simulated(false);
    EXPECT_EQ(found(facts, "realtime.master").level, Level::kProblem);
    EXPECT_EQ(found(facts, "realtime.slave").level, Level::kProblem);
  }
}

TEST(DoctorRealtime, OfADaemonThatTellsNobodyItIsSeenFromOutside) {
  DoctorFacts facts = without_master();
  facts.programs = {{"handrail-slave", 4711, true, 2, true}};
  expect_found(facts, "realtime.slave", Level::kOk, "(process 4711): 2 threads", "");
  facts.programs[0].fifo_threads = 1;
  expect_found(facts, "realtime.slave", Level::kNote, "expected at least 2", "start it anew");
  facts.programs[0] = {"handrail-master", 4711, false, 2, false};
  expect_found(facts, "realtime.master", Level::kNote, "memory NOT locked", "start it anew");
}

TEST(DoctorMachine, WhatTakesTimeIsNamed) {
  DoctorFacts facts = healthy();
  facts.machine.governors = {"performance", "powersave"};
  expect_found(facts, "machine.governor", Level::kNote,
               "performance, powersave, expected performance",
               "cpupower frequency-set -g performance");
  facts.machine.governors.clear();
  EXPECT_FALSE(says(facts, "machine.governor")) << "not known";
  facts.machine.stolen_share = 0.011;
  expect_found(facts, "machine.time", Level::kNote, "1.1 % of a processor stolen", "others do not");
  facts.machine.stolen_share = 0.01;
  expect_found(facts, "machine.time", Level::kOk, "1.0 % of a processor stolen", "");
  facts.machine.pauses = 2;
  facts.machine.longest_pause_ms = 61.0;
  expect_found(facts, "machine.time", Level::kNote, "2 pauses of 20 ms or more, the longest 61 ms",
               "others do not");
}

TEST(DoctorClock, CalendarsThatAreApartAreSaidWithBothValues) {
  DoctorFacts facts = healthy();
  EXPECT_EQ(found(facts, "clock.calendar").level, Level::kOk);
  status(facts).mutable_slave_program()->set_calendar_s(1.7e9 - 2.5);
  expect_found(facts, "clock.calendar", Level::kNote,
               "here says 2023-11-14 22:13:20 UTC, the slave's computer 2023-11-14 22:13:17 UTC: "
               "2.5 s apart",
               "timedatectl set-ntp true");
  status(facts).mutable_slave_program()->set_calendar_s(1.7e9 + 3601.0);
  EXPECT_EQ(found(facts, "clock.calendar").level, Level::kProblem);
  facts.machine.calendar_is_kept = false;
  expect_found(facts, "clock.kept", Level::kNote, "no time server", "timedatectl");
}

TEST(DoctorClock, ASlowSourceIsNamed) {
  DoctorFacts facts = healthy();
  for (const char* slow : {"hpet", "acpi_pm", "jiffies", "refined-jiffies", "pit"}) {
    facts.machine.clock_source = slow;
    expect_found(facts, "clock.source", Level::kNote, slow, "dmesg");
  }
  facts.machine.clock_source = "kvm-clock";
  expect_found(facts, "clock.source", Level::kOk, "kvm-clock", "");
}

TEST(DoctorReport, ALineToTypeIsWholeAndTheFactIsNotWiderThanAPage) {
  const Findings findings = {
      {"keys.own", Level::kProblem, std::string(40, 'a') + " " + std::string(120, 'b') + " c",
       std::string(150, 'x') + " y"},
      {"link.peer", Level::kOk, "there", ""},
      {"clock.kept", Level::kNote, "not kept", "z"}};
  const std::string row(9, ' ');
  EXPECT_EQ(doctor_text(findings),
            "PROBLEM  keys.own: " + std::string(40, 'a') + "\n" + row + std::string(120, 'b') +
                "\n" + row + "c\n" + row + "-> " + std::string(150, 'x') + " y\n" +
                "ok       link.peer: there\nNOTE     clock.kept: not kept\n" + row +
                "-> z\n1 problem, 1 note\n");
  const pb::DoctorReport report = doctor_report(findings);
  EXPECT_EQ(report.problems(), 1u);
  EXPECT_EQ(report.notes(), 1u);
  ASSERT_EQ(report.findings_size(), 3);
  EXPECT_EQ(report.findings(0).level(), pb::DoctorFinding::PROBLEM);
  EXPECT_EQ(report.findings(2).next(), "z");
}

}  // namespace
}  // namespace handrail
