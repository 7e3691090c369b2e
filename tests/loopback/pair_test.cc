// `handrail keys pair` as two people run it, each with a folder of keys.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <csignal>
#include <cstdlib>
#include <filesystem>

#include "server/keys/key_folder.h"
#include "tests/loopback/program.h"
#include "tests/support/pseudo_terminal.h"

namespace handrail {
namespace {

using ::testing::HasSubstr;

class Pair : public ::testing::Test {
 protected:
  void TearDown() override { ::unsetenv("HANDRAIL_KEYS"); }

  std::unique_ptr<Program> pair_at(const KeyFolder& keys, std::vector<std::string> arguments,
                                   const Streams& streams = {}) {
    const std::string path = keys.key_path();
    ::setenv("HANDRAIL_KEYS", path.substr(0, path.rfind('/')).c_str(), 1);
    arguments.insert(arguments.begin(), {"keys", "pair"});
    return std::make_unique<Program>(folder, "handrail", arguments, streams);
  }
  std::unique_ptr<Program> cell_listens() {
    auto out = pair_at(at_cell, {"slave", "--listen", "127.0.0.1:0", "--as", "cell"});
    code = out->after("code: ");
    port = out->number_after("listening at TCP port ");
    return out;
  }
  std::vector<std::string> desk_calls(const std::string& with_code, const char* role = "master") {
    return {role,   "--with", "localhost:" + std::to_string(port), "--code", with_code,
            "--as", "desk"};
  }
  // One that is none of the right one.
  std::string other_code() const {
    std::string out = code;
    out.back() = out.back() == '0' ? '1' : '0';
    return out;
  }
  void nobody_is_trusted() {
    EXPECT_FALSE(std::filesystem::exists(at_cell.trusted_path()));
    EXPECT_FALSE(std::filesystem::exists(at_desk.trusted_path()));
  }

  TempFolder folder;
  KeyFolder at_cell{folder.path() + "/cell"}, at_desk{folder.path() + "/desk"};
  std::string code;
  int port = 0;
};

TEST_F(Pair, TwoWithoutKeysTrustEachOtherAfterwards) {
  const auto cell = cell_listens();
  EXPECT_THAT(cell->output(), HasSubstr(" of 127.0.0.1, for one minute and one guess\n"));
  const auto desk = pair_at(at_desk, desk_calls(code));
  EXPECT_EQ(desk->finish(), 0) << desk->output();
  EXPECT_EQ(cell->finish(), 0) << cell->output();
  const auto own_cell = at_cell.load(), own_desk = at_desk.load();
  ASSERT_TRUE(own_cell && own_desk);
  EXPECT_EQ(at_cell.trusted()->entries(), std::vector{own_desk->entry()});
  EXPECT_EQ(at_desk.trusted()->entries(), std::vector{own_cell->entry()});
  const std::string cell_id = key_id(own_cell->key.public_key());
  EXPECT_THAT(desk->output(), HasSubstr("made this user's key " +
                                        key_id(own_desk->key.public_key()) + ", as desk, master"));
  EXPECT_THAT(desk->output(), HasSubstr("trusted here: cell as slave, key " + cell_id));
  EXPECT_THAT(cell->output(), HasSubstr("trusted there: cell as slave, key " + cell_id));
  std::ostringstream history;
  history << std::ifstream(at_desk.history_path()).rdbuf();
  EXPECT_THAT(history.str(), HasSubstr("trusted cell as slave, key " + cell_id +
                                       ", by pairing with 127.0.0.1:" + std::to_string(port)));
}

TEST_F(Pair, TheCodeIsAskedForAtTheTerminal) {
  const auto cell = cell_listens();
  PseudoTerminal terminal;
  ASSERT_TRUE(terminal.works());
  const auto desk = pair_at(at_desk, {"master", "--with", "127.0.0.1:" + std::to_string(port)},
                            {.terminal = terminal.path()});
  terminal.type(code + "\n");
  EXPECT_EQ(desk->finish(), 0) << desk->output();
  EXPECT_EQ(cell->finish(), 0) << cell->output();
}

TEST_F(Pair, AWrongCodeEndsBothAndTheRightOneComesTooLate) {
  const auto cell = cell_listens();
  const auto desk = pair_at(at_desk, desk_calls(other_code()));
  EXPECT_EQ(desk->finish(), 1);
  EXPECT_EQ(cell->finish(), 1);
  EXPECT_THAT(desk->output(),
              HasSubstr("not paired: localhost:" + std::to_string(port) + ": the code is wrong"));
  EXPECT_THAT(cell->output(), HasSubstr("gave a wrong code"));
  const auto again = pair_at(at_desk, desk_calls(code));
  EXPECT_EQ(again->finish(), 1);
  EXPECT_THAT(again->output(), HasSubstr("nobody pairs at localhost:"));
  nobody_is_trusted();
}

TEST_F(Pair, AThirdWhoCallsWhileTwoPairFindsTheDoorShut) {
  const auto cell = cell_listens();
  const KeyFolder at_third{folder.path() + "/third"};
  // Two callers with the right code at once: one of them is served.
  const auto third = pair_at(at_third, desk_calls(code));
  const auto desk = pair_at(at_desk, desk_calls(code));
  const int codes[] = {third->finish(), desk->finish()};
  EXPECT_EQ(cell->finish(), 0) << cell->output();
  EXPECT_EQ(codes[0] + codes[1], 1) << third->output() << desk->output();
  EXPECT_EQ(at_cell.trusted()->entries().size(), 1u);
  EXPECT_THAT(
      (codes[0] == 1 ? third : desk)->output(),
      ::testing::AnyOf(HasSubstr("it has paired with another"), HasSubstr("nobody pairs at")));
}

TEST_F(Pair, TwoSlavesAreRefusedAtBothSides) {
  const auto cell = cell_listens();
  const auto desk = pair_at(at_desk, desk_calls(code, "slave"));
  EXPECT_EQ(desk->finish(), 1);
  EXPECT_EQ(cell->finish(), 1);
  EXPECT_THAT(desk->output(), HasSubstr("a slave has nothing to say to a slave"));
  EXPECT_THAT(cell->output(), HasSubstr("a slave has nothing to say to a slave"));
  nobody_is_trusted();
}

TEST_F(Pair, ANameThatHasAnotherKeyIsRefusedAtBothSides) {
  ASSERT_TRUE(at_cell.trust({"desk", Role::kMaster, OwnKey::generate()->public_key()}));
  const TrustList before = *at_cell.trusted();
  const auto cell = cell_listens();
  const auto desk = pair_at(at_desk, desk_calls(code));
  EXPECT_EQ(desk->finish(), 1);
  EXPECT_EQ(cell->finish(), 1);
  EXPECT_THAT(cell->output(), HasSubstr("'desk' is here already with key"));
  EXPECT_THAT(desk->output(), HasSubstr("the other side refuses: 'desk' is here already"));
  EXPECT_EQ(*at_cell.trusted(), before);
  EXPECT_FALSE(std::filesystem::exists(at_desk.trusted_path()));
}

TEST_F(Pair, PairingAgainTellsTheNextKeyAndKeepsComments) {
  ASSERT_TRUE(at_desk.create("desk", Role::kMaster));
  const std::string line = "# by the door\n" + line_text(at_desk.load()->entry()) + "  # on loan\n";
  folder.write("cell/trusted", line);
  ASSERT_TRUE(at_desk.create_next());
  const auto cell = cell_listens();
  const auto desk = pair_at(at_desk, desk_calls(code));
  EXPECT_EQ(desk->finish(), 0) << desk->output();
  EXPECT_EQ(cell->finish(), 0) << cell->output();
  EXPECT_EQ(at_cell.trusted()->entries(), std::vector{at_desk.load()->entry()});
  EXPECT_EQ(at_cell.trusted()->text(),
            "# by the door\n" + line_text(at_desk.load()->entry()) + " # on loan\n");
}

TEST_F(Pair, WhatIsTypedWrongIsSaidBeforeAnybodyIsCalled) {
  for (const auto& [arguments, exit, says] :
       {std::tuple<std::vector<std::string>, int, const char*>{
            {"king"}, 2, "expected master, slave"},
        {{"slave", "--code", "1234567"}, 2, "expected --with too"},
        {{"slave", "--with", "a", "--listen", "b"}, 2, "expected --listen on one side"},
        {{"slave", "--with", "a:x", "--code", "1234567"}, 1, "--with 'a:x': expected a name"},
        {{"slave", "--with", "127.0.0.1:1", "--code", "12"}, 1, "expected 7 digits"},
        {{"slave", "--listen", "127.0.0.1:99999"}, 1, "--listen '127.0.0.1:99999'"},
        {{"slave", "--listen", "192.0.2.7:0"}, 1, "192.0.2.7"},
        {{"master"}, 1, "is for slave, not for master"},
        {{"slave", "--as", "desk", "--listen", "127.0.0.1:0"}, 1, "leave --as out"}}) {
    const auto cell = pair_at(at_cell, arguments);
    EXPECT_EQ(cell->finish(), exit) << cell->output();
    EXPECT_THAT(cell->output(), HasSubstr(says));
  }
  nobody_is_trusted();
}

TEST_F(Pair, CtrlCWhileItWaitsEndsItAndNobodyIsTrusted) {
  const auto cell = cell_listens();
  cell->send(SIGINT);
  EXPECT_EQ(cell->finish(), -SIGINT);
  nobody_is_trusted();
}

}  // namespace
}  // namespace handrail
