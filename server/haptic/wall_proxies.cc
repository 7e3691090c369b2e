#include "server/haptic/wall_proxies.h"

#include "server/constraint/drawn/exact_wall.h"
#include "server/constraint/painted/published_wall.h"
#include "server/constraint/painted/subpixel_wall.h"

namespace handrail {

std::unique_ptr<WallProxy> make_wall_proxy(const Walls& walls) {
  switch (walls.method) {
    case WallMethod::kPublished: return make_published_proxy(walls);
    case WallMethod::kExact: return make_exact_proxy(walls);
    case WallMethod::kSubpixel: break;
  }
  return make_subpixel_proxy(walls);
}

}  // namespace handrail
