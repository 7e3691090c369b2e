#include "server/keys/pairing/pairing.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/unit/keys_pairing/pairing_samples.h"

namespace handrail {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using Side = Pairing::Side;

class PairingTest : public ::testing::Test {
 protected:
  void begin(const std::string& at_cell, const std::string& at_desk) {
    cell.begin(Side::kListens, at_cell);
    desk.begin(Side::kCalls, at_desk);
  }
  void nothing_is_kept() {
    EXPECT_THAT(cell.kept, IsEmpty());
    EXPECT_THAT(desk.kept, IsEmpty());
  }
  std::string at_cell() { return cell.pairing->result().message(); }
  std::string at_desk() { return desk.pairing->result().message(); }

  PairingEnd cell{"cell", Role::kSlave}, desk{"desk", Role::kMaster};
};

TEST_F(PairingTest, WithOneCodeBothKeepTheOthersKey) {
  begin("4829137", "4829137");
  const std::size_t bytes = converse(*cell.pairing, *desk.pairing);
  EXPECT_TRUE(cell.pairing->over() && desk.pairing->over());
  EXPECT_TRUE(cell.pairing->result()) << at_cell();
  EXPECT_TRUE(desk.pairing->result()) << at_desk();
  EXPECT_THAT(cell.kept, ElementsAre(desk.own));
  EXPECT_THAT(desk.kept, ElementsAre(cell.own));
  EXPECT_EQ(*cell.pairing->other(), desk.own);
  EXPECT_LT(bytes, 3000u);
}

TEST_F(PairingTest, ComesInAnyPieces) {
  for (const std::size_t step : {1u, 7u, 500u}) {
    cell.kept.clear();
    begin("4829137", "4829137");
    converse(*cell.pairing, *desk.pairing, step);
    EXPECT_THAT(cell.kept, ElementsAre(desk.own)) << step;
    EXPECT_TRUE(desk.pairing->result()) << at_desk();
  }
}

TEST_F(PairingTest, AWrongCodeEndsItAtBothSides) {
  begin("4829137", "4829138");
  converse(*cell.pairing, *desk.pairing);
  EXPECT_TRUE(cell.pairing->over() && desk.pairing->over());
  EXPECT_THAT(at_cell(), HasSubstr("gave a wrong code"));
  EXPECT_THAT(at_desk(), HasSubstr("the code is wrong"));
  EXPECT_TRUE(cell.pairing->guessed());
  EXPECT_EQ(cell.pairing->other(), nullptr);
  nothing_is_kept();
}

// Who answers a caller without its code gets one guess too, and neither key.
TEST_F(PairingTest, WhoOnlyClaimsToKnowTheCodeLearnsNoKey) {
  begin("0000000", "4829137");
  converse(*cell.pairing, *desk.pairing);
  EXPECT_THAT(at_desk(), HasSubstr("the code is wrong"));
  EXPECT_EQ(desk.pairing->other(), nullptr);
  EXPECT_EQ(cell.pairing->other(), nullptr);
  nothing_is_kept();
}

TEST_F(PairingTest, WhoSaysNothingAfterOurAnswerHasNotGuessed) {
  begin("4829137", "4829137");
  cell.pairing->take(desk.pairing->give());
  EXPECT_FALSE(cell.pairing->give().empty());
  EXPECT_FALSE(cell.pairing->guessed());
  cell.pairing->end();
  EXPECT_FALSE(cell.pairing->guessed());
  EXPECT_THAT(at_cell(), HasSubstr("ended the connection"));
}

TEST_F(PairingTest, WhoSpeaksAfterOurAnswerMayHaveGuessed) {
  begin("4829137", "4829137");
  cell.pairing->take(desk.pairing->give());
  (void)cell.pairing->give();
  cell.pairing->take(std::vector<std::uint8_t>{22});
  EXPECT_TRUE(cell.pairing->guessed());
}

TEST_F(PairingTest, GarbageIsNoGuessAndIsSaid) {
  for (const std::string& text : {std::string("GET / HTTP/1.1\r\n\r\n"), std::string(2000, '\xff'),
                                  std::string("\x16\x03\x01\xff\xff\x01\x00\xff\xff", 9),
                                  std::string("\x15\x03\x03\0\x02\x02\x28", 7)}) {
    begin("4829137", "4829137");
    const auto* bytes = reinterpret_cast<const std::uint8_t*>(text.data());
    cell.pairing->take({bytes, text.size()});
    EXPECT_TRUE(cell.pairing->over());
    EXPECT_FALSE(cell.pairing->guessed());
    EXPECT_THAT(at_cell(), HasSubstr("the other side does not pair"));
    desk.pairing->take({bytes, text.size()});
    EXPECT_TRUE(desk.pairing->over());
    EXPECT_THAT(at_desk(), HasSubstr("the other side does not pair"));
    nothing_is_kept();
  }
}

TEST_F(PairingTest, MoreBytesThanAPairingHasEndIt) {
  begin("4829137", "4829137");
  // The begin of a record of 16 kB.
  std::vector<std::uint8_t> bytes(Pairing::kMostBytes + 1);
  bytes = {22, 3, 1, 0x40, 0};
  bytes.resize(Pairing::kMostBytes + 1);
  cell.pairing->take(bytes);
  EXPECT_TRUE(cell.pairing->over());
  EXPECT_THAT(at_cell(), HasSubstr("more than 16384 bytes"));
}

TEST_F(PairingTest, AByteThatIsChangedAnywhereOnItsWayEndsIt) {
  const auto run = [&](std::size_t at) {
    cell.kept.clear();
    desk.kept.clear();
    begin("4829137", "4829137");
    for (std::size_t carried = 0; !cell.pairing->over();) {
      auto bytes = desk.pairing->give();
      if (at >= carried && at < carried + bytes.size()) bytes[at - carried] ^= 0x10;
      carried += bytes.size();
      cell.pairing->take(bytes);
      const auto back = cell.pairing->give();
      if (bytes.empty() && back.empty()) cell.pairing->end();
      desk.pairing->take(back);
    }
    return static_cast<bool>(cell.pairing->result());
  };
  ASSERT_TRUE(run(100000));
  for (std::size_t at = 0; at < 700; at += 13) {
    EXPECT_FALSE(run(at)) << at;
    nothing_is_kept();
  }
}

TEST_F(PairingTest, TheSameKeyOrRolesThatDoNotMeetAreRefusedAtBothSides) {
  for (const auto& [mine, theirs] : {std::pair{Role::kSlave, Role::kSlave},
                                     {Role::kMaster, Role::kMaster},
                                     {Role::kSlave, Role::kOperator},
                                     {Role::kObserver, Role::kOperator}}) {
    cell.own.roles = mine;
    desk.own.roles = theirs;
    begin("4829137", "4829137");
    converse(*cell.pairing, *desk.pairing);
    EXPECT_THAT(at_cell() + at_desk(), HasSubstr("has nothing to say to a"));
    EXPECT_FALSE(cell.pairing->result() || desk.pairing->result());
    nothing_is_kept();
  }
  desk.own = {"desk", Role::kMaster, cell.own.key};
  begin("4829137", "4829137");
  converse(*cell.pairing, *desk.pairing);
  EXPECT_THAT(at_cell() + at_desk(), HasSubstr("both sides show the same key"));
  nothing_is_kept();
}

TEST_F(PairingTest, AMasterPairsWithItsOperatorsAndObservers) {
  cell = {"ben", Role::kObserver};
  begin("4829137", "4829137");
  converse(*cell.pairing, *desk.pairing);
  EXPECT_TRUE(cell.pairing->result() && desk.pairing->result()) << at_desk();
}

TEST_F(PairingTest, WhoCannotTakeTheKeySaysWhyAndNeitherKeepsOne) {
  for (PairingEnd* end : {&cell, &desk}) {
    end->check = Status::error("'desk' is here \x1b[2J already");
    begin("4829137", "4829137");
    converse(*cell.pairing, *desk.pairing);
    PairingEnd& other = end == &cell ? desk : cell;
    EXPECT_THAT(end->pairing->result().message(), HasSubstr("is here"));
    EXPECT_THAT(other.pairing->result().message(),
                HasSubstr("the other side refuses: 'desk' is here ?[2J already"));
    nothing_is_kept();
    end->check = Status::ok();
  }
}

TEST_F(PairingTest, AListenerThatCannotWriteSaysSoAndTheCallerKeepsNothing) {
  cell.keep = Status::error("the disk is full");
  begin("4829137", "4829137");
  converse(*cell.pairing, *desk.pairing);
  EXPECT_THAT(at_desk(), HasSubstr("the other side refuses: the disk is full"));
  nothing_is_kept();
}

TEST_F(PairingTest, ACallerThatCannotWriteSaysThatTheOtherSideHas) {
  desk.keep = Status::error("the disk is full");
  begin("4829137", "4829137");
  converse(*cell.pairing, *desk.pairing);
  EXPECT_THAT(at_desk(), HasSubstr("the disk is full; the other side trusts this key already"));
  EXPECT_THAT(cell.kept, ElementsAre(desk.own));
}

TEST_F(PairingTest, ACallerThatHearsNoVerdictSaysWhereToLook) {
  begin("4829137", "4829137");
  cell.pairing->take(desk.pairing->give());
  desk.pairing->take(cell.pairing->give());
  cell.pairing->take(desk.pairing->give());
  desk.pairing->take(cell.pairing->give());  // the listener's key
  cell.pairing->take(desk.pairing->give());  // ... is taken
  EXPECT_TRUE(cell.pairing->result());
  desk.pairing->end();
  EXPECT_THAT(at_desk(), HasSubstr("`handrail keys list` says so there"));
  EXPECT_THAT(desk.kept, IsEmpty());
}

}  // namespace
}  // namespace handrail
