// What `why` names as the way out works in every state of both sides, and `reset` and `engage`
// answer as it says. An operator does literally what is named; words nobody knows fail the test.
#include <regex>
#include <utility>
#include <vector>

#include "server/model/reason.h"
#include "tests/unit/lab_cell/two_sides.h"

namespace handrail {
namespace {

using Deed = std::function<void(TwoSides&)>;

// Everything a way out can ask for, and what an operator then does.
const std::vector<std::pair<std::regex, Deed>>& deeds() {
  const auto order = [](const char* text) {
    return [text](TwoSides& t) { EXPECT_TRUE(t.done(text)) << text << ": " << t.ask(text); };
  };
  const auto hold_on = [](TwoSides& t) {
    EXPECT_EQ(t.ask("engage: true hold: true"), "done: ");
    t.holds = true;
  };
  const auto be_there = [hold_on](TwoSides& t) {
    if (!t.by_button()) return hold_on(t);
    t.device.sample.buttons = 4;
    t.run(10 * kMillisecond);
    EXPECT_EQ(t.ask("engage: true"), "done: ");
  };
  const auto controller_starts = [](TwoSides& t) {
    t.arm.state = ScriptedArm::State::kThere;
    t.run(2 * kSecond);  // the slave tries once a second
  };
  const auto slave_starts = [](TwoSides& t) {
    t.cut_network(false);
    if (!t.slave_runs()) t.start_slave();
    t.run(2 * kSecond);
  };
  const auto wait = [](TwoSides& t) { t.run(2 * kSecond); };
  static const std::vector<std::pair<std::regex, Deed>> all = {
      {std::regex("engage"), order("engage: true")},
      {std::regex("reset"), order("reset: true")},
      {std::regex("at the controller: clear its alarm, if there is one, and start its program in "
                  "AUTOMATIC; the slave's log names other causes"),
       controller_starts},
      {std::regex("look at J3, which reads -?[0-9.]+ deg"), controller_starts},
      {std::regex("check the force sensor"),
       [](TwoSides& t) {
         t.sensor = true;
         t.run(kSecond);
       }},
      {std::regex("give both sides the same scene and version"),
       [](TwoSides& t) {
         t.give_slave_the_scene(true);
         t.run(2 * kSecond);
       }},
      {std::regex("check the haptic device"),
       [](TwoSides& t) {
         t.device.sample.valid = true;
         t.run(kSecond);
       }},
      {std::regex("load a scene with an arm: 'handrail scene load NAME'"),
       [](TwoSides& t) {
         EXPECT_TRUE(t.done(std::string("scene_load: '") + TwoSides::kArm + "'"));
       }},
      {std::regex("start the slave, or check the network"), slave_starts},
      {std::regex("start the slave if it does not run"), slave_starts},
      {std::regex("wait; if it lasts, start the master anew"),
       [](TwoSides& t) {
         t.run(2 * kSecond);
         t.master_stalls = false;
         t.start_master();
         t.run(2 * kSecond);
       }},
      {std::regex("wait for the link(, or move slower)?"), wait},
      {std::regex("wait: it goes on by itself.*"), wait},
      {std::regex("wait"), wait},
      {std::regex("end that master: then the slave takes this one, without a restart"),
       [](TwoSides& t) {
         t.other_master = false;
         t.run(2 * kSecond);
       }},
      {std::regex("let the clutch go"), order("clutch: false")},
      {std::regex("hold the enabling button(,| and engage,) or keep 'handrail engage --hold' "
                  "running"),
       be_there},
      {std::regex("take the lease and engage: 'handrail lease take'"),
       [](TwoSides& t) {
         EXPECT_TRUE(t.done("lease { act: TAKE }"));
         EXPECT_EQ(t.ask("engage: true"), "done: ");
       }},
  };
  return all;
}

// One thing after the other, in the order they are named.
void follow(TwoSides& t, const std::string& way) {
  static const std::regex kJoint("^(, then |, | and )");
  for (std::string rest = way; !rest.empty();) {
    const Deed* deed = nullptr;
    std::size_t longest = 0;
    for (const auto& [words, what] : deeds()) {
      std::smatch match;
      const bool here =
          std::regex_search(rest, match, words, std::regex_constants::match_continuous);
      if (!here || static_cast<std::size_t>(match.length()) <= longest) continue;
      longest = static_cast<std::size_t>(match.length());
      deed = &what;
    }
    ASSERT_NE(deed, nullptr) << "nobody knows how to '" << rest << "'";
    (*deed)(t);
    rest = std::regex_replace(rest.substr(longest), kJoint, "",
                              std::regex_constants::format_first_only);
  }
}

struct Trouble {
  const char* name;
  Deed comes;
  Presence presence = Presence::kNone;
  const char* scene = TwoSides::kArm;
};

// From a cell in which nothing was done yet, or one that is led; and what may come on top.
std::vector<Trouble> troubles() {
  const auto order = [](const char* text) { return [text](TwoSides& t) { t.ask(text); }; };
  const auto arm = [](ScriptedArm::State state, Nanos span) {
    return [state, span](TwoSides& t) {
      t.arm.state = state;
      t.run(span);
    };
  };
  return {
      {"nothing", [](TwoSides&) {}},
      {"disengaged", order("disengage: true")},
      {"clutched", order("clutch: true")},
      {"stopped", order("stop: true")},
      {"controller silent", arm(ScriptedArm::State::kAway, kSecond / 2)},
      {"controller lost", arm(ScriptedArm::State::kAway, 3 * kSecond)},
      {"controller answers zeros", arm(ScriptedArm::State::kZeros, kSecond)},
      {"controller away, slave started anew",
       [](TwoSides& t) {
         t.arm.state = ScriptedArm::State::kAway;
         t.start_slave();
         t.run(3 * kSecond);
       }},
      {"controller answers zeros, slave started anew",
       [](TwoSides& t) {
         t.arm.state = ScriptedArm::State::kZeros;
         t.start_slave();
         t.run(3 * kSecond);
       }},
      {"sensor not sound",
       [](TwoSides& t) {
         t.sensor = false;
         t.run(kSecond);
       }},
      {"network cut for 0.1 s",
       [](TwoSides& t) {
         t.cut_network(true);
         t.run(kSecond / 10);
         t.cut_network(false);
       }},
      {"network cut",
       [](TwoSides& t) {
         t.cut_network(true);
         t.run(2 * kSecond);
       }},
      {"slave ended",
       [](TwoSides& t) {
         t.end_slave();
         t.run(2 * kSecond);
       }},
      {"slave started anew",
       [](TwoSides& t) {
         t.start_slave();
         t.run(kSecond);
       }},
      {"slave in fault, then started anew",
       [](TwoSides& t) {
         t.arm.state = ScriptedArm::State::kZeros;
         t.run(kSecond);
         t.arm.state = ScriptedArm::State::kThere;
         t.start_slave();
         t.run(kSecond);
       }},
      {"master started anew",
       [](TwoSides& t) {
         t.start_master();
         t.run(kSecond);
       }},
      {"haptic loop stands still",
       [](TwoSides& t) {
         t.master_stalls = true;
         t.run(kSecond);
       }},
      {"haptic loop stood still",
       [](TwoSides& t) {
         t.master_stalls = true;
         t.run(kSecond);
         t.master_stalls = false;
         t.run(kSecond);
       }},
      {"device not valid",
       [](TwoSides& t) {
         t.device.sample.valid = false;
         t.run(kSecond);
       }},
      {"scene differs",
       [](TwoSides& t) {
         t.ask("disengage: true");
         t.run(kSecond / 10);
         t.give_slave_the_scene(false);
         t.run(kSecond);
       }},
      {"another master leads",
       [](TwoSides& t) {
         t.other_master = true;
         t.run(kSecond);
       }},
      {"lease lost",
       [](TwoSides& t) {
         t.ask("lease { act: RELEASE }");
         t.run(kSecond / 10);
         t.who = "ben";
       }},
      {"nobody holds on",
       [](TwoSides& t) {
         t.holds = false;
         t.run(kSecond);
       },
       Presence::kHold},
      {"nobody held on",
       [](TwoSides& t) {
         t.holds = false;
         t.run(4 * kSecond);
       },
       Presence::kHold},
      {"button not held",
       [](TwoSides& t) {
         t.device.sample.buttons = 0;
         t.run(kSecond);
       },
       Presence::kButton},
      {"button not held for long",
       [](TwoSides& t) {
         t.device.sample.buttons = 0;
         t.run(4 * kSecond);
       },
       Presence::kButton},
      {"walls", [](TwoSides&) {}, Presence::kNone, TwoSides::kWalls},
      {"walls loaded in an arm's place",
       [](TwoSides& t) {
         t.ask("disengage: true");
         t.run(kSecond / 10);
         EXPECT_TRUE(t.done(std::string("scene_load: '") + TwoSides::kWalls + "'"));
         t.run(2 * kSecond);
       }},
      {"walls loaded in a fault",
       [](TwoSides& t) {
         t.cut_network(true);
         t.run(kSecond);
         t.cut_network(false);
         EXPECT_TRUE(t.done(std::string("scene_load: '") + TwoSides::kWalls + "'"));
         t.run(2 * kSecond);
       }},
      {"homing: engage waits for a controller that is away",
       [](TwoSides& t) {
         t.ask("disengage: true");
         t.arm.state = ScriptedArm::State::kAway;
         t.start_slave();
         t.run(2 * kSecond);
         t.begin("engage: true");
         t.run(kSecond);
       }},
      {"homing: engage has waited for a controller that is away",
       [](TwoSides& t) {
         t.ask("disengage: true");
         t.arm.state = ScriptedArm::State::kAway;
         t.start_slave();
         t.run(2 * kSecond);
         t.ask("engage: true");
       }},
      {"aligning: the slave does not hear of it",
       [](TwoSides& t) {
         t.ask("disengage: true");
         t.run(kSecond / 10);
         t.begin("engage: true");
         t.cut_way_to_slave(true);
         t.run(kSecond);
         t.cut_way_to_slave(false);
       }},
  };
}

// One cell at a time: they share a clock.
class BothSides : public ::testing::TestWithParam<bool> {
 protected:
  static constexpr int kSteps = 5;  // each trouble may be named in turn, and once more

  // The cell as it is when an operator looks; the parameter: it was led before.
  static std::unique_ptr<TwoSides> in(const Trouble& trouble, const Deed& on_top) {
    auto t = std::make_unique<TwoSides>(trouble.presence, trouble.scene);
    t->run(2 * kSecond);
    if (GetParam() && trouble.scene == std::string(TwoSides::kArm)) {
      t->device.sample.buttons = trouble.presence == Presence::kButton ? 4 : 0;
      t->run(10 * kMillisecond);
      const bool hold = trouble.presence == Presence::kHold;
      EXPECT_EQ(t->ask(hold ? "engage: true hold: true" : "engage: true"), "done: ");
      t->holds = hold;
      t->run(kSecond / 5);
      EXPECT_TRUE(t->led());
    }
    trouble.comes(*t);
    if (on_top) on_top(*t);
    return t;
  }
  // A reset finds nothing where none is named, and an engage works alone where it is named alone.
  static void expect_orders_agree(const Trouble& trouble, const Deed& on_top) {
    auto t = in(trouble, on_top);
    if (t->led()) return;
    const std::string way = t->status().ledger().way_out(), why = told(*t);
    const bool wanted = t->status().desired() != "off";  // an engage waits, or is on
    t.reset();
    const std::string reset = in(trouble, on_top)->ask("reset: true");
    // A loop that stands still answers nothing.
    const bool stands = reset == "(no answer)";
    EXPECT_TRUE(!stands || way.starts_with("wait; if it lasts")) << why;
    EXPECT_EQ(stands || reset == "refused: nothing to reset",
              way.find("reset") == std::string::npos)
        << reset << "\n"
        << why;
    EXPECT_TRUE(!way.starts_with("reset") || reset.starts_with("done: ")) << reset << "\n" << why;
    const std::string engage = in(trouble, on_top)->ask("engage: true");
    const bool named = way == "engage" || way.starts_with("wait") || way.starts_with("take");
    EXPECT_TRUE(way != "engage" || engage == "done: ") << engage << "\n" << why;
    EXPECT_TRUE(named || wanted || engage != "done: ") << engage << "\n" << why;
  }
  static void expect_way_out_works(const Trouble& trouble, const Deed& on_top) {
    const auto t = in(trouble, on_top);
    std::string story;
    for (int step = 0; step < kSteps && !t->led(); ++step) {
      story += "\n" + told(*t);
      ASSERT_FALSE(t->status().ledger().way_out().empty()) << story;
      ASSERT_NO_FATAL_FAILURE(follow(*t, t->status().ledger().way_out())) << story;
      t->run(kSecond / 2);
    }
    EXPECT_TRUE(t->led()) << story;
  }
  static std::string told(TwoSides& t) {
    const pb::Ledger why = t.status().ledger();
    return why.sentence() + "; way out: " + why.way_out();
  }
};

TEST_P(BothSides, TheWayOutThatWhyNamesWorksAndOrdersAnswerAsItSays) {
  const std::vector<std::pair<const char*, Deed>> tops = {
      {"", nullptr},
      {", and a stop on top", [](TwoSides& t) { t.ask("stop: true"); }},
  };
  for (const Trouble& trouble : troubles()) {
    for (const auto& [top, on_top] : tops) {
      SCOPED_TRACE(std::string(trouble.name) + top);
      expect_orders_agree(trouble, on_top);
      expect_way_out_works(trouble, on_top);
    }
  }
}

INSTANTIATE_TEST_SUITE_P(, BothSides, ::testing::Bool(),
                         [](const auto& of) { return of.param ? "Led" : "Untouched"; });

}  // namespace
}  // namespace handrail
