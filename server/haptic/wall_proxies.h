// The proxy that a scene of walls asks for.
#pragma once

#include <memory>

#include "server/constraint/wall_proxy.h"

namespace handrail {

// The proxy of the scene's method. `walls` must outlive it and have passed the loader's checks.
// May block and allocate.
std::unique_ptr<WallProxy> make_wall_proxy(const Walls& walls);

}  // namespace handrail
