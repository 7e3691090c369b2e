// The table of constants in WALLS.md is that of the sources.
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <iterator>
#include <map>
#include <regex>
#include <string>

namespace handrail {
namespace {

const std::string kConstraint = std::string(HANDRAIL_SOURCE_DIR) + "/server/constraint/";

std::string text_of(const std::string& file) {
  std::ifstream in(file);
  return {std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>()};
}

using Values = std::map<std::string, std::string>;

// What `pattern` finds: a name and its value.
Values found(const std::string& text, const char* pattern) {
  Values out;
  const std::regex look(pattern);
  for (std::sregex_iterator at(text.begin(), text.end(), look), end; at != end; ++at) {
    out[(*at)[1]] = (*at)[2];
  }
  return out;
}

TEST(WallConstants, EveryOneIsInTheTableWithItsValueAndOrigin) {
  std::string sources;
  for (const auto& entry : std::filesystem::directory_iterator(kConstraint + "painted")) {
    const std::string file = entry.path().string();
    if (entry.path().filename().string().rfind("subpixel_", 0) == 0) sources += text_of(file);
  }
  const Values all = found(sources, "constexpr (?:double|int) (k\\w+) = ([^,;]+);");
  const Values lengths = found(sources, "\n(?:inline )?constexpr double (k\\w+) = ([^;]+);");
  const std::string page = text_of(kConstraint + "WALLS.md");
  const Values table = found(page, "\n\\| `(k\\w+)` \\| [^|]+ \\| ([^|]+) \\| [^|]{3,} \\|");
  EXPECT_GT(lengths.size(), 40u);
  for (const auto& [name, value] : lengths) EXPECT_EQ(table.count(name), 1u) << name;
  for (const auto& [name, value] : table) {
    ASSERT_EQ(all.count(name), 1u) << name;
    EXPECT_EQ(all.at(name), value) << name;
  }
}

}  // namespace
}  // namespace handrail
