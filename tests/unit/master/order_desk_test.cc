// What operators' requests become, and when and how they are answered.
#include "server/master/order_desk.h"

#include <gmock/gmock.h>

#include "tests/unit/master/desk_bench.h"

namespace handrail {
namespace {

using ::testing::HasSubstr;
using ::testing::StartsWith;

class OrderDeskTest : public DeskBench {};

TEST_F(OrderDeskTest, RefusesTheStatusBeforeTheLoopHasSpoken) {
  EXPECT_EQ(text(ask("status: true")), "refused: the haptic loop has not started yet");
  tick();
  const Answer answer = ask("status: true");
  EXPECT_EQ(text(answer), "done: ");
  EXPECT_EQ((*answer)->status().ticks(), 1u);
  EXPECT_EQ((*answer)->status().time_s(), to_seconds(now));
}

TEST_F(OrderDeskTest, AnswersPlainOrdersOnceTheLoopTookThem) {
  const std::pair<const char*, OrderKind> orders[] = {{"disengage: true", OrderKind::kDisengage},
                                                      {"clutch: true", OrderKind::kClutchOn},
                                                      {"clutch: false", OrderKind::kClutchOff},
                                                      {"tool_off {}", OrderKind::kToolOff},
                                                      {"tool { kind: POINT }", OrderKind::kTool}};
  for (const auto& [request, kind] : orders) {
    EXPECT_EQ(at_once(request), "done: ") << request;
    EXPECT_EQ(last_order(), kind) << request;
  }
}

TEST_F(OrderDeskTest, AnEngageWaitsThreeSecondsForAGoodLink) {
  tick();
  const Answer answer = ask("engage: true");
  for (int i = 0; i < 200 && !answer->has_value(); ++i) {
    loop(Reason::kLinkQuality);
    tick(10 * kMillisecond);
  }
  EXPECT_FALSE(answer->has_value());
  EXPECT_GT(taken.size(), 50u) << "it is tried again";
  loop();
  stand(SessionState::kEngaged, Desired::kEngaged);
  for (int i = 0; i < 5; ++i) {
    tick(10 * kMillisecond);
    loop();
  }
  EXPECT_EQ(text(answer), "done: ");
  report.out.link_window = kSecond;
  report.out.link_shares.heard = 1.0;
  report.out.link_shares.lost = 0.603;
  const Answer late = ask("engage: true");
  for (int i = 0; i < 320; ++i) {
    loop(Reason::kLinkQuality);
    tick(10 * kMillisecond);
  }
  EXPECT_EQ(text(late), std::string("refused: ") + link_quality_text(report.out, link, now))
      << "what was measured, and what is asked";
  EXPECT_THAT(text(late), HasSubstr("60.3 % lost on the way here, at most 25 %"));
}

TEST_F(OrderDeskTest, NoOrderThatWaitsForTheLinkOutlivesAnother) {
  tick();
  const Answer answer = ask("engage: true");
  loop(Reason::kLinkQuality);
  tick();
  ask("disengage: true");
  EXPECT_EQ(text(answer), "refused: another order came before the link was good");
  loop();
  taken.clear();
  for (int i = 0; i < 10; ++i) tick(10 * kMillisecond);
  loop();
  EXPECT_TRUE(taken.empty());
}

TEST_F(OrderDeskTest, PassesOnWhatAnOrderSays) {
  at_once("tool_off { position: false }");
  EXPECT_FALSE(taken.back().order.drop_position);
  EXPECT_TRUE(taken.back().order.drop_orientation);
  at_once("tool { kind: LINE direction: [0, -1, 0] at_mm: [350, 0, 429] }");
  EXPECT_EQ(taken.back().order.tool.kind, ToolKind::kLine);
  EXPECT_TRUE(taken.back().order.tool.p_SA.isApprox(Vec3(0.35, 0, 0.429)));
  at_once("hand { displacement_mm: [10, 0, -5] rotation_deg: [0, 90, 0] duration_s: 2 }");
  ASSERT_TRUE(taken.back().is_hand);
  EXPECT_TRUE(taken.back().hand.displacement_M.isApprox(Vec3(0.010, 0, -0.005)));
  EXPECT_NEAR(taken.back().hand.rotation_M.y(), 90.0 * kDeg, 1e-12);
  EXPECT_EQ(taken.back().hand.duration, 2.0);
}

TEST_F(OrderDeskTest, RefusesAToolWithTheNameOfTheBadField) {
  EXPECT_THAT(refusal("tool { kind: LINE }"), StartsWith("refused: direction: "));
  EXPECT_THAT(refusal("tool { kind: POINT at_mm: [1, 2] }"), StartsWith("refused: at_mm"));
  EXPECT_THAT(refusal("tool { kind: POINT at_mm: [1, 2, nan] }"), StartsWith("refused: at_mm"));
  EXPECT_THAT(refusal("tool { kind: POINT stiffness_n_mm: -1 }"),
              StartsWith("refused: stiffness_n_mm"));
  EXPECT_THAT(refusal("tool { kind: N_ROTATION one_way: true }"), StartsWith("refused: one_way"));
}

TEST_F(OrderDeskTest, SaysHowFarAToolIsThatIsTooFar) {
  const std::pair<const char*, const char*> calls[] = {
      {"tool { kind: PLANE normal: [0, 0, 1] at_mm: [0, 0, -500] }", "plane"},
      {"tool { kind: LINE direction: [0, 0, 1] at_mm: [0, 0, -500] }", "line"},
      {"tool { kind: POINT at_mm: [0, 0, -500] }", "point"}};
  for (const auto& [call, name] : calls) {
    const Answer answer = ask(call);
    loop(Reason::kToolFar, 0.31019);
    tick();
    EXPECT_EQ(text(answer), "refused: the " + std::string(name) +
                                " is 310.2 mm from the tip, or from where the hand sends it, at "
                                "most 20 mm; --approach goes there");
    EXPECT_FALSE(taken.back().order.tool.approach);
  }
}

TEST_F(OrderDeskTest, SaysThatAHandHasBeenLatched) {
  for (const char* order : {"tool { kind: POINT }", "tool_off { position: true }"}) {
    for (const double off : {0.0, 0.1091}) {
      const Answer answer = ask(order);
      loop(Reason::kNone, 0.0, off);
      tick();
      const char* said = "done: the hand was 109.1 mm off and leads on from where it is";
      EXPECT_EQ(text(answer), off == 0.0 ? "done: " : said);
    }
  }
}

TEST_F(OrderDeskTest, AnApproachIsAnsweredWithItsWayAndItsTime) {
  const Answer answer =
      ask("tool { kind: PLANE normal: [0, 0, 1] at_mm: [0, 0, -500] } approach: true");
  loop(Reason::kNone, 0.31019);
  tick();
  EXPECT_EQ(text(answer), "done: 310.2 mm to go, about 5.2 s; the clutch ends it");
  EXPECT_TRUE(taken.back().order.tool.approach);
  EXPECT_EQ(refusal("tool { kind: F_ROTATION } approach: true"),
            "refused: approach: has no meaning for F_ROTATION");
}

TEST_F(OrderDeskTest, RefusesHandMovesThatAreNone) {
  for (const char* move :
       {"displacement_mm: [1, 2]", "rotation_deg: [1]", "displacement_mm: [nan, 0, 0]",
        "displacement_mm: [1001, 0, 0]", "rotation_deg: [0, 230, 0]", "duration_s: 0",
        "duration_s: -1", "duration_s: 3601", "duration_s: nan", "duration_s: inf"}) {
    EXPECT_THAT(refusal(std::string("hand { ") + move + " }"), HasSubstr("expected three numbers"))
        << move;
  }
}

TEST_F(OrderDeskTest, HandMovesAreTakenUpToTheirLimitsAndNoFurther) {
  for (const char* move : {"displacement_mm: [600, 0, -800]", "displacement_mm: [0, 1000, 0]",
                           "rotation_deg: [0, 0, -180]", "duration_s: 0.01", "duration_s: 600"}) {
    EXPECT_EQ(at_once(std::string("hand { ") + move + " }"), "done: ") << move;
  }
  for (const char* move :
       {"displacement_mm: [600, 1, -800]", "displacement_mm: [0, 1000.001, 0]",
        "rotation_deg: [0, 0, -180.001]", "duration_s: 0.00999", "duration_s: 600.001"}) {
    EXPECT_THAT(refusal(std::string("hand { ") + move + " }"),
                HasSubstr(" s, expected three numbers each, at most 1000 mm and 180 deg long, and "
                          "0.01 to 600 s"))
        << move;
  }
}

TEST_F(OrderDeskTest, PassesTheLoopsRefusalOn) {
  const Answer answer = ask("clutch: true");
  loop(Reason::kNotEngaged);
  tick();
  EXPECT_EQ(text(answer), "refused: not engaged");
}

TEST_F(OrderDeskTest, AnswersEveryoneTheirOwn) {
  const Answer first = ask("clutch: true");
  loop(Reason::kNotEngaged);
  const Answer second = ask("disengage: true");
  loop();
  tick();
  EXPECT_EQ(text(first), "refused: not engaged");
  EXPECT_EQ(text(second), "done: ");
}

TEST_F(OrderDeskTest, RefusesMoreOrdersThanTheQueueHolds) {
  std::vector<Answer> answers;
  const int most = static_cast<int>(OrderDesk::kMostOrders) + OrderDesk::kOrdersInLoop;
  for (int i = 0; i < most; ++i) answers.push_back(ask("disengage: true"));
  EXPECT_EQ(text(ask("disengage: true")), "refused: too many orders at once");
  EXPECT_EQ(text(ask("hand { displacement_mm: [1, 0, 0] }")), "refused: too many orders at once");
  for (int i = 0; i < most; ++i) {
    loop();
    tick();
  }
  for (const Answer& answer : answers) ASSERT_EQ(text(answer), "done: ");
  EXPECT_EQ(at_once("disengage: true"), "done: ");
}

TEST_F(OrderDeskTest, AnswersEngagingOnlyWhenEngaged) {
  const Answer answer = ask("engage: true");
  tick();
  loop();
  for (int i = 0; i < 500; ++i) {
    stand(SessionState::kAligning, Desired::kEngaged);
    tick();
    ASSERT_FALSE(answer->has_value());
  }
  stand(SessionState::kEngaged, Desired::kEngaged);
  tick();
  EXPECT_EQ(text(answer), "done: ");
}

TEST_F(OrderDeskTest, EngagingWithTheClutchHeldIsEngaged) {
  const Answer answer = ask("engage: true");
  loop();
  stand(SessionState::kClutched, Desired::kClutched);
  tick();
  EXPECT_EQ(text(answer), "done: ");
}

TEST_F(OrderDeskTest, RefusesEngagingWithTheReasonAndWhatDiffers) {
  slave.hashes.mapping += 1;
  slave.scene = scene_name("other");
  tick();
  const Answer answer = ask("engage: true");
  loop(Reason::kSceneDiffers);
  tick();
  EXPECT_THAT(text(answer), StartsWith("refused: master and slave have different scenes loaded; "));
  EXPECT_THAT(text(answer), HasSubstr("; scene: master 'first', slave 'other'; mapping: master "));
}

TEST_F(OrderDeskTest, SaysWhichFaultOfTheSlaveKeepsItFromEngaging) {
  report.out.peer_fault = Reason::kRobotLost;
  tick();
  const Answer answer = ask("engage: true");
  loop(Reason::kPeerFault);
  tick();
  EXPECT_EQ(text(answer), std::string("refused: ") + describe(Reason::kPeerFault) + ": " +
                              describe(Reason::kRobotLost));
}

TEST_F(OrderDeskTest, GivesEngagingUpWhenTheLoopDoes) {
  const Answer answer = ask("engage: true");
  loop();
  stand(SessionState::kAligning, Desired::kEngaged);
  tick();
  report.out.peer_fault = Reason::kRobotBadPacket;
  stand(SessionState::kFault, Desired::kOff, Reason::kPeerFault);
  tick();
  EXPECT_EQ(text(answer), std::string("refused: ") + describe(Reason::kPeerFault) + ": " +
                              describe(Reason::kRobotBadPacket));
}

TEST_F(OrderDeskTest, EngagingTimesOutWithTheSlavesReasonAndDisengages) {
  const Answer answer = ask("engage: true");
  loop();
  stand(SessionState::kAligning, Desired::kEngaged);
  slave.reason = Reason::kAlignmentMismatch;
  tick();
  tick(OrderDesk::kEngagePatience);
  ASSERT_FALSE(answer->has_value());
  tick(1);
  EXPECT_EQ(text(answer), std::string("refused: ") + describe(Reason::kAlignmentMismatch));
  loop();
  EXPECT_EQ(last_order(), OrderKind::kDisengage);
}

TEST_F(OrderDeskTest, ALaterEngageTakesThePlaceOfTheOneThatWaits) {
  const Answer first = ask("engage: true");
  const Answer second = ask("engage: true");
  loop();
  stand(SessionState::kAligning, Desired::kEngaged);
  tick();
  EXPECT_EQ(text(first), "refused: another engage came after this one");
  stand(SessionState::kEngaged, Desired::kEngaged);
  tick();
  EXPECT_EQ(text(second), "done: ");
}

TEST_F(OrderDeskTest, JudgesAnAnswerByTheReportThatCameWithIt) {
  tick();
  const Answer engaging = ask("engage: true");
  pb::Request disengage;
  disengage.set_disengage(true);
  const auto busy = [&](const pb::Reply&) {
    // While the desk is busy with this answer, the loop ticks and takes the engage order.
    stand(SessionState::kAligning, Desired::kEngaged);
    boxes.report.publish(report);
    ASSERT_TRUE(boxes.answers.push({1, Reason::kNone}));
  };
  desk->handle(disengage, busy, {});
  OrderTicket ticket;
  while (boxes.orders.pop(ticket)) taken.push_back(ticket);
  ASSERT_EQ(taken.size(), 2u);
  ASSERT_TRUE(boxes.answers.push({taken.back().id, Reason::kNone}));
  hear();
  hear();
  EXPECT_FALSE(engaging->has_value()) << text(engaging);
}

TEST_F(OrderDeskTest, AnswersAResetWhenTheSlaveHasLeftItsFault) {
  slave.state = SessionState::kFault;
  slave.fault = Reason::kRobotLost;
  const Answer answer = ask("reset: true");
  loop();
  for (int i = 0; i < 100; ++i) {
    tick();
    ASSERT_FALSE(answer->has_value());
  }
  slave.state = SessionState::kOff;
  tick();
  EXPECT_EQ(text(answer), "done: engage to go on");
}

TEST_F(OrderDeskTest, DroppingWhatIsNotThereIsDoneAndSaysSo) {
  tick();
  const Answer answer = ask("tool_off {}");
  loop(Reason::kNoSuchTool);
  tick();
  EXPECT_EQ(text(answer), "done: there was none");
}

TEST_F(OrderDeskTest, RefusesAResetWhenTheSlaveStaysInItsFault) {
  slave.state = SessionState::kFault;
  slave.fault = Reason::kRobotLost;
  const Answer answer = ask("reset: true");
  loop();
  tick();
  tick(OrderDesk::kResetPatience);
  ASSERT_FALSE(answer->has_value());
  tick(1);
  EXPECT_EQ(text(answer),
            std::string("refused: the slave stays in fault: ") + describe(Reason::kRobotLost));
}

TEST_F(OrderDeskTest, AResetWithoutASlaveIsDoneAndSaysSo) {
  slave.state = SessionState::kFault;
  tick();
  connected = false;
  tick(201 * kMillisecond);
  Answer answer = ask("reset: true");
  loop();
  tick();
  EXPECT_EQ(text(answer),
            "done: the slave was last heard 202 ms ago, and what it has latched stays");
  link.peer_epoch = 0;
  answer = ask("reset: true");
  loop();
  tick();
  EXPECT_EQ(text(answer),
            "done: no slave has answered at /run/link.sock: start handrail-slave there");
}

}  // namespace
}  // namespace handrail
