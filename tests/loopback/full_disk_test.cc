// What every program prints, with a full disk under its standard output: half a table or half a
// JSON is no result, and the exit code says so.
#include <gmock/gmock.h>
#include <sys/wait.h>

#include <cstdlib>
#include <ctime>
#include <filesystem>
#include <fstream>
#include <set>
#include <sstream>

#include "client/cli/command.h"
#include "server/keys/key_folder.h"
#include "server/keys/once_links.h"
#include "tests/loopback/whole_cell.h"

namespace handrail {
namespace {

using ::testing::HasSubstr;

class FullDisk : public WholeCell {
 protected:
  void SetUp() override {
    if (!std::filesystem::exists("/dev/full")) GTEST_SKIP() << "needs /dev/full";
  }
  std::string read(const std::string& path) const {
    std::ostringstream text;
    text << std::ifstream(path).rdbuf();
    return text.str();
  }
  // Runs the program with these words; its exit code.
  int run(const std::string& program, const std::string& words, const std::string& output) const {
    const std::string line = std::string(HANDRAIL_BIN_DIR) + "/" + program + " " + words + " >" +
                             output + " 2>" + complaint;
    const int status = std::system(line.c_str());
    return WIFEXITED(status) ? WEXITSTATUS(status) : -WTERMSIG(status);
  }
  void expect_told(const std::string& program, const std::string& words) const {
    EXPECT_EQ(run(program, words, "/dev/full"), 1) << program << " " << words;
    EXPECT_THAT(read(complaint), HasSubstr(program + ": the standard output cannot be written"))
        << program << " " << words;
  }
  std::string shapes() const {
    return folder.write("aisle.scene", R"(name: "aisle"
walls {
  region { name: "free" kind: FREE }
  region { name: "wall" kind: WALL }
  shape { rectangle { size_mm: [60, 10] centre_mm: [0, 0] region: "free" } }
}
effect { wall {} }
)");
  }
  // Six turns of a sensor from which half a kilogram hangs.
  std::string samples() const {
    std::ostringstream csv;
    csv << "qw,qx,qy,qz,fx_n,fy_n,fz_n,tx_n_m,ty_n_m,tz_n_m\n";
    for (int i = 0; i < 6; ++i) {
      const Quat q(Eigen::AngleAxisd(0.7 * i, Vec3(1.0, 0.3 * i, 0.5).normalized()));
      const Vec3 f = q.conjugate() * Vec3(0.0, 0.0, -0.5 * 9.80665);
      csv << q.w() << ',' << q.x() << ',' << q.y() << ',' << q.z() << ',' << f.x() << ',' << f.y()
          << ',' << f.z() << ",0,0,0\n";
    }
    return folder.write("samples.csv", csv.str());
  }
  // The words of "Subcommands:" in a help text.
  std::set<std::string> subcommands(const std::string& help) const {
    std::set<std::string> out;
    std::istringstream lines(help.substr(help.find("Subcommands:")));
    std::string line;
    std::getline(lines, line);
    // Two blanks, the name, and its help; what goes on below stands further right.
    while (std::getline(lines, line)) {
      if (line.size() > 2 && line[0] == ' ' && line[2] != ' ') {
        out.insert(line.substr(2, line.find(' ', 2) - 2));
      }
    }
    return out;
  }

  std::string complaint = folder.path() + "/complaint.txt";
};

TEST_F(FullDisk, UnderADaemonThatAnswersAtOnce) {
  for (const char* daemon : {"handrail-master", "handrail-slave", "handrail-rig"}) {
    for (const char* words : {"--help", "--version", "--check"}) expect_told(daemon, words);
    EXPECT_EQ(run(daemon, "--check", "/dev/null"), 0) << daemon;
  }
}

// Every sub-command that handrail-lab has, in its shortest form. Under a sanitizer the studies take
// minutes, each test has four.
TEST_F(FullDisk, UnderTheStudiesOfTheLab) {
  const std::string study = " --operators 1 --trials 1";
  for (const std::string words : {"linear-movement", "screw-fastening"}) {
    expect_told("handrail-lab", words + study);
    expect_told("handrail-lab", words + study + " --json");
  }
}

TEST_F(FullDisk, UnderTheFitsOfTheLab) {
  const std::string fit = " --operators 1 --evaluations 1 --out " + folder.path() + "/a.operators";
  for (const std::string words : {"fit linear-movement", "fit screw-fastening"}) {
    expect_told("handrail-lab", words + fit);
  }
}

TEST_F(FullDisk, UnderTheBumpersOfTheLab) {
  expect_told("handrail-lab", "bumper --arm rigid --form published --json");
}

// A recording that is kept with the tests.
std::string golden(const std::string& side) {
  return std::string(HANDRAIL_SOURCE_DIR) + "/tests/loopback/recording/golden/" + side + ".mcap";
}

TEST_F(FullDisk, UnderEveryOtherCommandOfTheLab) {
  std::string csv = "t_s,x_mm,y_mm\n";
  for (int i = 0; i < 100; ++i) csv += std::to_string(i * 0.01) + ",0,0\n";
  const std::string hand = folder.write("hand.csv", csv);
  const std::vector<std::string> commands = {
      "--help",
      "hand " + hand,
      "hand " + hand + " --json",
      "accuracy --only haptic_rate",
      "accuracy --only haptic_rate --json",
      "scene-explain gearshift",
      "scene-explain gearshift --json",
      "scene-preview gearshift --out " + folder.path() + "/a.png",
      "scene-resolve " + shapes() + " --accuracy 1mm --out " + folder.path() + "/b.scene",
      "effects screw-fastening",
      "effects screw-fastening --json",
      "wrench --turns 1 --loosen 0",
      "wrench --turns 1 --loosen 0 --json",
      "gearshift",
      "gearshift --json",
      "price-check gearshift",
      "replay --other-processor " + golden("master"),
      "replay --other-processor " + golden("slave") + " --json",
      "recording-join " + golden("master") + " " + golden("slave"),
      "recording-join " + golden("slave") + " " + golden("master") + " --json",
      "recording-csv " + golden("slave") + " --out " + folder.path() + "/c.csv",
      "scene-stability gearshift",
      "scene-stability gearshift --json",
      "stability --case cycle",
      "stability --case cycle --json",
      "stability --list",
      "tool-sequences --sequences 100",
      "tool-sequences --sequences 100 --json",
      "contact-delay --quick",
      "contact-delay --quick --json",
      "links --delay 0 --jitter 0 --loss 40",
      "links --delay 0 --jitter 0 --loss 40 --json",
      "faults --row X9b --quick",
      "faults --row X9b --quick --json"};
  std::set<std::string> listed = {"linear-movement", "screw-fastening", "fit", "bumper"};  // above
  for (const std::string& words : commands) {
    expect_told("handrail-lab", words);
    listed.insert(words.substr(0, words.find(' ')));
  }
  ASSERT_EQ(run("handrail-lab", "--help", folder.path() + "/help.txt"), 0);
  const std::set<std::string> known = subcommands(read(folder.path() + "/help.txt"));
  EXPECT_GE(known.size(), 10U);
  for (const std::string& command : known) EXPECT_TRUE(listed.count(command)) << command;
}

// Every command of handrail that prints JSON, and those that print a table, help or an answer.
TEST_F(FullDisk, UnderTheOperatorsCommands) {
  start_master();
  std::set<std::string> listed;
  const std::string at = " --socket " + socket();
  for (const std::string words : {"status", "why", "lease show", "scene list", "tool list"}) {
    listed.insert(words);
    expect_told("handrail", words + at);
    expect_told("handrail", words + " --json" + at);
  }
  const KeyFolder keys(folder.path() + "/keys");
  const auto own = keys.create("desk", Role::kMaster);
  TrustList trusted;
  ASSERT_TRUE(own && trusted.add(own->entry()) && keys.save(trusted, "a test"));
  ASSERT_TRUE(OnceLinks(keys.path()).make(Role::kObserver, 600, std::time(nullptr)));
  ::setenv("HANDRAIL_KEYS", (folder.path() + "/keys").c_str(), 1);
  for (const std::string words : {"keys links", "keys list", "keys show"}) {
    listed.insert(words);
    expect_told("handrail", words);
    expect_told("handrail", words + " --json");
  }
  ::unsetenv("HANDRAIL_KEYS");
  for (const std::string words : {"scene show", "scene explain", "scene check"}) {
    listed.insert(words);
    // The lab speaks for itself.
    const std::string program = words == "scene show" ? "handrail" : "handrail-lab";
    for (const char* more : {" gearshift", " gearshift --json"}) {
      EXPECT_EQ(run("handrail", words + more, "/dev/full"), 1) << words << more;
      EXPECT_THAT(read(complaint), HasSubstr(program + ": the standard output cannot be written"));
    }
  }
  for (const std::string words : {"devices list", "devices test page --alone"}) {
    listed.insert(words.substr(0, words.find(' ', 8)));
    expect_told("handrail", words);
    expect_told("handrail", words + " --json");
  }
  // Nobody listens there: what there is to tell is why.
  const std::string nobody = folder.write("nobody.cfg", "robot { command_port: 1 }");
  for (const std::string words : {"robot status", "robot on", "robot off", "robot reset"}) {
    listed.insert(words);
    expect_told("handrail", words + " --json --slave-config " + nobody + at);
  }
  // Everybody who can be calibrated needs a device for it; it ends as the test does.
  listed.insert("devices calibrate");
  listed.insert("record list");
  expect_told("handrail", "record list " + folder.path());
  expect_told("handrail", "record list --json " + folder.path());
  listed.insert("play");
  for (const char* more : {"", " --json"}) {
    // The console, which it becomes, speaks for itself.
    EXPECT_EQ(run("handrail", "play " + golden("master") + more, "/dev/full"), 1) << more;
    EXPECT_THAT(read(complaint),
                HasSubstr("handrail-console: the standard output cannot be written"));
  }
  listed.insert("doctor");
  for (const std::string& words :
       {"doctor" + at, "doctor --json" + at, std::string("--help"), std::string("scene --help"),
        "scene preview gearshift --out " + folder.path() + "/a.png",
        "scene resolve " + shapes() + " --accuracy 1mm --out " + folder.path() + "/b.scene"}) {
    EXPECT_EQ(run("handrail", words, "/dev/full"), 1) << words;
    EXPECT_THAT(read(complaint), HasSubstr("the standard output cannot be written")) << words;
  }
  for (const char* more : {"", " --json"}) {
    expect_told("handrail", "calibrate payload --from " + samples() + more);
  }
  listed.insert("calibrate payload");
  folder.write("made/linear-movement.anna.jsonl",
               "{\"subject\":{\"experiment\":\"linear-movement\",\"subject\":\"anna\"}}\n"
               "{\"began\":{\"linear\":{\"mode\":\"V\"}}}\n"
               "{\"ended\":{\"linear\":{\"mode\":\"V\",\"end\":\"done\"}}}\n");
  for (const char* more : {"", " --json"}) {
    expect_told("handrail",
                "experiment linear-movement --report --out " + folder.path() + "/made" + more);
  }
  listed.insert("experiment");
  listed.insert("demo");  // drives an arm for a minute, and ends as all of them do
  for (const Command& command : commands()) {
    EXPECT_TRUE(!command.takes.json || listed.count(command.name) > 0) << command.name;
  }
}

}  // namespace
}  // namespace handrail
