#include "devices/melfa/r3_protocol.h"

#include <gmock/gmock.h>

namespace handrail {
namespace {

using ::testing::HasSubstr;

// What an RV-2A answered to DSTATE, as its users wrote it down.
constexpr char kRv2aStands[] = "QoKA1060;1;0";
// By hand from the fields of public clients: program 1 at line 20, 100 %, E0 00, no alarm.
constexpr char kRuns[] = "QoK1;20;100;0;E0000;2;1;;;;;;;;1;CYC;START;1;1";

TEST(R3Protocol, ReadsWhatAnRv2aSaidOfItself) {
  const auto answer = parse_r3_answer(kRv2aStands);
  ASSERT_TRUE(answer) << answer.message();
  EXPECT_TRUE(answer->done);
  EXPECT_FALSE(answer->alarm);
  const auto status = parse_r3_dstate(answer->body);
  ASSERT_TRUE(status) << status.message();
  EXPECT_EQ(status->run, 0xA1);
  EXPECT_EQ(status->stop, 0x06);
  EXPECT_EQ(status->alarm, 0);
  EXPECT_TRUE(status->servo_on());
  EXPECT_TRUE(status->rights_taken());
  EXPECT_FALSE(status->running());
  EXPECT_FALSE(status->teach());
  // From the second byte and not from the digits of the first, whose last one is a 1.
  EXPECT_FALSE(status->emergency_stop());
}

TEST(R3Protocol, EachBitIsAMatterOfItsOwn) {
  const auto with = [](const char* body) { return *parse_r3_dstate(body); };
  EXPECT_TRUE(with("04000").machine_lock());
  EXPECT_TRUE(with("08000").teach());
  EXPECT_TRUE(with("20000").servo_on());
  EXPECT_TRUE(with("40000").running());
  EXPECT_TRUE(with("80000").rights_taken());
  EXPECT_TRUE(with("00010").emergency_stop());
  const R3Status none = with("00fe0");
  EXPECT_FALSE(none.machine_lock() || none.teach() || none.servo_on() || none.running() ||
               none.rights_taken() || none.emergency_stop());
  const R3Status others = with("13000");
  EXPECT_FALSE(others.machine_lock() || others.teach() || others.servo_on() || others.running() ||
               others.rights_taken());
}

TEST(R3Protocol, ReadsAState) {
  const auto state = parse_r3_state(parse_r3_answer(kRuns)->body);
  ASSERT_TRUE(state) << state.message();
  EXPECT_EQ(state->program, "1");
  EXPECT_EQ(state->line, 20);
  EXPECT_EQ(state->override_percent, 100);
  EXPECT_TRUE(state->status.servo_on());
  EXPECT_TRUE(state->status.running());
  EXPECT_EQ(state->status.alarm, 0);
  // Without a program, and with an alarm of four digits.
  const auto alarm = parse_r3_state(";0;25;0;00066130;1;1");
  ASSERT_TRUE(alarm) << alarm.message();
  EXPECT_EQ(alarm->program, "");
  EXPECT_EQ(alarm->override_percent, 25);
  EXPECT_EQ(alarm->status.stop, 0x06);
  EXPECT_EQ(alarm->status.alarm, 6130);
}

TEST(R3Protocol, KnowsRefusalsAndTheSmallLetters) {
  const auto refused = parse_r3_answer("QeR5640");
  ASSERT_TRUE(refused);
  EXPECT_FALSE(refused->done);
  EXPECT_FALSE(refused->alarm);
  EXPECT_EQ(refused->error, 5640);
  const auto in_alarm = parse_r3_answer("Qer4220;12;3");
  ASSERT_TRUE(in_alarm);
  EXPECT_FALSE(in_alarm->done);
  EXPECT_TRUE(in_alarm->alarm);
  EXPECT_EQ(in_alarm->error, 4220);
  const auto done = parse_r3_answer("Qok25\r");
  ASSERT_TRUE(done);
  EXPECT_TRUE(done->done);
  EXPECT_TRUE(done->alarm);
  EXPECT_EQ(done->body, "25");
  EXPECT_EQ(parse_r3_answer("QeR")->error, 0);
  EXPECT_EQ(parse_r3_answer("QoK")->body, "");
}

TEST(R3Protocol, NamesWhatIsNoAnswer) {
  for (const char* text : {"SSH-2.0-OpenSSH_9.2p1\r\n", "HTTP/1.1 400 Bad Request\r\n\r\n", "Qo",
                           "", "QoX", "QeK1", "qoK", "QoK\rQoK", "\r\n"}) {
    const auto answer = parse_r3_answer(text);
    ASSERT_FALSE(answer) << text;
    EXPECT_THAT(answer.message(), HasSubstr("expected an answer that begins with QoK or QeR"));
  }
  EXPECT_THAT(parse_r3_answer("QeRmany").message(), HasSubstr("a number after QeR"));
  EXPECT_THAT(parse_r3_answer("QeR-1").message(), HasSubstr("a number after QeR"));
  EXPECT_THAT(parse_r3_answer("QeR9999999999").message(), HasSubstr("a number after QeR"));
  EXPECT_THAT(parse_r3_answer("QoK\x1b[2J").message(), HasSubstr("control characters"));
  EXPECT_FALSE(parse_r3_answer(std::string("QoK") + std::string(kMostR3Answer, 'x')));
  EXPECT_TRUE(parse_r3_answer(std::string("QoK") + std::string(kMostR3Answer - 3, 'x')));
}

TEST(R3Protocol, NamesTheFieldThatIsWrong) {
  const auto expect = [](const char* body, const char* what) {
    const auto state = parse_r3_state(body);
    ASSERT_FALSE(state) << body;
    EXPECT_THAT(state.message(), HasSubstr(what)) << body;
  };
  expect("1;20;100;0", "five fields");
  expect("1;x;100;0;E0000", "number of a line");
  expect("1;;100;0;E0000", "number of a line");
  expect("1;20;101;0;E0000", "'101', expected an override of 0 to 100");
  expect("1;20;-5;0;E0000", "override");
  expect("1;20;100;0;E000", "'E000', expected four hexadecimal digits");
  expect("1;20;100;0;E00G0", "four hexadecimal digits");
  expect("1;20;100;0;E000x", "four hexadecimal digits");
  expect("1;20;100;0;", "four hexadecimal digits");
  for (const char* body : {"", "A106", "+1060;1;0", " A1060", "0xA10;1;1"}) {
    EXPECT_FALSE(parse_r3_dstate(body)) << body;
  }
}

TEST(R3Protocol, PutsAnAnswerTogetherFromAnyPieces) {
  R3Reader reader;
  for (const char c : std::string("QoKA1060;1;0")) {
    EXPECT_EQ(reader.take(std::string(1, c)), R3Reader::Said::kMore);
  }
  EXPECT_EQ(reader.text(), kRv2aStands);
  EXPECT_EQ(reader.take("\r"), R3Reader::Said::kWhole);
  R3Reader flood;
  EXPECT_EQ(flood.take(std::string(kMostR3Answer, 'x')), R3Reader::Said::kMore);
  EXPECT_EQ(flood.take("x"), R3Reader::Said::kTooLong);
  EXPECT_EQ(flood.take(std::string(100'000, 'x')), R3Reader::Said::kTooLong);
  EXPECT_LE(flood.text().size(), kMostR3Answer + 1);
}

TEST(R3Protocol, TheSameProgramIsNamedWithoutItsEnding) {
  EXPECT_TRUE(same_program("1", "1"));
  EXPECT_TRUE(same_program("mxt", "MXT.MB4"));
  EXPECT_FALSE(same_program("1", "10"));
  EXPECT_FALSE(same_program("10", "1"));
  EXPECT_FALSE(same_program("1", "2"));
  EXPECT_FALSE(same_program("1", ""));
}

}  // namespace
}  // namespace handrail
