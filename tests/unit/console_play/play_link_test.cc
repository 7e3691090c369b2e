// The player in its thread, at recordings of the real programs.
#include "client/console/play/play_link.h"

#include <gmock/gmock.h>

#include <deque>
#include <fstream>
#include <sstream>

#include "tests/support/temp_folder.h"
#include "tests/unit/record/driven.h"

namespace handrail {
namespace {

using ::testing::HasSubstr;

std::string golden_file(const std::string& side) {
  return std::string(HANDRAIL_SOURCE_DIR) + "/tests/loopback/recording/golden/" + side + ".mcap";
}

// The gateway's thread, played by the test.
class Player {
 public:
  explicit Player(const std::string& path) {
    auto reader = RecordingReader::open(path);
    EXPECT_TRUE(reader) << reader.message();
    begins = (*reader)->begins();
    length = (*reader)->ends() - begins;
    link = std::make_unique<PlayLink>(
        std::move(*reader),
        [this](std::function<void()> work) {
          const std::lock_guard lock(mutex_);
          work_.push_back(std::move(work));
        },
        PlayLink::Told{[this](const Result<pb::Reply>& reply, Nanos, const PlayState& state) {
                         states.push_back(state);
                         replies.push_back(reply);
                         ++told;
                       },
                       [this](const std::string& name, const Result<ReadScene>& scene) {
                         scenes.push_back(name + (scene ? "" : ": " + scene.message()));
                         EXPECT_TRUE(replies.empty() || scenes.size() > 1)
                             << "before its first moment";
                       }});
  }
  ~Player() { link.reset(); }

  void work() {
    std::deque<std::function<void()>> now;
    {
      const std::lock_guard lock(mutex_);
      now.swap(work_);
    }
    for (const auto& each : now) each();
  }
  // Until a state is told that `is` so.
  template <typename F>
  bool until(F is) {
    states.clear();
    replies.clear();
    return test::wait_until([&] {
      work();
      return !states.empty() && is(states.back());
    });
  }
  const pb::Status& status() const { return replies.back()->status(); }

  Nanos begins = 0, length = 0;
  std::vector<PlayState> states;
  std::vector<Result<pb::Reply>> replies;
  std::vector<std::string> scenes;
  int told = 0;
  std::unique_ptr<PlayLink> link;

 private:
  std::mutex mutex_;
  std::deque<std::function<void()>> work_;
};

TEST(PlayLink, BeginsPausedWithTheSceneAndTheFirstMoment) {
  Player player(golden_file("master"));
  ASSERT_TRUE(player.until([](const PlayState& s) { return s.is == PlayState::Is::kPaused; }));
  ASSERT_EQ(player.scenes.size(), 1u);
  ASSERT_TRUE(player.replies.back()) << player.replies.back().message();
  EXPECT_EQ(player.status().scene(), player.scenes[0]);
  const std::uint64_t first = player.status().ticks();
  ASSERT_TRUE(player.until([&](const PlayState&) { return player.told > 20; }));
  EXPECT_EQ(player.status().ticks(), first) << "it is paused";
}

TEST(PlayLink, PlaysSeeksAndEnds) {
  for (const char* side : {"master", "slave"}) {
    SCOPED_TRACE(side);
    Player player(golden_file(side));
    ASSERT_TRUE(player.until([](const PlayState&) { return true; }));
    const std::uint64_t first = player.status().ticks();
    const Nanos middle = player.length / 2;
    ASSERT_TRUE(player.link->play({{}, middle, {}}));
    ASSERT_TRUE(player.until([&](const PlayState& s) { return s.position == middle; }));
    ASSERT_TRUE(player.replies.back()) << player.replies.back().message();
    const std::uint64_t half = player.status().ticks();
    EXPECT_GT(half, first);
    EXPECT_TRUE(player.status().has_tip());
    EXPECT_EQ(player.status().joints_deg_size(), 6);
    EXPECT_FALSE(player.status().ledger().sentence().empty());
    // A slave knows nothing of the hand.
    const bool of_master = side == std::string("master");
    EXPECT_EQ(player.status().has_hand(), of_master);
    EXPECT_EQ(player.status().has_device_force(), of_master);
    EXPECT_EQ(player.status().has_haptic(), of_master);
    EXPECT_EQ(player.status().ledger().has_behind_mm(), of_master);
    ASSERT_TRUE(player.link->play({true, {}, 10.0}));
    ASSERT_TRUE(player.until([](const PlayState& s) { return s.is == PlayState::Is::kEnded; }));
    EXPECT_EQ(player.states.back().position, player.length);
    EXPECT_GT(player.status().ticks(), half);
    ASSERT_TRUE(player.link->play({false, 0, 1.0}));
    ASSERT_TRUE(player.until([](const PlayState& s) { return s.position == 0; }));
    EXPECT_EQ(player.status().ticks(), first) << "the same as at first";
    EXPECT_FALSE(player.link->play({true, {}, 11.0}));
    EXPECT_EQ(player.scenes.size(), 1u);
  }
}

// A bar that is dragged gives an order at every move: the player does not fall behind for it, nor
// run out of turns.
TEST(PlayLink, HoweverManyOrdersComeItGoesOn) {
  Player player(golden_file("master"));
  ASSERT_TRUE(player.until([](const PlayState&) { return true; }));
  for (int i = 0; i < 600; ++i) {
    const int before = player.told;
    ASSERT_TRUE(player.link->play({{}, (i % 100) * kMillisecond, {}}));
    for (int k = 0; k < 1000 && player.told == before; ++k) {
      player.work();
      std::this_thread::sleep_for(std::chrono::microseconds(200));
    }
  }
  const int before = player.told;
  ASSERT_TRUE(player.until([&](const PlayState&) { return player.told > before + 30; }));
}

TEST(PlayLink, AMomentThatIsSpoiltIsSaidAndThePlayerGoesOn) {
  TempFolder folder;
  std::ifstream in(golden_file("master"), std::ios::binary);
  std::ostringstream text;
  text << in.rdbuf();
  std::string bytes = text.str();
  bytes[bytes.size() / 2] = static_cast<char>(bytes[bytes.size() / 2] ^ 1);
  Player player(folder.write("spoilt.mcap", bytes));
  ASSERT_TRUE(player.link->play({true, player.length / 3, 1.0}));
  std::string said;
  Nanos spoilt = 0, after = 0;
  ASSERT_TRUE(test::wait_until([&] {
    player.work();
    for (std::size_t i = 0; i < player.replies.size(); ++i) {
      if (!player.replies[i]) {
        said = player.replies[i].message();
        spoilt = player.states[i].position;
      } else if (!said.empty()) {
        after = player.states[i].position;
      }
    }
    player.replies.clear();
    player.states.clear();
    return after > spoilt && spoilt > 0;
  })) << said;
  EXPECT_THAT(said, HasSubstr("spoilt.mcap: byte "));
  // What was shown before it is shown again, and is no error.
  for (const auto& [to, good] : {std::pair(Nanos{0}, true), {spoilt, false}, {Nanos{0}, true}}) {
    ASSERT_TRUE(player.link->play({false, to, {}}));
    ASSERT_TRUE(player.until([to = to](const PlayState& s) { return s.position == to; }));
    EXPECT_EQ(player.replies.back().is_ok(), good) << to;
  }
}

TEST(PlayLink, ItsNewsHasWhatThePageShowsOfTheFile) {
  const auto reader = RecordingReader::open(golden_file("master"));
  ASSERT_TRUE(reader);
  const pb::RecordingNews news = recording_news(**reader);
  EXPECT_THAT(news.file(), HasSubstr("golden/master.mcap"));
  EXPECT_EQ(news.program(), "handrail-master");
  EXPECT_NEAR(news.length_s(), to_seconds((*reader)->ends() - (*reader)->begins()), 1e-9);
  EXPECT_EQ(news.mark_size(), static_cast<int>((*reader)->events().size()));
  for (const pb::RecordingMark& mark : news.mark()) {
    EXPECT_GE(mark.at_s(), 0.0);
    EXPECT_LE(mark.at_s(), news.length_s());
  }
  EXPECT_FALSE(news.has_damage());
}

}  // namespace
}  // namespace handrail
