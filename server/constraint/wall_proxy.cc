#include "server/constraint/wall_proxy.h"

#include "server/constraint/exact_wall.h"
#include "server/constraint/published_wall.h"
#include "server/constraint/subpixel_wall.h"

namespace handrail {

std::unique_ptr<WallProxy> make_wall_proxy(const Walls& walls) {
  switch (walls.method) {
    case WallMethod::kPublished:
      return make_published_proxy(walls);
    case WallMethod::kExact:
      return make_exact_proxy(walls);
    case WallMethod::kSubpixel:
      break;
  }
  return make_subpixel_proxy(walls);
}

}  // namespace handrail
