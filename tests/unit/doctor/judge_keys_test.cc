#include "tests/unit/doctor/doctor_samples.h"

namespace handrail {
namespace {

using test::entry;
using test::expect_found;
using test::found;
using test::healthy;
using test::says;

TEST(DoctorKeys, OfAHealthyPairNothingIsWrong) {
  const DoctorFacts facts = healthy();
  for (const Finding& finding : judge(facts)) {
    const bool idle = finding.check == "session.state";  // "engage" is no fault
    EXPECT_EQ(finding.level, Level::kOk) << finding.check << ": " << finding.fact;
    EXPECT_EQ(finding.next.empty(), !idle) << finding.check << ": " << finding.next;
  }
  const std::string own = found(facts, "keys.own").fact;
  EXPECT_THAT(own, testing::HasSubstr(key_id(facts.keys.own->key)));
  EXPECT_THAT(own, testing::HasSubstr("called desk, as master, made 3 days ago, mode 0600"));
  EXPECT_THAT(found(facts, "keys.trusted").fact, testing::HasSubstr("cell as slave, key "));
}

TEST(DoctorKeys, WithoutAKeyTheEncryptedLinkCannotBe) {
  DoctorFacts facts = healthy();
  facts.keys.has_key = false;
  facts.keys.own.reset();
  expect_found(facts, "keys.own", Level::kProblem, "no key in /home/eve",
               "handrail keys new master");
  facts.master.status->mutable_peer()->set_encrypted(false);
  expect_found(facts, "keys.own", Level::kNote, "no key in /home/eve", "handrail keys new master");
  facts.master.status.reset();
  facts.programs = {{"handrail-slave", 7, false, 2, true}};
  expect_found(facts, "keys.own", Level::kNote, "no key", "handrail keys new slave");
  facts.programs[0].calls_network = true;
  expect_found(facts, "keys.own", Level::kProblem, "no key", "handrail keys new slave");
}

TEST(DoctorKeys, AKeyThatOthersCanReadIsNamedWithBothModes) {
  DoctorFacts facts = healthy();
  facts.keys.key_is_private = false;
  facts.keys.key_mode = "0644";
  facts.keys.own.reset();
  expect_found(facts, "keys.own", Level::kProblem, "/key has mode 0644, expected 0600",
               "chmod 600 /home/eve/.config/handrail/key");
}

TEST(DoctorKeys, AKeyThatCannotBeReadIsQuoted) {
  DoctorFacts facts = healthy();
  facts.keys.own.reset();
  facts.keys.own_problem = "/key: the first line is 'x': expected handrail NAME ROLES";
  expect_found(facts, "keys.own", Level::kProblem, "the first line is 'x'", "handrail keys new");
}

TEST(DoctorKeys, AListThatOthersCanWriteOrThatIsGarbledIsAProblem) {
  DoctorFacts facts = healthy();
  facts.keys.trusted.reset();
  facts.keys.trusted_problem = "/trusted: line 3: 'p256:x' is no key";
  expect_found(facts, "keys.trusted", Level::kProblem, "line 3", "mend that line");
  facts.keys.trusted_is_ours_to_write = false;
  facts.keys.trusted_mode = "0666";
  expect_found(facts, "keys.trusted", Level::kProblem, "mode 0666, expected 0600",
               "chmod 600 /home/eve/.config/handrail/trusted");
}

TEST(DoctorKeys, SomebodyMustBeTrustedInARoleThatWorksWithOurs) {
  struct Case {
    Role ours, theirs;
    bool works;
    const char* wanted;
  };
  for (const Case& c : {Case{Role::kMaster, Role::kSlave, true, ""},
                        Case{Role::kMaster, Role::kMaster, false, "slave"},
                        Case{Role::kMaster, Role::kOperator, false, "slave"},
                        Case{Role::kSlave, Role::kMaster, true, ""},
                        Case{Role::kSlave, Role::kOperator, false, "master"},
                        Case{Role::kOperator, Role::kMaster, true, ""},
                        Case{Role::kObserver, Role::kSlave, false, "master"}}) {
    DoctorFacts facts = healthy();
    facts.keys.own->roles = c.ours;
    facts.keys.trusted = TrustList();
    ASSERT_TRUE(facts.keys.trusted->add(entry("other", c.theirs)));
    if (c.works) {
      expect_found(facts, "keys.partner", Level::kOk, "other can work with our key", "");
    } else {
      expect_found(facts, "keys.partner", Level::kProblem,
                   std::string("nobody is trusted here as ") + c.wanted,
                   std::string("on the ") + c.wanted + "'s computer: handrail keys show");
    }
    facts.master.status->mutable_peer()->set_encrypted(false);
    EXPECT_EQ(found(facts, "keys.partner").level, c.works ? Level::kOk : Level::kNote);
  }
}

TEST(DoctorKeys, WhereThereIsNothingAtAllOneLineIsEnough) {
  DoctorFacts facts = healthy();
  facts.keys.has_key = false;
  facts.keys.own.reset();
  facts.keys.trusted = TrustList();
  EXPECT_TRUE(says(facts, "keys.own"));
  EXPECT_FALSE(says(facts, "keys.trusted"));
  EXPECT_FALSE(says(facts, "keys.partner"));
}

}  // namespace
}  // namespace handrail
