// What `why` names as the way out works in every state of both sides, and `reset` and `engage`
// answer as it says. An operator does literally what is named; words nobody knows fail the test.
#include <regex>
#include <utility>
#include <vector>

#include "server/model/reason.h"
#include "tests/unit/lab_cell/troubles.h"

namespace handrail {
namespace {

// What an operator does.
Deed gives(const char* order) {
  return [order](TwoSides& t) { EXPECT_TRUE(t.done(order)) << order << ": " << t.ask(order); };
}
void waits(TwoSides& t) { t.run(2 * kSecond); }
void is_there(TwoSides& t) {
  const bool button = t.by_button();
  if (button) {
    t.device.sample.buttons = 4;
    t.run(10 * kMillisecond);
  }
  EXPECT_EQ(t.ask(button ? "engage: true" : "engage: true hold: true"), "done: ");
  t.holds = t.holds || !button;
}
void takes_lease(TwoSides& t) {
  EXPECT_TRUE(t.done("lease { act: TAKE }"));
  EXPECT_EQ(t.ask("engage: true"), "done: ");
}
void starts_controller(TwoSides& t) {
  t.arm.state = ScriptedArm::State::kThere;
  t.run(2 * kSecond);  // the slave tries once a second
}
void starts_slave(TwoSides& t) {
  t.cut_network(false);
  if (!t.slave_runs()) t.start_slave();
  t.run(2 * kSecond);
}
void starts_master(TwoSides& t) {
  t.run(2 * kSecond);
  t.master_stalls = false;
  t.start_master();
  t.run(2 * kSecond);
}

// Everything a way out can ask for, and what an operator then does.
const std::vector<std::pair<std::regex, Deed>>& deeds() {
  static const std::vector<std::pair<std::regex, Deed>> all = {
      {std::regex("engage"), gives("engage: true")},
      {std::regex("reset"), gives("reset: true")},
      {std::regex("at the controller: clear its alarm, if there is one, and start its program in "
                  "AUTOMATIC; the slave's log names other causes"),
       starts_controller},
      {std::regex("look at J3, which reads -?[0-9.]+ deg"), starts_controller},
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
      {std::regex("start the slave, or check the network"), starts_slave},
      {std::regex("start the slave if it does not run"), starts_slave},
      {std::regex("wait; if it lasts, start the master anew"), starts_master},
      {std::regex("wait for the link(, or move slower)?"), waits},
      {std::regex("wait: it goes on by itself.*"), waits},
      {std::regex("wait"), waits},
      {std::regex("end that master: then the slave takes this one, without a restart"),
       [](TwoSides& t) {
         t.other_master = false;
         t.run(2 * kSecond);
       }},
      {std::regex("let the clutch go"), gives("clutch: false")},
      {std::regex("hold the enabling button(,| and engage,) or keep 'handrail engage --hold' "
                  "running"),
       is_there},
      {std::regex("take the lease and engage: 'handrail lease take'"), takes_lease},
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
