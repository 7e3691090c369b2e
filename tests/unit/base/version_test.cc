#include "server/base/version.h"

#include <gtest/gtest.h>

namespace handrail {
namespace {

TEST(Version, GoesIntoANumberAndBack) {
  for (const char* text : {"0.1.0", "1.2.3", "1023.1023.1023"}) {
    EXPECT_EQ(version_text(version_code(text)), text);
  }
  EXPECT_LT(version_code("1.2.3"), version_code("1.3.0"));
  EXPECT_NE(version_code(program_version()), 0u) << program_version();
}

TEST(Version, WhatIsNoneIsUnknown) {
  for (const char* text : {"", "1.2", "x.y.z", "1024.0.0", "0.1024.0", "0.0.1024"}) {
    EXPECT_EQ(version_code(text), 0u) << text;
  }
  EXPECT_EQ(version_text(0), "unknown");
}

}  // namespace
}  // namespace handrail
