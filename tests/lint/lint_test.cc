// The rules hold for the tree, and each rule catches an example that breaks it.
#include <gtest/gtest.h>

#include <filesystem>

#include "tests/lint/rules.h"

namespace handrail::lint {
namespace {

bool is_production(const File& file) {
  for (const char* top : {"server/", "devices/", "client/"}) {
    if (starts_with(file.path, top)) return true;
  }
  return false;
}

const std::vector<File>& sources() {
  static const std::vector<File> all = files_below(HANDRAIL_SOURCE_DIR, {".h", ".cc", ".proto"});
  return all;
}

const std::vector<File>& production() {
  static const std::vector<File> all = [] {
    std::vector<File> kept;
    for (const File& file : sources()) {
      if (is_production(file)) kept.push_back(file);
    }
    return kept;
  }();
  return all;
}

const std::vector<File>& cmake_files() {
  static const std::vector<File> all =
      files_below(HANDRAIL_SOURCE_DIR, {"CMakeLists.txt", ".cmake", "CMakePresets.json"});
  return all;
}

void expect_holds(const std::vector<File>& files, Violations (*rule)(const File&)) {
  EXPECT_FALSE(files.empty());
  for (const File& file : files) {
    for (const std::string& violation : rule(file)) ADD_FAILURE() << violation;
  }
}

void expect_caught(Violations (*rule)(const File&), const std::string& path,
                   const std::string& text) {
  EXPECT_EQ(rule({path, text}).size(), 1u) << path << " with: " << text;
}

void expect_passes(Violations (*rule)(const File&), const std::string& path,
                   const std::string& text) {
  EXPECT_EQ(rule({path, text}), Violations{}) << path << " with: " << text;
}

TEST(Lint, FindsTheTree) {
  EXPECT_GT(production().size(), 20u);
  EXPECT_GT(cmake_files().size(), 10u);
}

TEST(Lint, FoldersIncludeOnlyWhatTheTableAllows) {
  expect_caught(include_direction, "server/base/a.h", "#include \"server/model/scene.h\"\n");
  expect_caught(include_direction, "server/motion/a.cc", "#include <devices/robot.h>\n");
  expect_caught(include_direction, "server/effects/a.cc", "  # include \"devices/robot.h\"\n");
  expect_caught(include_direction, "server/model/scene.cc", "#include \"proto/scene.pb.h\"\n");
  expect_caught(include_direction, "devices/melfa/a.cc", "#include \"devices/rig/rig.h\"\n");
  expect_caught(include_direction, "client/api/a.cc", "#include \"server/model/scene.h\"\n");
  expect_caught(include_direction, "server/master/a.cc", "#include \"tests/support/a.h\"\n");
  expect_caught(include_direction, "server/nowhere/a.cc", "");
  expect_caught(include_direction, "server/scene/deeper/a.cc", "");
  expect_caught(include_direction, "server/haptic/a.cc", "#include \"server/follow/bumper.h\"\n");
  expect_caught(include_direction, "server/constraint/a.cc",
                "#include \"server/constraint/drawn/outline.h\"\n");
  expect_passes(include_direction, "server/scene/scene_io.cc", "#include \"proto/scene.pb.h\"\n");
  expect_passes(include_direction, "server/master/a.cc", "#include \"devices/registry.h\"\n");
  expect_passes(include_direction, "server/base/a.h", "#include <Eigen/Core>\n");
  expect_holds(production(), include_direction);
}

TEST(Lint, TargetsLinkOnlyWhatTheirFolderMayInclude) {
  expect_caught(link_direction, "server/haptic/CMakeLists.txt",
                "handrail_library(handrail_haptic handrail_base\n handrail_follow)");
  expect_caught(link_direction, "server/base/CMakeLists.txt",
                "handrail_library(handrail_base handrail_rig)");
  expect_passes(link_direction, "devices/rig/CMakeLists.txt",
                "handrail_library(handrail_rig handrail_base handrail_melfa) # handrail_cli");
  std::vector<File> folders;
  for (const File& file : cmake_files()) {
    if (is_production(file)) folders.push_back(file);
  }
  expect_holds(folders, link_direction);
}

TEST(Lint, BaseDependsOnTheStandardLibraryAndEigenOnly) {
  expect_caught(base_dependencies, "server/base/a.h", "#include <boost/optional.hpp>\n");
  expect_passes(base_dependencies, "server/link/a.h", "#include <boost/optional.hpp>\n");
  expect_holds(production(), base_dependencies);
}

TEST(Lint, StepsHaveNoClockThreadLockStreamOrLog) {
  expect_caught(pure_folders, "server/follow/a.cc", "int x;\n#include <chrono>\n");
  expect_caught(pure_folders, "server/kinematics/a.h", "#include <mutex>\n");
  expect_caught(pure_folders, "server/effects/a.cc", "#include <spdlog/spdlog.h>\n");
  expect_caught(pure_folders, "server/constraint/a.cc", "#include \"server/base/clock.h\"\n");
  expect_caught(pure_folders, "server/constraint/drawn/a.h", "#include <thread>\n");
  expect_passes(pure_folders, "server/master/a.cc", "#include <thread>\n");
  expect_holds(production(), pure_folders);
}

TEST(Lint, LogsAreWrittenBySourcesOfDaemonsClientAndDevices) {
  expect_caught(logging, "server/master/a.h", "#include <spdlog/spdlog.h>\n");
  expect_caught(logging, "server/scene/a.cc", "#include <spdlog/fmt/fmt.h>\n");
  expect_caught(logging, "server/master/haptic_loop.cc", "#include <spdlog/spdlog.h>\n");
  expect_caught(logging, "devices/melfa/melfa_robot.cc", "#include <spdlog/spdlog.h>\n");
  expect_passes(logging, "server/master/a.cc", "#include <spdlog/spdlog.h>\n");
  expect_passes(logging, "server/slave/robot_loop.cc", "#include <spdlog/fmt/fmt.h>\n");
  expect_holds(production(), logging);
}

TEST(Lint, SocketsStayInTransportsDriversServersAndMains) {
  expect_caught(networking, "server/link/peer.cc", "#include <boost/asio.hpp>\n");
  expect_caught(networking, "devices/melfa/mxt_client.cc", "#include <boost/asio/ip/udp.hpp>\n");
  expect_passes(networking, "server/link/unix_transport.cc", "#include <boost/asio.hpp>\n");
  expect_passes(networking, "server/slave/slave_main.cc", "#include <boost/asio.hpp>\n");
  expect_holds(production(), networking);
}

TEST(Lint, HeavyHeadersAreIncludedByAtMostTwoFiles) {
  const std::string beast = "#include <boost/beast.hpp>\n#include <boost/beast/http.hpp>\n";
  EXPECT_EQ(heavy_headers({{"a.cc", beast}, {"b.cc", beast}, {"c.cc", beast}}).size(), 1u);
  EXPECT_EQ(heavy_headers({{"a.cc", beast}, {"b.cc", beast}}), Violations{});
  EXPECT_EQ(heavy_headers(production()), Violations{});
}

TEST(Lint, NoFileIsLongerThanFourHundredLines) {
  expect_caught(file_size, "tests/a.cc", std::string(401, '\n'));
  expect_passes(file_size, "tests/a.cc", std::string(400, '\n'));
  expect_holds(sources(), file_size);
}

TEST(Lint, NoFolderHoldsMoreThanFortyFiles) {
  std::vector<File> files(40, {"server/base/a.h", ""});
  files.push_back({"server/base/deeper/a.h", ""});
  EXPECT_EQ(folder_size(files), Violations{});
  files.push_back({"server/base/CMakeLists.txt", ""});
  EXPECT_EQ(folder_size(files), Violations{"server/base: 41 files, split at 40"});
  const std::vector<File> tree = files_below(HANDRAIL_SOURCE_DIR, {""});
  EXPECT_GT(tree.size(), sources().size());
  EXPECT_EQ(folder_size(tree), Violations{});
}

TEST(Lint, TheBuildStaysPortableAndKeepsFiniteChecks) {
  expect_caught(build_options, "CMakeLists.txt", "add_compile_options(-march=native)");
  expect_caught(build_options, "CMakePresets.json", "\"CMAKE_CXX_FLAGS\": \"-O3 -ffast-math\"");
  expect_passes(build_options, "CMakeLists.txt", "# never -march=native\nproject(x)");
  expect_holds(cmake_files(), build_options);
}

TEST(Lint, PagesNameWhatIsThere) {
  const std::string page = "tests/README.md";
  const auto there = [](const std::string& path) {
    return std::filesystem::exists(HANDRAIL_SOURCE_DIR "/" + path);
  };
  EXPECT_EQ(dead_links({page, "[a](../README.md) `server/base/`"}, there), Violations{});
  EXPECT_EQ(dead_links({page, "[a](https://x.org/y) `server/NAME.h`"}, there), Violations{});
  EXPECT_EQ(dead_links({page, "[a](READ.md)"}, there).size(), 1u);
  EXPECT_EQ(dead_links({page, "see `server/nowhere/`"}, there).size(), 1u);
  const std::vector<File> pages = files_below(HANDRAIL_SOURCE_DIR, {".md"});
  EXPECT_GT(pages.size(), 5u);
  for (const File& file : pages) {
    for (const std::string& violation : dead_links(file, there)) ADD_FAILURE() << violation;
  }
}

TEST(Lint, EveryTestAsserts) {
  expect_caught(assertions, "tests/a_test.cc", "TEST(A, DoesNothing) { run(); }");
  expect_caught(assertions, "tests/a_test.cc",
                "TEST(A, OnlySaysSo) { puts(\"EXPECT_TRUE(x) }\"); /* ASSERT_EQ */ }\n"
                "TEST(A, Asserts) { EXPECT_EQ(1, 1); }");
  expect_caught(assertions, "tests/a_test.cc", "RC_GTEST_PROP(A, Prop, (int x)) { f(x); }");
  expect_passes(assertions, "tests/a_test.cc", "TEST_F(A, Helper) { for (;;) { expect_ok(1); } }");
  std::vector<File> tests;
  for (const File& file : sources()) {
    if (ends_with(file.path, "_test.cc")) tests.push_back(file);
  }
  expect_holds(tests, assertions);
}

TEST(SourceText, BlanksOutWhatIsNotCode) {
  EXPECT_EQ(code_only("a // b\nc"), "a     \nc");
  EXPECT_EQ(code_only("a /* b\n*/ c"), "a     \n   c");
  EXPECT_EQ(code_only("f(\"}\\\"{\", '{') + 1'000"), "f(      ,    ) + 1'000");
  EXPECT_EQ(code_only("R\"x(}\")x\" y"), "          y");
}

TEST(SourceText, NamesTheFolderOfAPath) {
  EXPECT_EQ(folder_of("server/base/time.h"), "server/base");
  EXPECT_EQ(folder_of("devices/robot.h"), "devices");
  EXPECT_EQ(folder_of("proto/link.pb.h"), "proto");
  EXPECT_EQ(folder_of("server/lab/cell/a.h"), "server/lab/cell");
}

}  // namespace
}  // namespace handrail::lint
