// Planes that are touched, and their normals in 32 bits.
#include "server/model/surface.h"

#include <gtest/gtest.h>

#include <cmath>

namespace handrail {
namespace {

TEST(Surface, OutOfItIsAlongItsNormal) {
  const Surface floor{Vec3::UnitZ(), 0.25, 60e3};
  EXPECT_NEAR(floor.out_of({1.0, 2.0, 0.26}), 0.01, 1e-15);
  EXPECT_NEAR(floor.out_of({-1.0, 0.0, 0.24}), -0.01, 1e-15);
}

TEST(Surface, AxesAreSaidExactly) {
  for (const Vec3& n : {Vec3(1, 0, 0), Vec3(-1, 0, 0), Vec3(0, 1, 0), Vec3(0, -1, 0), Vec3(0, 0, 1),
                        Vec3(0, 0, -1)}) {
    EXPECT_EQ(from_octahedral(octahedral(n)), n);
  }
}

TEST(Surface, CodesAreThoseOfTheWireContract) {
  EXPECT_EQ(octahedral({0, 0, 1}), 0u);
  EXPECT_EQ(octahedral({1, 0, 0}), 0x00007fffu);
  EXPECT_EQ(octahedral({0, -1, 0}), 0x80010000u);
  EXPECT_EQ(octahedral({0, 0, -1}), 0x7fff7fffu);
  // (3, 0, 4) / 7: 3/7 of 32767.
  EXPECT_EQ(octahedral({0.6, 0, 0.8}), 14043u);
  // (2, -3, -2) / 7 folded: (1 - 3/7, -(1 - 2/7)).
  EXPECT_EQ(octahedral({2, -3, -2}), 18724u | 0xa493u << 16);
}

TEST(Surface, EveryDirectionIsSaidWithinTheErrorThatIsPromised) {
  double worst = 0.0;
  for (int i = 0; i < 200'000; ++i) {  // a spiral over the sphere
    const double z = 1.0 - 2.0 * (i + 0.5) / 200'000, turn = 2.399963229728653 * i;
    const double r = std::sqrt(1.0 - z * z);
    const Vec3 n(r * std::cos(turn), r * std::sin(turn), z);
    const Vec3 said = from_octahedral(octahedral(n));
    worst = std::max(worst, (said - n).norm());
  }
  EXPECT_LT(worst, kNormalError);
  EXPECT_GT(worst, 0.7 * kNormalError);  // and the promise is not an idle one
}

}  // namespace
}  // namespace handrail
