// A proxy that is brought back from an image goes on as the one it was taken of.
#include <gtest/gtest.h>

#include <array>
#include <memory>
#include <vector>

#include "server/base/random.h"
#include "server/haptic/wall_proxies.h"
#include "server/scene/scene_library.h"

namespace handrail {
namespace {

struct ProxyKind {
  const char* scene;
  std::vector<Override> overrides;
};

TEST(ProxyImage, GoesOnToTheBit) {
  const ProxyKind kinds[] = {
      {"gearshift", {}}, {"painted-aisle", {}}, {"painted-aisle", {{"walls.method", "PUBLISHED"}}}};
  for (const ProxyKind& kind : kinds) {
    const auto scene = SceneLibrary().load(kind.scene, kind.overrides);
    ASSERT_TRUE(scene) << scene.message();
    const auto first = make_wall_proxy(*scene->walls), second = make_wall_proxy(*scene->walls);
    Random random(3);
    Vec2 hand = scene->walls->start;
    int touched = 0;
    std::array<std::byte, WallProxy::kMostImage> image;
    for (int i = 0; i < 3000; ++i) {
      hand += 2e-3 * Vec2(random.normal(), random.normal());
      hand = scene->walls->start + 0.99 * (hand - scene->walls->start);
      if (i % 100 == 50) {
        const std::size_t size = first->save(image);
        ASSERT_TRUE(second->restore(std::span(image).first(size)));
        EXPECT_FALSE(second->restore(std::span(image).first(size - 1)));
      }
      const WallContact a = first->advance(hand);
      if (i < 50) continue;
      const WallContact b = second->advance(hand);
      touched += a.touching ? 1 : 0;
      ASSERT_EQ(a.proxy, b.proxy) << kind.scene << ", " << i;
      ASSERT_EQ(a.normal, b.normal);
      ASSERT_EQ(a.work, b.work);
      ASSERT_EQ(a.region, b.region);
      if (i % 100 == 49)
        second->advance(hand + Vec2(0.01, 0.02));  // goes astray until brought back
    }
    EXPECT_GT(touched, 100) << kind.scene;
  }
}

}  // namespace
}  // namespace handrail
