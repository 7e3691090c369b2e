// client/install on machines that have what it needs, lack some of it, or cannot install.
#include <gmock/gmock.h>
#include <sys/stat.h>
#include <unistd.h>

#include <filesystem>

#include "tests/loopback/program.h"

namespace handrail {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

// A machine of which it finds the programs in one folder alone. Headers are this computer's.
class InstallTest : public ::testing::Test {
 protected:
  void SetUp() override {
    std::filesystem::create_directory(bin);
    for (const char* name : {"bash", "dirname", "sed", "sort", "head", "grep", "id", "env", "g++",
                             "cmake", "ninja", "protoc"}) {
      link(name);
    }
  }
  void link(const std::string& name) {
    for (const char* place : {"/usr/bin/", "/bin/"}) {
      if (!std::filesystem::exists(place + name)) continue;
      return std::filesystem::create_symlink(place + name, bin + "/" + name);
    }
    FAIL() << "no " << name << " here";
  }
  void without(const std::string& name) { std::filesystem::remove(bin + "/" + name); }
  // A program that runs this.
  void script(const std::string& name, const std::string& text) {
    without(name);
    folder.write("bin/" + name, "#!/bin/bash\n" + text + "\n");
    ASSERT_EQ(::chmod((bin + "/" + name).c_str(), 0755), 0);
  }
  // A Debian that knows of no installed package, and whose apt-get says what it is asked.
  void debian() {
    script("dpkg-query", "exit 1");
    script("apt-get", "echo \"apt-get $*\" >&2");
    script("sudo", "exec \"$@\"");
  }
  int run(std::vector<std::string> words = {}) {
    words.insert(words.begin(), {"PATH=" + bin, HANDRAIL_SOURCE_DIR "/client/install"});
    Program program(folder, "/usr/bin/env", words);
    const int code = program.finish();
    said = program.output();
    return code;
  }

  TempFolder folder;
  const std::string bin = folder.path() + "/bin";
  std::string said;
};

TEST_F(InstallTest, WithoutAptItGoesOnWhereAllIsThere) {
  EXPECT_EQ(run(), 0);
  EXPECT_EQ(said, "packages: all that is needed is there\n");
}

TEST_F(InstallTest, WithoutAptWhatIsMissingIsNamedWithItsPurpose) {
  without("protoc");
  EXPECT_EQ(run(), 2);
  EXPECT_THAT(said, HasSubstr("there is no apt-get here, and these are missing (Debian's names):\n"
                              "  protobuf-compiler    messages: the compiler\n"));
  EXPECT_THAT(said, Not(HasSubstr("cmake")));
  EXPECT_THAT(said, HasSubstr("then run the same command again"));
}

TEST_F(InstallTest, WhatItWillInstallIsSaidBeforeItDoes) {
  debian();
  without("protoc");
  without("ninja");
  EXPECT_EQ(run(), 0);
  EXPECT_EQ(said,
            "packages: installing with apt-get:\n"
            "  ninja-build          build\n"
            "  protobuf-compiler    messages: the compiler\n"
            "apt-get update -qq\n"
            "apt-get install -y -qq --no-install-recommends ninja-build protobuf-compiler\n"
            "packages: installed\n");
}

TEST_F(InstallTest, WhatIsThereFromElsewhereIsNotInstalledAgain) {
  debian();
  EXPECT_EQ(run(), 0);
  EXPECT_EQ(said, "packages: all that is needed is there\n");
}

TEST_F(InstallTest, WithoutANetworkWhatIsMissingIsNamed) {
  debian();
  script("apt-get", "exit 100");
  without("protoc");
  EXPECT_EQ(run(), 2);
  EXPECT_THAT(said, HasSubstr("apt-get update failed, and these are missing"));
  EXPECT_THAT(said, HasSubstr("apt-get install --no-install-recommends protobuf-compiler"));
}

TEST_F(InstallTest, AnUserWithoutSudoIsToldWhatRootIsToInstall) {
  debian();
  without("protoc");
  without("sudo");
  script("id", "echo 1000");
  EXPECT_EQ(run(), 2);
  EXPECT_THAT(said, HasSubstr("there is no sudo, and these are missing"));
}

TEST_F(InstallTest, ACompilerThatIsTooOldIsNamedWithItsVersion) {
  script("g++", "[ $1 = -dumpfullversion ] && echo 11.4.0; exit 0");
  EXPECT_EQ(run(), 2);
  EXPECT_THAT(said, HasSubstr("g++ is version 11.4.0, expected 12 or later"));
}

TEST_F(InstallTest, AClangWithoutItsFuzzerIsNotEnough) {
  script("clang++", "[[ $* != *-fsanitize=fuzzer* ]]");
  script("llvm-symbolizer", "");
  EXPECT_EQ(run({"--fuzz"}), 2);
  EXPECT_THAT(said, HasSubstr("are missing (Debian's names):\n"
                              "  libclang-rt-dev      fuzzers: libFuzzer, sanitizers\n"));
  EXPECT_THAT(said, Not(HasSubstr("llvm  ")));
  script("clang++", "exit 0");
  EXPECT_EQ(run({"--fuzz"}), 0);
  EXPECT_EQ(said, "packages: all that is needed is there\n");
}

TEST_F(InstallTest, AnUnknownWordIsNamed) {
  EXPECT_EQ(run({"--test"}), 2);
  EXPECT_THAT(said, HasSubstr("unknown argument '--test'; expected --tests, --checks, "
                              "--fuzz, --bench, --page, --kernel, --console or nothing"));
}

TEST_F(InstallTest, TheConsolesPageNamesWhatItLacksAndInstallsNoPackage) {
  debian();
  EXPECT_EQ(run({"--console"}), 2);
  EXPECT_THAT(said, HasSubstr("page"));
  EXPECT_THAT(said, Not(HasSubstr("apt-get install")));
}

}  // namespace
}  // namespace handrail
