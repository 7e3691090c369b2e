#include "server/model/tool.h"

#include <gtest/gtest.h>

#include <functional>
#include <set>
#include <vector>

#include "server/base/fnv.h"

namespace handrail {
namespace {

TEST(Fnv, GivesThePublishedValues) {
  EXPECT_EQ(Fnv().value(), 0xcbf29ce484222325ULL);
  EXPECT_EQ(Fnv().byte('a').value(), 0xaf63dc4c8601ec8cULL);
  Fnv foobar;
  for (const char c : {'f', 'o', 'o', 'b', 'a', 'r'}) foobar.byte(static_cast<std::uint8_t>(c));
  EXPECT_EQ(foobar.value(), 0x85944171f73967e8ULL);
}

TEST(Fnv, TellsWhereOneTextEndsAndTheNextBegins) {
  EXPECT_NE(Fnv().text("ab").text("c").value(), Fnv().text("a").text("bc").value());
}

TEST(ToolHash, FoldsMinusZeroIntoZero) {
  ToolDefinition a, b;
  b.p_SA = Vec3(-0.0, 0.0, -0.0);
  b.end = -0.0;
  EXPECT_EQ(hash_of(a), hash_of(b));
  EXPECT_TRUE(same_tool(a, b));
}

TEST(ToolHash, IgnoresWhichCallMadeTheTool) {
  ToolDefinition a, b;
  b.id = 12;
  b.epoch = 99;
  EXPECT_EQ(hash_of(a), hash_of(b));
  EXPECT_TRUE(same_tool(a, b));
}

TEST(ToolHash, ChangesWithEveryFieldOfTheDefinition) {
  std::vector<std::function<void(ToolDefinition&)>> changes = {
      [](ToolDefinition& t) { t.kind = ToolKind::kLine; },
      [](ToolDefinition& t) { t.one_way = true; },
      [](ToolDefinition& t) { t.has_end = true; },
      [](ToolDefinition& t) { t.end = 0.1; },
      [](ToolDefinition& t) { t.stiffness = 0.1; },
  };
  for (int i = 0; i < 3; ++i) {
    changes.push_back([i](ToolDefinition& t) { t.p_SA[i] = 0.1; });
    changes.push_back([i](ToolDefinition& t) { t.direction_S[i] = 0.1; });
    changes.push_back([i](ToolDefinition& t) { t.normal_S[i] = 0.1; });
    changes.push_back([i](ToolDefinition& t) { t.axis_T[i] = 0.1; });
  }
  for (int i = 0; i < 4; ++i) {
    changes.push_back([i](ToolDefinition& t) { t.q_ref.coeffs()[i] += 0.1; });
  }
  std::set<std::uint64_t> hashes = {hash_of(ToolDefinition{})};
  for (std::size_t i = 0; i < changes.size(); ++i) {
    ToolDefinition tool;
    changes[i](tool);
    EXPECT_TRUE(hashes.insert(hash_of(tool)).second) << "change " << i << " is not in the hash";
    EXPECT_FALSE(same_tool(tool, ToolDefinition{})) << "change " << i << " is not seen";
  }
}

TEST(ToolKind, IsForPositionOrOrientationButNotBoth) {
  int position = 0, orientation = 0;
  for (int i = 0; i <= static_cast<int>(ToolKind::kFRotation); ++i) {
    const auto kind = static_cast<ToolKind>(i);
    position += is_position_tool(kind);
    orientation += is_orientation_tool(kind);
    EXPECT_FALSE(is_position_tool(kind) && is_orientation_tool(kind)) << i;
  }
  EXPECT_EQ(position, 3);
  EXPECT_EQ(orientation, 2);
}

}  // namespace
}  // namespace handrail
