// The first hour: a demo that is interrupted, a painted scene, a second user on the computer.
#include <gmock/gmock.h>
#include <unistd.h>

#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>

#include "tests/loopback/whole_cell.h"
#include "tests/support/png_sample.h"

namespace handrail {
namespace {

using ::testing::HasSubstr;

class NewcomerTest : public WholeCell {
 protected:
  // Ends a demo in motion: the exit code, within 2 s.
  int interrupt(Program& demo) {
    const Nanos start = monotonic_now();
    demo.send(SIGINT);
    const int code = demo.finish();
    EXPECT_LT(monotonic_now() - start, 2 * kSecond);
    EXPECT_THAT(demo.output(), HasSubstr("interrupted; disengaged"));
    EXPECT_EQ(status().state(), "off");
    return code;
  }
};

TEST_F(NewcomerTest, CtrlCInADemoDisengagesAndTheNextBeginsAtA) {
  {
    Program demo(folder, "handrail", {"demo", "--socket", socket()});
    (void)demo.after("without tools ...");
    const Vec3 a = mm(status().tip());
    ASSERT_TRUE(eventually([&](const pb::Status& s) { return (mm(s.tip()) - a).norm() > 20.0; }));
    EXPECT_EQ(interrupt(demo), 130);
  }
  Program next(folder, "handrail", {"demo", "--socket", socket()});
  (void)next.after("going to A");
  (void)next.after("without tools ...");
  EXPECT_LT((mm(status().slave_command()) - Vec3(350, 0, 429)).norm(), 15.0);
  EXPECT_EQ(interrupt(next), 130);
}

TEST_F(NewcomerTest, CtrlCWhileADemoWaitsToEngageEndsItToo) {
  slave->send(SIGSTOP);
  ASSERT_TRUE(eventually([](const pb::Status& s) { return s.packet_age_ms() > 100.0; }));
  Program demo(folder, "handrail", {"demo", "--socket", socket()});
  sleep_until(monotonic_now() + kSecond);
  EXPECT_EQ(interrupt(demo), 130);
  slave->send(SIGCONT);
}

TEST_F(NewcomerTest, ADemoWhoseReaderGoesDisengages) {
  const std::string said = folder.path() + "/said.txt";
  Program shell(folder, "/bin/bash",
                {"-c", std::string(HANDRAIL_BIN_DIR) + "/handrail demo --socket " + socket() +
                           " 2>" + said + " | head -n 1; exit ${PIPESTATUS[0]}"});
  EXPECT_EQ(shell.finish(), 1);
  std::ostringstream text;
  text << std::ifstream(said).rdbuf();
  EXPECT_EQ(text.str().find("handrail: the standard output cannot be written"), 0u) << text.str();
  EXPECT_EQ(status().state(), "off");
}

TEST_F(NewcomerTest, ADemoInAnotherSceneNamesTheOrderThatLoadsItsOwn) {
  order("scene_load: 'screw-fastening'");
  const auto [code, said] = handrail({"demo"});
  EXPECT_EQ(code, 1);
  const std::string way = "handrail scene load linear-movement";
  EXPECT_THAT(said, HasSubstr("scene 'screw-fastening' is loaded, expected 'linear-movement': " +
                              way + "; disengaged"));
  EXPECT_EQ(handrail({"scene", "load", "linear-movement"}).first, 0);
  EXPECT_EQ(status().scene(), "linear-movement");
}

TEST_F(NewcomerTest, ADemoFarFromItsBeginningSaysHowFarAndMovesNothing) {
  order("engage: true");
  ASSERT_TRUE(slave_reaches("engaged"));
  const Vec3 before = mm(move_hand("78, 30, 0").slave_command());  // twice that at the arm
  const double far = (before - Vec3(350, 0, 429)).norm();
  ASSERT_GT(far, 151.0);
  order("disengage: true");
  const auto [code, said] = handrail({"demo"});
  EXPECT_EQ(code, 1);
  EXPECT_THAT(said, HasSubstr("the arm stands " + std::to_string(std::lround(far)) +
                              " mm and 0 deg from where this begins, "
                              "(350, 0, 429) mm; expected at most 150 mm and 90 deg: drive it "
                              "there, or restart the rig; disengaged"));
  EXPECT_LT((mm(status().slave_command()) - before).norm(), 1.0);
}

TEST_F(NewcomerTest, HandHomeTakesTheSimulatedHandBack) {
  const Vec3 home = mm(at_rest().hand());
  const Vec3 away = mm(move_hand("20, 10, 0").hand());
  EXPECT_NEAR((away - home).norm(), Vec3(20, 10, 0).norm(), 1.0);
  EXPECT_EQ(handrail({"hand", "home"}).first, 0);
  EXPECT_LT((mm(at_rest().hand()) - home).norm(), 1.0);
}

class PaintedTest : public NewcomerTest {
 protected:
  void SetUp() override {}
  // The hand is where the scene says, in the aisle, and nothing pushes it.
  void expect_free_at_start(const std::string& scene) {
    master =
        launch("handrail-master", "link_socket: '" + link_socket + "' operator_socket: '" +
                                      socket() + "' scene_path: '" + folder.path() + "' scene: '" +
                                      scene + "' device { kind: SIM_JOYSTICK }");
    (void)master->after("READY ");
    sleep_until(monotonic_now() + kSecond);
    const pb::Status s = status();
    ASSERT_TRUE(s.has_walls());
    EXPECT_FALSE(s.walls().touching());
    ASSERT_EQ(s.walls().proxy_mm_size(), 2);
    EXPECT_NEAR(s.walls().proxy_mm(0), -25.0, 3.0);  // of the scene, and the hand's straying
    EXPECT_NEAR(s.walls().proxy_mm(1), -10.0, 3.0);
    EXPECT_LT(s.device_force().magnitude_n(), 1.0);
  }
};

TEST_F(PaintedTest, TheHandBeginsFreeAtTheStartOfTheShippedOne) {
  expect_free_at_start("painted-aisle");
}

// The file that the page about painting begins with, and a map in its colours: 10 pixels a
// millimetre, an aisle of 10 mm about its start, a room to the right, walls around them.
TEST_F(PaintedTest, TheSceneOfThePageIsTakenAndFelt) {
  std::ifstream page(HANDRAIL_SOURCE_DIR "/server/scene/SCENES.md");
  std::string scene;
  for (std::string line; std::getline(page, line) && !line.starts_with("`handrail scene check");) {
    if (line.starts_with("    ")) scene += line.substr(4) + '\n';
  }
  ASSERT_THAT(scene, HasSubstr("start_mm: [-25, -10]"));
  test::PngSample map;
  map.width = map.height = 1000;
  map.pixel = [](int column, int row) -> test::Pixel {
    const int x = column - 500, y = 500 - row;
    if (std::abs(y + 100) >= (x < 0 ? 50 : 300) || std::abs(x) >= 400) return {0, 0, 0, 255};
    return x < 0 ? test::Pixel{0x30, 0xa0, 0x50, 255} : test::Pixel{255, 255, 255, 255};
  };
  folder.write("mine.png", test::png_of(map));
  const std::string path = folder.write("mine.scene", scene);
  Program check(folder, "handrail", {"scene", "check", path});
  EXPECT_EQ(check.finish(), 0) << check.output();
  expect_free_at_start("mine");
  order("hand { displacement_mm: [0, 20, 0] duration_s: 0.5 }");
  EXPECT_TRUE(eventually([](const pb::Status& s) { return s.walls().touching(); }));
  EXPECT_NEAR(status().walls().proxy_mm(1), -5.0, 0.5) << "the aisle's upper wall";
}

// As user `number`, in a user name space of its own.
std::vector<std::string> as_user(int number, const std::string& program,
                                 std::vector<std::string> words) {
  std::vector<std::string> out = {"-U", "--map-user=" + std::to_string(number),
                                  std::string(HANDRAIL_BIN_DIR) + "/" + program};
  out.insert(out.end(), words.begin(), words.end());
  return out;
}

TEST(TwoUsers, BothStartWithTheDefaultsAndAreToldHowToBeGrantedRealTime) {
  if (::access("/usr/bin/unshare", X_OK) != 0) GTEST_SKIP() << "needs unshare";
  const TempFolder folder;
  {
    Program probe(folder, "/usr/bin/unshare", {"-U", "/bin/true"});
    if (probe.finish() != 0) GTEST_SKIP() << "no user name spaces here";
  }
  const int first = 4'000'000 + ::getpid(), second = 9'000'000 + ::getpid();
  std::vector<std::unique_ptr<Program>> running;
  for (const int user : {first, second}) {
    for (const std::string program : {"handrail-rig", "handrail-slave", "handrail-master"}) {
      running.push_back(
          std::make_unique<Program>(folder, "/usr/bin/unshare", as_user(user, program, {})));
      EXPECT_THAT(running.back()->after("READY "),
                  program == "handrail-rig" ? HasSubstr("port=") : HasSubstr("link="))
          << user << program;
      (void)running.back()->after("not in real time: ");
      EXPECT_THAT(running.back()->output(), HasSubstr("/etc/security/limits.d/"));
    }
  }
  for (const int user : {first, second}) {
    Program engage(folder, "/usr/bin/unshare", as_user(user, "handrail", {"engage"}));
    EXPECT_EQ(engage.finish(), 0) << engage.output();
  }
  for (const auto& program : running) {
    program->send(SIGTERM);
    EXPECT_EQ(program->finish(), 0);
  }
  for (const int user : {first, second}) {
    std::filesystem::remove_all("/tmp/handrail-" + std::to_string(user));
  }
}

}  // namespace
}  // namespace handrail
