// What every program has in common, and what an installation puts where.
#include <gmock/gmock.h>

#include <filesystem>
#include <set>

#include "tests/loopback/program.h"

namespace handrail {
namespace {

using ::testing::IsSupersetOf;
using ::testing::StartsWith;

const std::string kPrograms[] = {"handrail",     "handrail-master", "handrail-slave",
                                 "handrail-rig", "handrail-lab",    "handrail-console"};

TEST(Programs, EachSaysItsVersion) {
  TempFolder folder;
  std::set<std::string> names;  // those that are installed, and those of the tests
  for (const auto& file : std::filesystem::directory_iterator(HANDRAIL_BIN_DIR)) {
    names.insert(file.path().filename());
  }
  EXPECT_THAT(names, IsSupersetOf(kPrograms));
  for (const std::string& name : names) {
    Program program(folder, HANDRAIL_BIN_DIR "/" + name, {"--version"});
    EXPECT_EQ(program.finish(), 0) << name;
    EXPECT_THAT(program.output(), StartsWith(name + " " HANDRAIL_VERSION "\n"));
  }
}

// Programs, what they look for beside themselves, and the link's contract.
TEST(Programs, AnInstallationHasWhatTheyLookFor) {
  TempFolder folder;
  const std::string to = folder.path() + "/usr";
  Program install(folder, "/usr/bin/env",
                  {"cmake", "--install", HANDRAIL_BUILD_DIR, "--prefix", to});
  ASSERT_EQ(install.finish(), 0) << install.output();
  for (const std::string& name : kPrograms) {
    EXPECT_TRUE(std::filesystem::exists(to + "/bin/" + name)) << name;
  }
  for (const std::string file :
       {"/share/doc/handrail/WIRE.md", "/share/doc/handrail/LICENSE",
        "/share/handrail/scenes/wrench.scene", "/share/handrail/lab/linear-movement.operators"}) {
    EXPECT_TRUE(std::filesystem::exists(to + file)) << file;
  }
}

}  // namespace
}  // namespace handrail
